//! The joint-space map of a robot of a cell (`elbowroom map`).
//!
//! Every object is an obstacle, moving ones at their initial poses. Self-collisions, other robots, and links that the
//! map's joints do not move are omitted.

use std::time::{Duration, Instant};

use elbowroom_cell::{Cell, CellRobot, MapSpec};
use elbowroom_cspace::{GridAxis, GridAxisError, ObstacleModel, OccupancyArray, RemainingJoints, RobotMapError};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::JointKind;
use elbowroom_proximity::Shape;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::Object;
use elbowroom_spatial::Pose;

pub use self::blocked_cells::BlockedCells;
pub(crate) use self::link_maps::LinkMaps;
pub use self::model::{MapModel, UnknownMapModel};
use self::solids_map::FilledCells;
pub(crate) use self::solids_map::SolidsMap;
use crate::plan::request_validation::select_robot;

pub(crate) mod blocked_cells;
mod link_maps;
pub(crate) mod mapped_joints;
mod model;
mod solids_map;

/// A request for the map of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MapRequest {
    /// Name of the robot; optional if there is only one robot, or only one map.
    pub robot: Option<String>,
    /// Obstacle model of the objects.
    pub model: MapModel,
    /// Whether the robot's own solids decide at the border, which takes tenths of a second per object.
    ///
    /// Otherwise sphere covers of its links decide, in milliseconds, for maps of three joints, if one of these joints
    /// carries all links of the map. Other maps always use the solids.
    pub exact: bool,
    /// With the model of spheres, the time since the preparation of the robot until which spheres are added.
    ///
    /// One sphere around each object comes first, then more and smaller ones, at most as many as the model states.
    pub deadline: Option<Duration>,
}

/// Progress of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapProgress<'a> {
    /// Finished fraction, 0..1.
    pub share: f64,
    /// The present work: the robot, or the name of an object.
    pub what: &'a str,
}

/// The map of a robot, and the cells that each object blocks.
#[derive(Debug, Clone)]
pub struct CellMap {
    /// Name of the robot.
    pub robot: String,
    /// The joint axes, divided into cells.
    pub axes: Vec<GridAxis>,
    /// Per axis: true for an angle.
    pub is_angle: Vec<bool>,
    /// One per object of the cell, in its order.
    pub obstacles: Vec<MapObstacle>,
    /// Number of cells that any object blocks.
    pub blocked: u64,
    /// Number of cells blocked by fixed objects.
    pub static_blocked: u64,
    /// The union of all obstacles, cell by cell; `None` if there are too many cells.
    pub dense: Option<OccupancyArray>,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
}

/// The cells blocked by one object.
#[derive(Debug, Clone)]
pub struct MapObstacle {
    /// Its name.
    pub name: String,
    /// Its obstacle model.
    pub model: MapModel,
    /// Number of spheres reached at the deadline, if there is one.
    pub spheres: Option<u32>,
    /// The blocked cells.
    pub blocks: BlockedCells,
    /// Time of the computation, without the preparation of the robot and of the object's shape.
    pub time: Duration,
}

/// Computes the map of a robot.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::map::{MapRequest, map};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
/// links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.ball]
/// shape = "sphere"
/// at = [600, 0, 0]
/// radius = 100
/// [map.arm]
/// step = 2
/// "#)?;
/// let map = map(&cell, &MapRequest::default())?;
/// assert_eq!(map.axes.iter().map(|a| a.count()).collect::<Vec<_>>(), [170, 170]);
/// assert!(map.obstacles[0].blocks.is_blocked(&[0.0, 0.0]) && map.blocked < 170 * 170 / 2);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// An unknown or ambiguous robot, a joint without limits, too many cells for the memory; a deadline with another model than
/// spheres, or for a map that is not on sphere covers.
pub fn map(cell: &Cell, request: &MapRequest) -> Result<CellMap, Diagnostic> {
    map_with(cell, request, &|_| ())
}

