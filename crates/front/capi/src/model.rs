//! Loaded models: constant, and shared by threads.

use std::ffi::CString;
use std::path::Path;
use std::sync::Arc;

use elbowroom::Diagnostic;
use elbowroom::cell::{Cell, OutOfReachProofs, PairFile, QueryModel};
use elbowroom::formats::robot::{self, LoadOptions};
use elbowroom::formats::suggest;
use elbowroom::query::{QueryPairs, QueryPairsError};
use elbowroom::robot::{Robot, RobotId};
use elbowroom::scene::{Scene, SceneState};
use elbowroom::spatial::Pose;
use elbowroom::spatial::units::LengthUnit;

use crate::failure::{Failure, c_text};
use crate::names::{Names, RobotNames};

/// A loaded model: `elbowroom_model` in C.
#[derive(Debug)]
pub struct ModelHandle(pub(crate) Arc<Model>);

/// Robots and objects with their scene.
#[derive(Debug)]
pub(crate) struct Model {
    pub query: QueryModel,
    pub scene: Scene,
    pub names: Names,
    pub warnings: Vec<CString>,
    /// Every robot at its start.
    pub start_state: SceneState,
}

/// A robot to load, with texts of Rust.
pub(crate) struct RobotSource<'t> {
    pub name: &'t str,
    pub path: &'t str,
    pub options: LoadOptions,
    pub base_in_world: Pose,
}

impl ModelHandle {
    /// Loads a cell; `regions` are names with commas between, which become solids as those of `query --between`.
    pub(crate) fn load_cell(path: &str, regions: Option<&str>) -> Result<Self, Failure> {
        let cell = Cell::load(path)?;
        let mut model = QueryModel::of_cell(&cell);
        for name in regions.into_iter().flat_map(|names| names.split(',')).map(str::trim) {
            let is_known = cell.regions.iter().any(|region| region.region.name == name);
            // A region that was named before is an object already.
            if is_known && (model.selection(name).is_some() || model.add_region(&cell, name)) {
                continue;
            }
            let hint = suggest::hint(name, cell.regions.iter().map(|region| region.region.name.as_str()));
            return Err(Failure::unknown(format!("\"{name}\" is no region of {path}\n  write: {hint}")));
        }
        Self::new(model, &cell.warnings)
    }

    /// Loads one robot, whose root link is the world, as `query --urdf`.
    pub(crate) fn load_robot(path: &str, options: &LoadOptions, pairs: Option<&str>) -> Result<Self, Failure> {
        let loaded = robot::load(path.as_ref(), options)?;
        Self::of_robots(QueryModel::of_robot(path.as_ref(), loaded.robot), pairs, loaded.warnings)
    }

