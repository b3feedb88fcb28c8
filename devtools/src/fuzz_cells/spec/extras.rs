//! Keys and tables of a cell that have nothing to do with what its kind tests, and the form of its poses.

use std::fmt::Write as _;

use super::files::CellFile;
use super::scene::SceneSpec;
use super::sensor::SensorSpec;

/// Further contents of a cell file.
#[derive(Debug, Clone, Default)]
pub struct Extras {
    /// Lines before all tables, such as `name = "…"`.
    pub head: Vec<String>,
    /// Further keys of tables.
    pub keys: Vec<ExtraKey>,
    /// Further tables, each with its head.
    pub tables: Vec<String>,
    pub scenes: Vec<SceneSpec>,
    pub sensors: Vec<SensorSpec>,
    /// Files that they name, beside the cell file.
    pub files: Vec<CellFile>,
    pub turns: Turns,
}

/// A line of a table, such as `hysteresis = 0.01` of `region.g0`.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtraKey {
    pub table: String,
    pub line: String,
}

/// How the turns of poses are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Turns {
    #[default]
    Rpy,
    /// Every other one as a quaternion, from the first or from the second one on.
    Mixed(usize),
    Quaternions,
}

impl Extras {
    /// Adds the keys to their tables. A table that is not there any more has no keys.
    pub(super) fn write_keys(&self, t: &mut String) {
        for ExtraKey { table, line } in &self.keys {
            let head = format!("[{table}]\n");
            *t = t.replacen(&head, &format!("{head}{line}\n"), 1);
        }
    }
}

impl Turns {
    /// Writes turns in roll, pitch and yaw as quaternions.
    pub(super) fn write(self, text: &str) -> String {
        const KEY: &str = "rpy = [";
        let mut parts = text.split(KEY);
        let mut t = parts.next().unwrap_or_default().to_owned();
        for (i, part) in parts.enumerate() {
            let is_quaternion = match self {
                Self::Rpy => false,
                Self::Mixed(first) => i % 2 == first,
                Self::Quaternions => true,
            };
            let numbers = part.split_once(']').and_then(|(numbers, rest)| Some((three(numbers)?, rest)));
            match numbers.filter(|_| is_quaternion) {
                Some((rpy, rest)) => {
                    let _ = write!(t, "quaternion = {:?}{rest}", quaternion(rpy));
                }
                None => t.extend([KEY, part]),
            }
        }
        t
    }
}

fn three(numbers: &str) -> Option<[f64; 3]> {
    let numbers: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
    numbers.ok()?.try_into().ok()
}

/// The quaternion x, y, z, w of `Rz(yaw) · Ry(pitch) · Rx(roll)`, by half angles.
fn quaternion(rpy: [f64; 3]) -> [f64; 4] {
    let [(sr, cr), (sp, cp), (sy, cy)] = rpy.map(|angle| (0.5 * angle).sin_cos());
    [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn turns_are_written_as_quaternions() {
        let text = format!("base = {{ rpy = [0, 0, {FRAC_PI_2}] }}\nrpy = [0, 0, 0]\n");
        assert_eq!(Turns::Rpy.write(&text), text);
        let mixed = Turns::Mixed(1).write(&text);
        assert!(
            mixed.contains("rpy = [0, 0, 1.57") && mixed.ends_with("quaternion = [0.0, 0.0, 0.0, 1.0]\n"),
            "{mixed}"
        );
        let [x, y, z, w] = quaternion([0.3, 0.0, FRAC_PI_2]);
        let (sin, cos) = 0.15_f64.sin_cos();
        let half = 0.5_f64.sqrt();
        for (value, expected) in [(x, half * sin), (y, half * sin), (z, half * cos), (w, half * cos)] {
            assert!((value - expected).abs() < 1e-12);
        }
    }
}
