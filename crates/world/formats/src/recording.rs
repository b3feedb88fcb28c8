//! Recordings as controllers write them: with degrees, millimetres, semicolons, decimal commas, other names and times.
//!
//! [`read`] converts them to joint states of this project.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_spatial::units::{AngleUnit, LengthUnit};

use crate::{Diagnostic, JointStateOptions, JointStates, csv, read_file};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Layout of a recording. The default is the layout of [`JointStates`]: radians, metres, a column `t_s`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordingLayout {
    /// Unit of revolute joints.
    pub angle: AngleUnit,
    /// Unit of prismatic joints.
    pub length: LengthUnit,
    /// Name of the time column; `None` means `t_s`.
    pub time: Option<String>,
    /// Unit of the time, s: 0.001 for milliseconds; `None` means seconds.
    pub time_unit_s: Option<f64>,
    /// Time from row to row, s, for a recording without a time column. If given, it overrides a time column.
    pub period_s: Option<f64>,
    /// Pairs of a joint and its column, if the column has another name. Upper and lower case do not matter.
    pub columns: Vec<(String, String)>,
}

/// Reads a recording of one robot.
///
/// Cells are separated by commas, semicolons or tabs. With semicolons or tabs, numbers may have decimal commas.
///
/// ```
/// use elbowroom_formats::recording::{RecordingLayout, read};
/// use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
/// use elbowroom_robot::RobotId;
/// use elbowroom_spatial::units::AngleUnit;
/// let row = |name: &str| ClassicalRow {
///     joint: name.into(), kind: JointKind::Revolute, a: 0.3, alpha: 0.0, d: 0.5, theta: 0.0,
///     limits: Limits::symmetric(2.5),
/// };
/// let chain = Chain::from_dh("arm", &[row("joint_1"), row("joint_2")])?;
/// let dir = tempfile::tempdir()?;
/// let path = dir.path().join("log.csv");
/// std::fs::write(&path, "Joint_1;A2\n90,0;0\n0;45,0\n")?;
/// let layout = RecordingLayout {
///     angle: AngleUnit::Degree,
///     period_s: Some(0.004),
///     columns: vec![("joint_2".into(), "A2".into())],
///     ..RecordingLayout::default()
/// };
/// let states = read(&path, "arm", &chain, &layout)?;
/// assert_eq!((states.times_s(), states.q(0, RobotId(0))), (&[0.0, 0.004][..], &[std::f64::consts::FRAC_PI_2, 0.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] with the line and the column.
pub fn read(path: &Path, robot: &str, chain: &Chain, layout: &RecordingLayout) -> Result<JointStates> {
    let text = String::from_utf8(read_file(path, csv::MAX_BYTES, "a file with fewer rows or columns")?)
        .map_err(|_| Diagnostic::not_utf8(path, None))?;
    let text = Translation::new(path, &text, robot, chain, layout)?.text();
    JointStates::parse(path, &text, &JointStateOptions::trajectory(robot, chain))
}

/// Conversion of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cell {
    /// Unchanged, except for the decimal comma.
    Kept,
    /// A number that is multiplied by the scale.
    Scaled(Scale),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    Angle(AngleUnit),
    Length(LengthUnit),
    Seconds(f64),
}

impl Scale {
    fn of(self, value: f64) -> f64 {
        match self {
            Self::Angle(unit) => unit.to_radians(value),
            Self::Length(unit) => unit.to_metres(value),
            Self::Seconds(unit_s) => value * unit_s,
        }
    }
}

/// Translation of a recording, line by line, to commas, the names of the chain, and SI units. Lines keep their numbers.
struct Translation<'t> {
    text: &'t str,
    separator: char,
    names: Vec<String>,
    cells: Vec<Cell>,
    period_s: Option<f64>,
}

impl<'t> Translation<'t> {
    fn new(path: &Path, text: &'t str, robot: &str, chain: &Chain, layout: &RecordingLayout) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let header = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let separator = [';', '\t'].into_iter().find(|&c| header.contains(c)).unwrap_or(',');
        let found: Vec<&str> = header.split(separator).map(unquoted).collect();
        for (joint, column) in &layout.columns {
            if !found.iter().any(|name| name.eq_ignore_ascii_case(column)) {
                let what = format!("has no column `{column}` for `{joint}`; its columns are {}", found.join(", "));
                return Err(Diagnostic::new(path, 1, what).hint("a column of the file"));
            }
        }
        let time = layout.time.as_deref().unwrap_or("t_s");
        if layout.period_s.is_none() && !found.iter().any(|name| name.eq_ignore_ascii_case(time)) {
            let what = format!("has no column `{time}` of the time; its columns are {}", found.join(", "));
            return Err(Diagnostic::new(path, 1, what).hint("time = \"COLUMN\", or period_ms = 4 without one"));
        }
        let named = |name: &&str| Self::column(name, robot, chain, layout, time);
        let (names, cells) = found.iter().map(named).unzip();
        Ok(Self { text, separator, names, cells, period_s: layout.period_s })
    }

    /// The name of a column in this project, and the conversion of its cells.
    fn column(name: &str, robot: &str, chain: &Chain, layout: &RecordingLayout, time: &str) -> (String, Cell) {
        if name.eq_ignore_ascii_case(time) {
            let unit = layout.time_unit_s.map_or(Cell::Kept, |unit_s| Cell::Scaled(Scale::Seconds(unit_s)));
            // If a time column and a period are given, the period is used.
            let of_file = if layout.period_s.is_some() { format!("{name} of the file") } else { "t_s".to_owned() };
            return (of_file, unit);
        }
        let mapped =
            layout.columns.iter().find(|(_, column)| column.eq_ignore_ascii_case(name)).map(|(joint, _)| joint);
        let bare = name.strip_prefix(robot).and_then(|rest| rest.strip_prefix('.')).unwrap_or(name);
        let wanted = mapped.map_or(bare, |joint| &joint[..]);
        let joints = chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
        let Some(joint) = joints.into_iter().find(|joint| joint.name.eq_ignore_ascii_case(wanted)) else {
            return (name.to_owned(), Cell::Kept);
        };
        let scale = match joint.kind {
            JointKind::Prismatic => Scale::Length(layout.length),
            _ => Scale::Angle(layout.angle),
        };
        (joint.name.clone(), Cell::Scaled(scale))
    }

