//! Files named by a cell file: models, meshes, tables.

use std::fs;
use std::path::{Path, PathBuf};

use elbowroom_formats::{FormatError, LoadOptions, MeshData, Warning, mesh as mesh_file, robot as robot_file};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::units::LengthUnit;

use super::read::{Table, Value};

type Result<T> = std::result::Result<T, FormatError>;

/// Largest table, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// The file that a value names, relative to the cell file; it must exist.
fn path(v: &Value<'_>) -> Result<PathBuf> {
    let name = v.text()?;
    let path = v.file.parent().unwrap_or(Path::new("")).join(name);
    if name.is_empty() || name.contains('\0') {
        return Err(v.error("names no file").hint("the path of a file, relative to the cell file"));
    }
    if path.is_file() {
        return Ok(path);
    }
    let what = if path.is_dir() { "is a folder" } else { "does not exist" };
    let hint = format!("the path of a file, relative to {}", folder(v.file));
    Err(v.error(format!("names \"{name}\", but {} {what}", path.display())).hint(hint))
}

fn folder(file: &Path) -> String {
    match file.parent() {
        Some(p) if !p.as_os_str().is_empty() => p.display().to_string(),
        _ => "the folder of the cell file".into(),
    }
}

/// The robot of `model`, with its SRDF, joints file and unit.
pub(super) fn robot(v: &Value<'_>, t: &Table<'_>, warnings: &mut Vec<Warning>) -> Result<Robot> {
    let file = path(v)?;
    let unit = t.get("unit").map(|u| mesh_unit(&u)).transpose()?;
    let of = |key: &str| t.get(key).map(|v| path(&v)).transpose();
    let options = LoadOptions { srdf: of("srdf")?, joints: of("joints")?, unit, ..LoadOptions::default() };
    let loaded = robot_file::load(&file, &options)?;
    if loaded.robot.chain.dof() == 0 {
        let why = loaded.warnings.into_iter().find(|w| w.what.starts_with("no joint moves"));
        let hint = why.and_then(|w| w.write_instead);
        let hint = hint.unwrap_or_else(|| "a model of a robot; solid objects go under [object.NAME]".to_owned());
        return Err(v.error("names a model without a joint that moves").hint(hint));
    }
    warnings.extend(loaded.warnings);
    Ok(loaded.robot)
}

/// Disables the pairs in the file of `srdf`.
pub(super) fn srdf(v: &Value<'_>, robot: &mut Robot, warnings: &mut Vec<Warning>) -> Result<()> {
    warnings.extend(robot_file::apply_srdf(robot, &path(v)?)?);
    Ok(())
}

pub(super) fn mesh_unit(v: &Value<'_>) -> Result<LengthUnit> {
    v.word(&[
        ("m", LengthUnit::Metre),
        ("mm", LengthUnit::Millimetre),
        ("cm", LengthUnit::Centimetre),
        ("in", LengthUnit::Inch),
    ])
}

pub(super) fn mesh(v: &Value<'_>, unit: LengthUnit) -> Result<Shape> {
    let path = path(v)?;
    let loaded = mesh_file::load(&path, Some(unit))?;
    let mut whole = MeshData { name: String::new(), vertices: Vec::new(), triangles: Vec::new() };
    for part in loaded.meshes {
        let offset = whole.vertices.len() as u32;
        whole.vertices.extend(part.vertices);
        whole.triangles.extend(part.triangles.into_iter().map(|t| t.map(|i| i.saturating_add(offset))));
    }
    if whole.triangles.is_empty() {
        return Err(v.error(format!("names {}, which holds no triangles", path.display())).hint("a mesh with faces"));
    }
    whole.into_trimesh(&path).map(|m| Shape::Mesh(m.into()))
}

/// A CSV file of numbers with a header.
pub struct NumberTable {
    /// The file.
    pub file: PathBuf,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows and their lines.
    pub rows: Vec<(usize, Vec<f64>)>,
}

