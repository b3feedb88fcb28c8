//! Planning problems of the data, with the robot of each file.

use std::path::{Path, PathBuf};

use elbowroom_formats::problem_set::{self, PlanningProblem};
use elbowroom_robot::Robot;

use crate::cross_validation::world::{self, Files};

/// A file of problems and its robot.
pub struct ProblemFile {
    /// Name of its folder.
    pub name: String,
    pub file: PathBuf,
    pub urdf: PathBuf,
    pub robot: Robot,
    pub problems: Vec<PlanningProblem>,
}

/// Finds every `problems/NAME/*.json`. The robot is the one in the data's `urdf` with the name of a URDF of the folder,
/// because it has meshes; otherwise the folder's first URDF that can be loaded. An error if there is none.
pub fn find(data: &Path) -> Result<Vec<ProblemFile>, String> {
    let mut found = Vec::new();
    for folder in entries(&data.join("problems")) {
        let inside = entries(&folder);
        for file in with_extension(&inside, "json") {
            let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let (urdf, robot) = robot(data, &inside).ok_or_else(|| format!("{}: no robot", file.display()))?;
            let problems = problem_set::read(file).map_err(|e| e.to_string())?.problems;
            found.push(ProblemFile { name, file: file.clone(), urdf, robot, problems });
        }
    }
    Ok(found)
}

/// Lists a folder, sorted; empty if it cannot be read.
fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

fn with_extension<'p>(paths: &'p [PathBuf], extension: &'p str) -> impl Iterator<Item = &'p PathBuf> {
    paths.iter().filter(move |path| path.extension().is_some_and(|e| e == extension))
}

fn robot(data: &Path, inside: &[PathBuf]) -> Option<(PathBuf, Robot)> {
    let with_meshes = |own: &PathBuf| {
        let name = own.file_stem().unwrap_or_default();
        data.join("urdf").join(name).join(name).with_extension("urdf")
    };
    let own = || with_extension(inside, "urdf");
    let candidates = own().map(with_meshes).filter(|urdf| urdf.is_file()).chain(own().cloned());
    candidates.into_iter().find_map(|urdf| {
        let beside = Some(urdf.with_extension("srdf")).filter(|srdf| srdf.is_file());
        let srdf = beside.or_else(|| with_extension(inside, "srdf").next().cloned());
        let robot = world::load(&Files { name: String::new(), urdf: urdf.clone(), srdf }, true).ok()?;
        Some((urdf, robot))
    })
}