    fn text(&self) -> String {
        let mut out = String::with_capacity(self.text.len());
        let (mut is_header, mut row) = (true, 0_u32);
        for line in self.text.lines() {
            if line.trim().is_empty() {
                out.push('\n');
                continue;
            }
            if let Some(period_s) = self.period_s {
                if is_header {
                    out.push_str("t_s,");
                } else {
                    // Writing to a String cannot fail.
                    let _ = write!(out, "{:?},", f64::from(row) * period_s);
                    row += 1;
                }
            }
            if is_header {
                out.push_str(&self.names.join(","));
            } else {
                let cells = line.split(self.separator).enumerate().map(|(i, cell)| self.cell(i, cell));
                out.push_str(&cells.collect::<Vec<_>>().join(","));
            }
            is_header = false;
            out.push('\n');
        }
        out
    }

    /// Converts a cell of a row. Text that is not a number stays unchanged and is refused later, with its line.
    fn cell<'c>(&self, column: usize, cell: &'c str) -> Cow<'c, str> {
        let cell = unquoted(cell);
        let cell = if self.separator == ',' { Cow::Borrowed(cell) } else { Cow::Owned(cell.replace(',', ".")) };
        match (self.cells.get(column), cell.parse::<f64>()) {
            (Some(Cell::Scaled(scale)), Ok(value)) => Cow::Owned(format!("{:?}", scale.of(value))),
            _ => cell,
        }
    }
}

fn unquoted(cell: &str) -> &str {
    let cell = cell.trim();
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).map_or(cell, str::trim)
}

#[cfg(test)]
mod tests {
    use elbowroom_kinematics::Limits;
    use elbowroom_kinematics::dh::ClassicalRow;
    use elbowroom_robot::RobotId;

    use super::*;

    fn chain() -> Chain {
        let row = |name: &str, kind: JointKind| ClassicalRow {
            joint: name.into(),
            kind,
            a: 0.3,
            alpha: 0.0,
            d: 0.5,
            theta: 0.0,
            limits: Limits::symmetric(7.0),
        };
        Chain::from_dh("arm", &[row("turn", JointKind::Revolute), row("slide", JointKind::Prismatic)]).unwrap()
    }

    fn read_text(text: &str, layout: &RecordingLayout) -> Result<JointStates> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        read(&path, "arm", &chain(), layout)
    }

    fn degrees() -> RecordingLayout {
        RecordingLayout { angle: AngleUnit::Degree, length: LengthUnit::Millimetre, ..RecordingLayout::default() }
    }

    #[test]
    fn the_same_motion_written_in_many_ways_is_the_same() {
        let expected =
            read_text("t_s,turn,slide\n0,0.5235987755982988,0.25\n0.004,0,0.5\n", &RecordingLayout::default());
        let expected = expected.unwrap();
        let of_column = |time: &str, unit_s: f64| RecordingLayout {
            time: Some(time.into()),
            time_unit_s: Some(unit_s),
            ..degrees()
        };
        let renamed = RecordingLayout {
            columns: vec![("turn".into(), "a1".into()), ("slide".into(), "E1".into())],
            ..of_column("t", 1.0)
        };
        let counted = RecordingLayout { period_s: Some(0.004), ..degrees() };
        for (text, layout) in [
            ("t_s,turn,slide\n0,30,250\n0.004,0,500\n", degrees()),
            ("T_S;Turn;SLIDE\r\n0;30,0;250\r\n0,004;0;500,0\r\n", degrees()),
            ("\u{feff}ms\tslide\tturn\n0\t250\t30\n4\t500\t0\n", of_column("MS", 0.001)),
            ("\"t\";\"A1\";\"E1\"\n\n0;30;250\n0.004;0;500\n", renamed),
            ("turn,slide\n30,250\n0,500\n", counted.clone()),
            ("t_s,arm.turn,slide\n99,30,250\n98,0,500\n", counted),
        ] {
            let states = read_text(text, &layout).unwrap();
            assert_eq!(states.times_s(), expected.times_s(), "{text}");
            assert!(
                (0..2).all(|i| states.q(i, RobotId(0)) == expected.q(i, RobotId(0))),
                "{text}: {:?}",
                states.q(0, RobotId(0))
            );
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let mapped = RecordingLayout { columns: vec![("turn".into(), "A9".into())], ..degrees() };
        for (text, layout, expected) in [
            ("turn,slide\n1,2\n", degrees(), "no column `t_s`"),
            ("t_s,A1,slide\n0,1,2\n", mapped, "no column `A9` for `turn`"),
            ("t_s,turn\n0,1\n", degrees(), "slide"),
            ("t_s;turn;slide\n0;1;2\n0,5;x;2\n", degrees(), "log.csv:3:"),
            ("t_s,turn,slide\n0,1\n", degrees(), "log.csv:2:"),
            ("t_s,turn,Turn,slide\n0,1,1,2\n", degrees(), "two columns are named `turn`"),
            ("t_s,turn,slide\n0,900,0\n", degrees(), "outside its limits"),
        ] {
            let message = read_text(text, &layout).unwrap_err().to_string();
            assert!(message.contains(expected), "{expected}: {message}");
        }
    }
}