/// Like [`map`]; `progress` is called from any thread.
///
/// # Errors
/// As for [`map`].
pub fn map_with(
    cell: &Cell,
    request: &MapRequest,
    progress: &(dyn Fn(MapProgress<'_>) + Sync),
) -> Result<CellMap, Diagnostic> {
    let (id, robot, spec) = select_map(cell, request.robot.as_deref())?;
    let wrong = |what: String, hint: &str| Diagnostic::new(&cell.file, spec.line, what).hint(hint);
    let mut warnings = Vec::new();
    let (axes, is_angle) = axes(cell, robot, &spec, &mut warnings)?;
    let others = if spec.others_at_start { RemainingJoints::Fixed(&robot.start) } else { RemainingJoints::Swept };
    let refuse = |e: RobotMapError| {
        let hint = match e {
            RobotMapError::Memory { .. } => "step = 5   (a larger step, or fewer joints)",
            RobotMapError::Count(_) | RobotMapError::Joint { .. } => "joints = [\"joint_1\", \"joint_2\", \"joint_3\"]",
            _ => "finite poses and sizes",
        };
        wrong(format!("robot \"{}\": {e}", robot.name), hint)
    };
    progress(MapProgress { share: 0.0, what: &robot.name });
    let maps = LinkMaps::new(cell, id, |robot| {
        SolidsMap::new(robot, &axes, &spec.joints, others, (!request.exact).then_some(0.0)).map_err(refuse)
    })?;
    let filled = fill(cell, request, &maps, progress, &wrong)?.map_err(refuse)?;
    let obstacle = |(object, filled): (&Object, FilledCells)| {
        let FilledCells { blocks, time, spheres } = filled;
        MapObstacle { name: object.name.clone(), model: request.model, spheres, blocks, time }
    };
    let obstacles: Vec<MapObstacle> = cell.objects.iter().zip(filled).map(obstacle).collect();
    let moves = |o: ObjectId| cell.moving_objects.iter().any(|m| m.object == o);
    let count = |dense: Option<&OccupancyArray>, which: &dyn Fn(ObjectId) -> bool| {
        if let Some(dense) = dense {
            return Ok(dense.blocked());
        }
        let report = |share: f64| progress(MapProgress { share, what: "all objects together" });
        // Only maps with the robot's own solids have so many cells, and these maps support no other models.
        let MapModel::Solids(model) = request.model else { return Ok(0) };
        let of_map = |(map, objects): (&SolidsMap, Vec<ObjectId>)| {
            let solids: Vec<_> = objects.iter().filter(|o| which(**o)).map(|o| placed(&cell.objects[o.0])).collect();
            map.fill(model, &solids, &report).map(|all| all.blocks.blocked()).map_err(refuse)
        };
        // If links may touch only some objects, cells that several maps block count several times.
        let counts = maps.each().map(of_map).collect::<Result<Vec<u64>, Diagnostic>>()?;
        Ok(counts.into_iter().fold(0, u64::saturating_add))
    };
    let dense = blocked_cells::union(&axes, obstacles.iter().map(|o| &o.blocks));
    let blocked = count(dense.as_ref(), &|_| true)?;
    let static_blocked = if cell.moving_objects.is_empty() {
        blocked
    } else {
        let fixed = obstacles.iter().enumerate().filter(|o| !moves(ObjectId(o.0))).map(|o| &o.1.blocks);
        count(blocked_cells::union(&axes, fixed).as_ref(), &|o| !moves(o))?
    };
    warnings.extend(notes(cell, robot, spec.line, request.model));
    Ok(CellMap { robot: robot.name.clone(), axes, is_angle, obstacles, blocked, static_blocked, dense, warnings })
}

/// Notes on what a map omits, and on what it must not be used for.
fn notes(cell: &Cell, robot: &CellRobot, line: usize, model: MapModel) -> Vec<Diagnostic> {
    let mut notes = Vec::new();
    for m in &cell.moving_objects {
        let what = format!("object \"{}\" moves: the map has it at its initial pose", cell.objects[m.object.0].name);
        notes.push(Diagnostic::new(&cell.file, line, what));
    }
    if !model.is_conservative() {
        let what = "the model `seeds` misses blocked cells that no seed leads to: for comparison only, no robot may rely on it";
        notes.push(Diagnostic::new(&cell.file, line, what));
    }
    if cell.robots.len() > 1 {
        let what = format!("the map of \"{}\" leaves the other robots out: they move", robot.name);
        notes.push(Diagnostic::new(&cell.file, line, what));
    }
    notes
}

fn placed(object: &Object) -> (&Shape, Pose) {
    (&object.shape, object.in_world)
}

/// The cells that each object blocks. The outer error means that this map or model does not suit the request.
fn fill(
    cell: &Cell,
    request: &MapRequest,
    maps: &LinkMaps,
    progress: &(dyn Fn(MapProgress<'_>) + Sync),
    wrong: &dyn Fn(String, &str) -> Diagnostic,
) -> Result<Result<Vec<FilledCells>, RobotMapError>, Diagnostic> {
    let every_link = || {
        maps.of_every_link().ok_or_else(|| {
            let what = "the file of pairs lets links touch objects: such maps have neither a deadline nor seeds";
            wrong(what.into(), "--model exact, without --deadline")
        })
    };
    match (request.model, request.deadline) {
        (MapModel::Solids(model), None) => Ok(fill_each(cell, maps, model, progress)),
        (MapModel::Seeds, None) => expand_each(cell, every_link()?, progress, wrong),
        (model, Some(limit)) => fill_until(cell, every_link()?, model, limit, wrong),
    }
}

/// The cells that each object blocks.
fn fill_each(
    cell: &Cell,
    maps: &LinkMaps,
    model: ObstacleModel,
    progress: &(dyn Fn(MapProgress<'_>) + Sync),
) -> Result<Vec<FilledCells>, RobotMapError> {
    let count = cell.objects.len() as f64;
    let fill = |(number, object): (usize, &Object)| {
        let report = |share: f64| progress(MapProgress { share: (number as f64 + share) / count, what: &object.name });
        report(0.0);
        match maps.of(ObjectId(number)) {
            Some(map) => map.fill(model, &[placed(object)], &report),
            None => maps.first().fill(model, &[], &report),
        }
    };
    cell.objects.iter().enumerate().map(fill).collect()
}

/// The cells around seeds of each object. The outer error means that this map is not on sphere covers.
fn expand_each(
    cell: &Cell,
    solids_map: &SolidsMap,
    progress: &(dyn Fn(MapProgress<'_>) + Sync),
    wrong: &dyn Fn(String, &str) -> Diagnostic,
) -> Result<Result<Vec<FilledCells>, RobotMapError>, Diagnostic> {
    let mut filled = Vec::with_capacity(cell.objects.len());
    for (number, object) in cell.objects.iter().enumerate() {
        progress(MapProgress { share: number as f64 / cell.objects.len() as f64, what: &object.name });
        let (shape, in_world) = placed(object);
        let Some(found) = solids_map.expand(shape, &in_world) else {
            let what = "expansion from seeds is for maps on sphere covers: three joints that hang on one of them, without --exact";
            return Err(wrong(what.into(), "--model exact, or three joints and no --exact"));
        };
        match found {
            Ok(cells) => filled.push(cells),
            Err(e) => return Ok(Err(e)),
        }
    }
    Ok(Ok(filled))
}

/// The cells that each object blocks, refined until a deadline. The outer error means that this model or map does not
/// support it.
fn fill_until(
    cell: &Cell,
    solids_map: &SolidsMap,
    model: MapModel,
    limit: Duration,
    wrong: &dyn Fn(String, &str) -> Diagnostic,
) -> Result<Result<Vec<FilledCells>, RobotMapError>, Diagnostic> {
    let MapModel::Solids(ObstacleModel::Spheres(most)) = model else {
        let what = format!("a deadline is for the model of spheres, which is refined until then, not for `{model}`");
        return Err(wrong(what, "--model spheres=64 --deadline 5"));
    };
    let objects: Vec<_> = cell.objects.iter().map(placed).collect();
    solids_map.fill_until(Instant::now() + limit, most, &objects).ok_or_else(|| {
        let what = "a deadline is for maps on sphere covers: three joints that hang on one of them, without --exact";
        wrong(what.into(), "no --deadline, or three joints and no --exact")
    })
}

impl CellMap {
    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.axes.iter().map(|a| a.count() as u64).fold(1, u64::saturating_mul)
    }

    /// Memory of the blocked cells, bytes.
    pub fn bytes(&self) -> usize {
        self.obstacles.iter().map(|o| o.blocks.bytes()).sum()
    }
}

/// The requested robot, otherwise the only one with a map, otherwise the only one.
pub(crate) fn select_map<'c>(
    cell: &'c Cell,
    name: Option<&str>,
) -> Result<(RobotId, &'c CellRobot, MapSpec), Diagnostic> {
    let mut mapped = (0..cell.robots.len()).map(RobotId).filter(|id| cell.robots[id.0].map.is_some());
    let id = match (name, mapped.next(), mapped.next()) {
        (None, Some(only), None) => only,
        _ => select_robot(cell, name)?.0,
    };
    let robot = &cell.robots[id.0];
    Ok((id, robot, robot.map.clone().unwrap_or_else(|| MapSpec::of(robot))))
}

/// The joint axes. Continuous joints have a range of one turn.
pub(crate) fn axes(
    cell: &Cell,
    robot: &CellRobot,
    spec: &MapSpec,
    warnings: &mut Vec<Diagnostic>,
) -> Result<(Vec<GridAxis>, Vec<bool>), Diagnostic> {
    let chain = &robot.robot.chain;
    let mut axes = Vec::new();
    let mut is_angle = Vec::new();
    for (&index, &step) in spec.joints.iter().zip(&spec.step) {
        let joint = &chain.joints()[chain.active_joints()[index].0];
        let limits = match joint.kind {
            JointKind::Continuous => {
                let what = format!("joint \"{}\" is continuous: the map covers -180 to 180 degrees", joint.name);
                warnings.push(Diagnostic::new(&cell.file, spec.line, what));
                [-std::f64::consts::PI, std::f64::consts::PI]
            }
            _ => [joint.limits.lower, joint.limits.upper],
        };
        let axis = GridAxis::new(&joint.name, limits[0], limits[1], step).map_err(|e| {
            let hint = match e {
                GridAxisError::TooMany { .. } | GridAxisError::Step { .. } => {
                    "step = 2   (larger, in the cell's units)"
                }
                _ => "lower and upper limits for the joint in the robot's model, or joints = [...] without it",
            };
            Diagnostic::new(&cell.file, spec.line, format!("robot \"{}\": {e}", robot.name)).hint(hint)
        })?;
        axes.push(axis);
        is_angle.push(joint.kind.turns());
    }
    Ok((axes, is_angle))
}
