//! Files named by a cell file: models, meshes, tables.

use std::path::{Path, PathBuf};

use elbowroom_formats::srdf::{self as srdf_file, GroupState};
use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{
    Diagnostic, LoadOptions, LoadedRobot, NumberTable, mesh as mesh_file, read_file, robot as robot_file,
};
use elbowroom_kinematics::Chain;
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::units::LengthUnit;

/// Largest SRDF, bytes.
const MAX_SRDF_BYTES: u64 = 64 << 20;

type Result<T> = std::result::Result<T, Diagnostic>;

/// The file that a value names, relative to the cell file; it must exist.
pub(super) fn path(v: &Value<'_>) -> Result<PathBuf> {
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

/// The models of a cell's robots. Robots of one model share its meshes, and what is computed for them: volumes, hulls.
#[derive(Default)]
pub(super) struct RobotModels {
    loaded: Vec<(PathBuf, LoadOptions, LoadedRobot)>,
}

impl RobotModels {
    /// The robot of `model`, with its SRDF, joints file and unit.
    pub(super) fn robot(&mut self, v: &Value<'_>, t: &Table<'_>, warnings: &mut Vec<Diagnostic>) -> Result<Robot> {
        let file = path(v)?;
        let unit = t.get("unit").map(|u| mesh_unit(&u)).transpose()?;
        let of = |key: &str| t.get(key).map(|v| path(&v)).transpose();
        let options = LoadOptions { srdf: of("srdf")?, joints: of("joints")?, unit, ..LoadOptions::default() };
        let loaded = self.load(file, options)?;
        if loaded.robot.chain.dof() == 0 {
            let why = loaded.warnings.iter().find(|w| w.message.starts_with("no joint moves"));
            let hint = why.and_then(|w| w.hint.clone());
            let hint = hint.unwrap_or_else(|| "a model of a robot; solid objects go under [object.NAME]".to_owned());
            return Err(v.error("names a model without a joint that moves").hint(hint));
        }
        warnings.extend(loaded.warnings.iter().cloned());
        Ok(loaded.robot.clone())
    }

    fn load(&mut self, file: PathBuf, options: LoadOptions) -> Result<&LoadedRobot> {
        let known = self.loaded.iter().position(|(path, with, _)| *path == file && *with == options);
        let at = known.unwrap_or(self.loaded.len());
        if known.is_none() {
            let loaded = robot_file::load(&file, &options)?;
            self.loaded.push((file, options, loaded));
        }
        Ok(&self.loaded[at].2)
    }
}

/// Disables the pairs in the file of `srdf`.
pub(super) fn srdf(v: &Value<'_>, robot: &mut Robot, warnings: &mut Vec<Diagnostic>) -> Result<()> {
    warnings.extend(robot_file::apply_srdf(robot, &path(v)?)?);
    Ok(())
}

/// The named states of the file of `srdf`.
///
/// A joint that a state does not mention has its start value. Of several states of one name, the one with the most
/// joints counts.
pub(super) fn srdf_states(v: &Value<'_>, chain: &Chain, start: &[f64]) -> Result<Vec<(String, Vec<f64>)>> {
    let file = path(v)?;
    let parsed = srdf_file::parse(&read_file(&file, MAX_SRDF_BYTES, "an SRDF of one robot")?, &file)?;
    let index = |joint: &str| chain.q_index(chain.joint(joint)?);
    let known = |state: &GroupState| state.values.iter().filter(|(joint, _)| index(joint).is_some()).count();
    let mut states: Vec<(String, usize, Vec<f64>)> = Vec::new();
    for state in parsed.states.iter().filter(|state| known(state) > 0) {
        let mut q = start.to_vec();
        for (joint, value) in &state.values {
            if let Some(i) = index(joint) {
                q[i] = *value;
            }
        }
        match states.iter_mut().find(|(name, ..)| *name == state.name) {
            Some(other) if other.1 < known(state) => *other = (state.name.clone(), known(state), q),
            Some(_) => {}
            None => states.push((state.name.clone(), known(state), q)),
        }
    }
    Ok(states.into_iter().map(|(name, _, q)| (name, q)).collect())
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
    let whole = mesh_file::load(&path, Some(unit))?.merged();
    if whole.triangles.is_empty() {
        return Err(v.error(format!("names {}, which holds no triangles", path.display())).hint("a mesh with faces"));
    }
    whole.into_trimesh(&path).map(|m| Shape::Mesh(m.into()))
}

/// The table that a value names.
pub(super) fn number_table(v: &Value<'_>) -> Result<NumberTable> {
    NumberTable::read(&path(v)?)
}

/// `t_s,travel_m` of an encoder, in SI units.
pub(super) fn travel(v: &Value<'_>) -> Result<Vec<(f64, f64)>> {
    let table = number_table(v)?;
    let column = table.column("travel_m")?;
    Ok(table.timed(&[column])?.into_iter().map(|row| (row.t_s, row.values[0])).collect())
}
