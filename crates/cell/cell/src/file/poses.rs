//! CSV files of poses over time: `follow = { poses = "cart.csv" }`.

use elbowroom_formats::toml_tables::Value;
use elbowroom_formats::{Diagnostic, NumberTable, TimedRow, suggest};
use elbowroom_spatial::units::{AngleUnit, LengthUnit};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::models;
use crate::{PoseTrack, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const POSITION: [&str; 3] = ["x", "y", "z"];
const RPY: [&str; 3] = ["roll", "pitch", "yaw"];
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];
const EXAMPLE: &str =
    "t_s,x_m,y_m,z_m,qx,qy,qz,qw   (or x,y,z in the cell's unit; roll,pitch,yaw or roll_deg,…; or no rotation)";

/// Meaning of the columns.
struct Columns {
    position: [usize; 3],
    length: LengthUnit,
    rotation: RotationColumns,
}

enum RotationColumns {
    None,
    Rpy([usize; 3], AngleUnit),
    Quaternion([usize; 4]),
}

/// Reads the file that a value names.
pub(super) fn read(v: &Value<'_>, units: Units) -> Result<PoseTrack> {
    let (table, rows) = read_with(v, units, &[])?;
    let rows = rows.into_iter().map(|row| (row.t_s, row.pose)).collect();
    PoseTrack::new(table.file.clone(), rows).ok_or_else(|| v.error("names a file without rows").hint(EXAMPLE))
}

/// A row of a file of poses.
pub(super) struct PoseRow {
    pub t_s: f64,
    pub pose: Pose,
    /// The values of the other columns, in their order; `None` for a column that the file does not have.
    pub others: Vec<Option<f64>>,
}

/// Reads the file that a value names, which may have other columns too, of 0 and 1.
pub(super) fn read_with(v: &Value<'_>, units: Units, others: &[&str]) -> Result<(NumberTable, Vec<PoseRow>)> {
    let table = models::number_table(v)?;
    let columns = Columns::of(&table, units, others)?;
    let all: Vec<usize> = (0..table.columns.len()).collect();
    let at: Vec<Option<usize>> = others.iter().map(|name| table.columns.iter().position(|c| c == name)).collect();
    let row = |row: TimedRow| {
        let pose = columns.pose(&table, row.line, &row.values)?;
        let odd = at.iter().flatten().find(|c| !matches!(row.values[**c], 0.0 | 1.0));
        if let Some(column) = odd {
            let what = format!("has {} in the column `{}`", row.values[*column], table.columns[*column]);
            return Err(Diagnostic::new(&table.file, row.line, what).hint("0 or 1"));
        }
        Ok(PoseRow { t_s: row.t_s, pose, others: at.iter().map(|c| c.map(|c| row.values[c])).collect() })
    };
    let rows = table.timed(&all)?.into_iter().map(row).collect::<Result<Vec<_>>>()?;
    Ok((table, rows))
}

impl Columns {
    fn of(table: &NumberTable, units: Units, others: &[&str]) -> Result<Self> {
        let lengths = [("", units.length), ("_m", LengthUnit::Metre), ("_mm", LengthUnit::Millimetre)];
        let angles = [("", units.angle), ("_rad", AngleUnit::Radian), ("_deg", AngleUnit::Degree)];
        let known = |suffixes: &[&str], names: &[&str]| -> Vec<String> {
            suffixes.iter().flat_map(|s| names.iter().map(move |n| format!("{n}{s}"))).collect()
        };
        let mut names = vec!["t_s".to_owned()];
        names.extend(known(&["", "_m", "_mm"], &POSITION));
        names.extend(known(&["", "_rad", "_deg"], &RPY));
        names.extend(known(&[""], &QUATERNION));
        names.extend(others.iter().map(|&name| name.to_owned()));
        if let Some(odd) = table.columns.iter().find(|c| !names.contains(c)) {
            let what = format!("has a column `{odd}`, which is no part of a pose");
            let hint = suggest::hint(odd, names.iter().map(String::as_str));
            return Err(Diagnostic::new(&table.file, 1, what).hint(hint));
        }
        let wrong = |what: &str| Diagnostic::new(&table.file, 1, what).hint(EXAMPLE);
        let (position, length) =
            one_of(table, &POSITION, &lengths).ok_or_else(|| wrong("needs the columns x, y, z, all in one unit"))?;
        let other = table.columns.iter().filter(|c| others.contains(&c.as_str())).count();
        let turned = table.columns.len() - 4 - other;
        let rotation = match (one_of(table, &RPY, &angles), all(table, &QUATERNION, "")) {
            _ if turned == 0 => RotationColumns::None,
            (Some((rpy, unit)), None) if turned == 3 => RotationColumns::Rpy(rpy, unit),
            (None, Some(quaternion)) if turned == 4 => RotationColumns::Quaternion(quaternion),
            _ => return Err(wrong("needs either roll, pitch, yaw in one unit, or qx, qy, qz, qw, or no rotation")),
        };
        Ok(Self { position, length, rotation })
    }

    fn pose(&self, table: &NumberTable, line: usize, row: &[f64]) -> Result<Pose> {
        let at = Vec3::from(self.position.map(|c| self.length.to_metres(row[c])));
        let rotation = match &self.rotation {
            RotationColumns::None => Rotation::IDENTITY,
            RotationColumns::Rpy(columns, unit) => {
                let [r, p, y] = columns.map(|c| unit.to_radians(row[c]));
                Rotation::from_rpy(r, p, y)
            }
            RotationColumns::Quaternion(columns) => {
                let q = columns.map(|c| row[c]);
                let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
                let sound = (0.9..=1.1).contains(&length);
                let turned = Rotation::from_quaternion_xyzw(q).filter(|_| sound);
                turned.ok_or_else(|| {
                    Diagnostic::new(&table.file, line, format!("has the quaternion {q:?} of length {length:.3}"))
                        .hint("qx, qy, qz, qw of length 1, qw last: 0, 0, 0, 1 for no rotation")
                })?
            }
        };
        Ok(Pose::new(rotation, at))
    }
}

/// The columns of these names with one of the suffixes, and its unit.
fn one_of<const N: usize, U: Copy>(
    table: &NumberTable,
    names: &[&str; N],
    suffixes: &[(&str, U)],
) -> Option<([usize; N], U)> {
    suffixes.iter().find_map(|(suffix, unit)| Some((all(table, names, suffix)?, *unit)))
}

fn all<const N: usize>(table: &NumberTable, names: &[&str; N], suffix: &str) -> Option<[usize; N]> {
    let mut columns = [0; N];
    for (to, name) in columns.iter_mut().zip(names) {
        let wanted = format!("{name}{suffix}");
        *to = table.columns.iter().position(|c| *c == wanted)?;
    }
    Some(columns)
}