    /// Loads robots beside each other.
    pub(crate) fn load_robots(sources: &[RobotSource<'_>], pairs: Option<&str>) -> Result<Self, Failure> {
        let Some(first) = sources.first() else {
            return Err(Failure::invalid("there is no robot to load\n  write: `count` 1 or more"));
        };
        let mut warnings = Vec::new();
        let mut robots: Vec<(String, Robot, Pose)> = Vec::with_capacity(sources.len());
        for source in sources {
            check_name(source.name, &robots)?;
            let mut loaded = robot::load(source.path.as_ref(), &source.options)?;
            // A file that several robots use warns once.
            loaded.warnings.retain(|warning| !warnings.contains(warning));
            warnings.append(&mut loaded.warnings);
            robots.push((source.name.to_owned(), loaded.robot, source.base_in_world));
        }
        Self::of_robots(QueryModel::of_robots(first.path.as_ref(), robots), pairs, warnings)
    }

    fn of_robots(mut model: QueryModel, pairs: Option<&str>, mut warnings: Vec<Diagnostic>) -> Result<Self, Failure> {
        if let Some(path) = pairs {
            let rules = PairFile::read(Path::new(path))?.rules(&model)?;
            model.add_rules(rules);
        }
        warnings.append(&mut model.touching_at_rest());
        Self::new(model, &warnings)
    }

    fn new(query: QueryModel, warnings: &[Diagnostic]) -> Result<Self, Failure> {
        let scene = query.scene(OutOfReachProofs::Compute)?;
        let mut start_state = query.start_state(&scene)?;
        for (robot, of_robot) in query.robots.iter().enumerate() {
            start_state.set_q(&scene, RobotId(robot), &of_robot.start)?;
        }
        let names = Names::of(&query);
        let warnings = warnings.iter().map(|warning| c_text(&warning.to_string())).collect();
        Ok(Self(Arc::new(Model { query, scene, names, warnings, start_state })))
    }
}

/// Refuses a name that pairs and answers could not name.
fn check_name(name: &str, earlier: &[(String, Robot, Pose)]) -> Result<(), Failure> {
    let is_used = earlier.iter().any(|(known, ..)| known == name);
    if name.trim().is_empty() || name.trim() != name || name.contains(['/', ',', ';']) || is_used {
        let why = if is_used { "is used twice" } else { "is no name of a robot" };
        let what = "a name of its own for each robot, without / , ; and without spaces around it, as left";
        return Err(Failure::invalid(format!("\"{name}\" {why}\n  write: {what}")));
    }
    Ok(())
}

impl Model {
    /// The names of a robot.
    pub fn robot(&self, robot: usize) -> Result<&RobotNames, Failure> {
        at("robot", &self.names.robots, robot)
    }

    /// Lower and upper limits of the joints of a robot, rad or m.
    pub fn limits(&self, robot: usize) -> Result<(Vec<f64>, Vec<f64>), Failure> {
        let chain = &at("robot", &self.query.robots, robot)?.robot.chain;
        Ok((chain.lower(), chain.upper()))
    }

    /// The joint values of a robot at its start, rad or m.
    pub fn start(&self, robot: usize) -> Result<&[f64], Failure> {
        Ok(&at("robot", &self.query.robots, robot)?.start)
    }

    /// Index of the robot with a name.
    pub fn find_robot(&self, name: &str) -> Result<usize, Failure> {
        find("robot", self.names.robots.iter().map(|robot| &robot.name), name)
    }

    /// Index of the link of a robot with a name.
    pub fn find_link(&self, robot: usize, name: &str) -> Result<usize, Failure> {
        find("link", self.robot(robot)?.links.iter(), name)
    }

    /// The pairs between named sides, `A,B;C,D`; `None`: all.
    pub fn pairs(&self, between: Option<&str>) -> Result<QueryPairs, Failure> {
        let Some(text) = between else { return Ok(QueryPairs::all()) };
        // Without a cell no region is added, so the copy only pays for the names.
        QueryPairs::between(text, &mut self.query.clone(), None).map_err(|error| match error {
            QueryPairsError::Unknown { .. } => Failure::unknown(error.to_string()),
            _ => Failure::invalid(error.to_string()),
        })
    }
}

/// An element of a list, or what the list has.
pub(crate) fn at<'l, T>(what: &str, list: &'l [T], index: usize) -> Result<&'l T, Failure> {
    let count = list.len();
    list.get(index)
        .ok_or_else(|| Failure::invalid(format!("there is no {what} {index}; there are {count}, counted from 0")))
}

fn find<'n>(what: &str, names: impl Iterator<Item = &'n CString> + Clone, name: &str) -> Result<usize, Failure> {
    let known = names.map(|name| name.to_str().unwrap_or_default());
    known.clone().position(|known| known == name).ok_or_else(|| {
        Failure::unknown(format!("there is no {what} \"{name}\"\n  write: {}", suggest::hint(name, known)))
    })
}

/// The unit with a symbol.
pub(crate) fn unit(symbol: &str) -> Result<LengthUnit, Failure> {
    LengthUnit::parse(symbol)
        .ok_or_else(|| Failure::invalid(format!("`{symbol}` is no unit\n  write: m, cm, mm or in")))
}