impl NumberTable {
    /// Reads the file; empty lines are skipped.
    ///
    /// # Errors
    /// [`FormatError`] with the line of a cell that is not a number, a row of another length, or a header with a
    /// repeated name.
    pub fn read(path: &Path) -> Result<Self> {
        let size = fs::metadata(path).map_err(|e| FormatError::new(path, None, format!("cannot be read: {e}")))?.len();
        if size > MOST_BYTES {
            return Err(FormatError::new(path, None, format!("has {size} bytes; at most {MOST_BYTES} are read")));
        }
        let bytes = fs::read(path).map_err(|e| FormatError::new(path, None, format!("cannot be read: {e}")))?;
        let text = String::from_utf8(bytes).map_err(|_| FormatError::new(path, None, "is not UTF-8 text"))?;
        Self::parse(path, &text)
    }

    /// Parses the text of such a file.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().enumerate().map(|(i, l)| (i + 1, l)).filter(|l| !l.1.trim().is_empty());
        let Some((first, header)) = lines.next() else {
            return Err(FormatError::new(path, 1, "is empty").hint("a header of column names, then rows of numbers"));
        };
        let columns: Vec<String> = header.split(',').map(|c| c.trim().trim_matches('"').to_owned()).collect();
        if let Some(c) = columns.iter().enumerate().find(|(i, c)| columns[..*i].contains(c)) {
            return Err(
                FormatError::new(path, first, format!("two columns are named `{}`", c.1)).hint("each name once")
            );
        }
        let mut rows = Vec::new();
        for (line, text) in lines {
            rows.push((line, Self::row(path, line, text, &columns)?));
        }
        Ok(Self { file: path.to_owned(), columns, rows })
    }

    fn row(path: &Path, line: usize, text: &str, columns: &[String]) -> Result<Vec<f64>> {
        let cells: Vec<&str> = text.split(',').map(str::trim).collect();
        if cells.len() != columns.len() {
            let what = format!("has {} values for {} columns", cells.len(), columns.len());
            return Err(FormatError::new(path, line, what).hint(columns.join(",")));
        }
        let number = |(i, cell): (usize, &&str)| match unquoted(cell).parse::<f64>() {
            Ok(v) if v.is_finite() => Ok(v),
            _ => Err(FormatError::new(
                path,
                line,
                format!("column `{}` holds \"{cell}\", which is not a finite number", columns[i]),
            )
            .hint("a number such as 0.25")),
        };
        cells.iter().enumerate().map(number).collect()
    }

    /// Index of a column.
    ///
    /// # Errors
    /// [`FormatError`] with the list of columns.
    pub fn column(&self, name: &str) -> Result<usize> {
        self.columns.iter().position(|c| c == name).ok_or_else(|| {
            let what = format!("has no column `{name}`; its columns are {}", self.columns.join(", "));
            FormatError::new(&self.file, 1, what).hint(name)
        })
    }

    /// The rows with increasing times.
    pub(super) fn timed(&self, columns: &[usize]) -> Result<Vec<(usize, f64, Vec<f64>)>> {
        let time = self.column("t_s")?;
        let mut last = f64::NEG_INFINITY;
        let mut rows = Vec::with_capacity(self.rows.len());
        for (line, row) in &self.rows {
            let t = row[time];
            if t <= last {
                let what = format!("t_s is {t} after {last}");
                return Err(FormatError::new(&self.file, *line, what).hint("times that rise from row to row"));
            }
            last = t;
            rows.push((*line, t, columns.iter().map(|c| row[*c]).collect()));
        }
        if rows.is_empty() {
            return Err(FormatError::new(&self.file, 1, "has no rows").hint("rows of numbers below the header"));
        }
        Ok(rows)
    }
}

pub(super) fn number_table(v: &Value<'_>) -> Result<NumberTable> {
    NumberTable::read(&path(v)?)
}

/// `t_s,travel_m` of an encoder, in SI units.
pub(super) fn travel(v: &Value<'_>) -> Result<Vec<(f64, f64)>> {
    let table = number_table(v)?;
    let column = table.column("travel_m")?;
    Ok(table.timed(&[column])?.into_iter().map(|(_, t, row)| (t, row[0])).collect())
}

/// Removes the quotation marks that some programs put around every cell.
fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).map_or(cell, str::trim)
}
