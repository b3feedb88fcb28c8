//! The joint-space map of a robot of a cell (`elbowroom map`).
//!
//! Every object is an obstacle, moving ones at their initial poses. Self-collisions, other robots, and links that none
//! of the map's joints moves are left out.

use std::time::Duration;

use elbowroom_cell::{Cell, CellRobot, MapSpec};
use elbowroom_cspace::{GridAxis, GridAxisError, ObstacleModel, OccupancyArray, RemainingJoints, RobotMapError};
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::{JointKind, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::Object;
use elbowroom_spatial::Pose;

pub use self::blocked_cells::BlockedCells;
use self::solids_map::SolidsMap;
use crate::plan::request_validation::select_robot;

mod blocked_cells;
mod solids_map;

/// A request for the map of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MapRequest {
    /// Name of the robot; optional where there is only one, or only one map.
    pub robot: Option<String>,
    /// Obstacle model of the objects.
    pub model: ObstacleModel,
    /// True: the robot's own solids decide at the border, which takes tenths of a second per object. False: sphere covers
    /// of its links, in milliseconds, for maps of three joints that hang on one of them; others are exact.
    pub exact: bool,
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
    /// Per object of the cell, in its order.
    pub obstacles: Vec<MapObstacle>,
    /// Number of cells that any object blocks.
    pub blocked: u64,
    /// Number of cells blocked by fixed objects.
    pub static_blocked: u64,
    /// The union of all obstacles, cell by cell; `None` where there are too many cells.
    pub dense: Option<OccupancyArray>,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// The cells blocked by one object.
#[derive(Debug, Clone)]
pub struct MapObstacle {
    /// Its name.
    pub name: String,
    /// Its obstacle model.
    pub model: ObstacleModel,
    /// The blocked cells.
    pub blocks: BlockedCells,
    /// Time of the computation, without what is done once for the robot or the object's shape.
    pub time: Duration,
}

/// Computes the map of a robot.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_analysis::map::{MapRequest, map};
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
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
///
/// # Errors
/// An unknown or ambiguous robot, a joint without limits, too many cells for the memory.
pub fn map(cell: &Cell, request: &MapRequest) -> Result<CellMap, FormatError> {
    let (robot, spec) = select_map(cell, request.robot.as_deref())?;
    let wrong = |what: String, hint: &str| FormatError::new(&cell.file, spec.line, what).hint(hint);
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
    let links_map = |left_out: Vec<LinkId>| {
        let robot = without_colliders(robot, &left_out);
        let solids = SolidsMap::new(&robot, &axes, &spec.joints, others, request.exact).map_err(refuse)?;
        Ok::<_, FormatError>(LinksMap { left_out, solids })
    };
    let mut maps = vec![links_map(Vec::new())?];
    let mut obstacles = Vec::with_capacity(cell.objects.len());
    for (i, object) in cell.objects.iter().enumerate() {
        let (blocks, time) = match links_that_may_touch(cell, spec.robot, ObjectId(i)) {
            // All of them: the object blocks nothing.
            None => maps[0].solids.fill(&[]).map_err(refuse)?,
            Some(links) => {
                let known = maps.iter().position(|map| map.left_out == links);
                if known.is_none() {
                    maps.push(links_map(links)?);
                }
                let map = &maps[known.unwrap_or(maps.len() - 1)];
                map.solids.fill(&map.solids_of(object, request.model)).map_err(refuse)?
            }
        };
        obstacles.push(MapObstacle { name: object.name.clone(), model: request.model, blocks, time });
    }
    let moves = |o: ObjectId| cell.moving_objects.iter().any(|m| m.object == o);
    let count = |dense: Option<&OccupancyArray>, which: &dyn Fn(ObjectId) -> bool| {
        if let Some(dense) = dense {
            return Ok(dense.blocked());
        }
        let chosen: Vec<ObjectId> = (0..cell.objects.len()).map(ObjectId).filter(|o| which(*o)).collect();
        let of_map = |map: &LinksMap| {
            let links = |o: ObjectId| links_that_may_touch(cell, spec.robot, o);
            let is_of_map = |o: &&ObjectId| links(**o).is_some_and(|links| links == map.left_out);
            let objects = chosen.iter().filter(is_of_map).map(|o| &cell.objects[o.0]);
            let all: Vec<_> = objects.flat_map(|o| map.solids_of(o, request.model)).collect();
            map.solids.fill(&all).map(|(cells, _)| cells.blocked()).map_err(refuse)
        };
        // Where links may touch only some objects, cells that several maps block count several times.
        let counts = maps.iter().map(of_map).collect::<Result<Vec<u64>, FormatError>>()?;
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
    for m in &cell.moving_objects {
        let what = format!("object \"{}\" moves: the map has it at its initial pose", cell.objects[m.object.0].name);
        warnings.push(Warning::new(&cell.file, spec.line, what));
    }
    if cell.robots.len() > 1 {
        let what = format!("the map of \"{}\" leaves the other robots out: they move", robot.name);
        warnings.push(Warning::new(&cell.file, spec.line, what));
    }
    Ok(CellMap { robot: robot.name.clone(), axes, is_angle, obstacles, blocked, static_blocked, dense, warnings })
}

/// What fills the map of a robot without the colliders of some links, for the objects that these may touch.
struct LinksMap {
    left_out: Vec<LinkId>,
    solids: SolidsMap,
}

impl LinksMap {
    fn solids_of(&self, object: &Object, model: ObstacleModel) -> Vec<(Shape, Pose)> {
        model.solids(&object.shape, &object.in_world, &self.solids.base_in_world())
    }
}

/// The links that may touch an object by the cell's file of pairs; `None` where all of them may.
fn links_that_may_touch(cell: &Cell, robot: RobotId, object: ObjectId) -> Option<Vec<LinkId>> {
    let may_touch = |link: &LinkId| {
        let link = GeometryId::Link { robot, link: *link };
        cell.pair_rules.skipped(link, GeometryId::Object(object)).is_some()
    };
    let all: Vec<LinkId> = cell.robots[robot.0].robot.links_with_colliders().collect();
    let some: Vec<LinkId> = all.iter().copied().filter(may_touch).collect();
    (some.is_empty() || some.len() < all.len()).then_some(some)
}

fn without_colliders(robot: &CellRobot, links: &[LinkId]) -> CellRobot {
    let mut robot = robot.clone();
    for link in links {
        robot.robot.colliders[link.0].clear();
    }
    robot
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

/// The requested robot, the only one with a map, or the only one.
pub(crate) fn select_map<'c>(cell: &'c Cell, name: Option<&str>) -> Result<(&'c CellRobot, MapSpec), FormatError> {
    let robot = match (name, &cell.maps[..]) {
        (None, [only]) => only.robot,
        _ => select_robot(cell, name)?.0,
    };
    let spec = cell.maps.iter().find(|m| m.robot == robot).cloned();
    let spec = spec.unwrap_or_else(|| MapSpec::of(robot, &cell.robots[robot.0]));
    Ok((&cell.robots[robot.0], spec))
}

/// The joint axes. Continuous joints have a range of one turn.
pub(crate) fn axes(
    cell: &Cell,
    robot: &CellRobot,
    spec: &MapSpec,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<GridAxis>, Vec<bool>), FormatError> {
    let chain = &robot.robot.chain;
    let mut axes = Vec::new();
    let mut is_angle = Vec::new();
    for (&index, &step) in spec.joints.iter().zip(&spec.step) {
        let joint = &chain.joints()[chain.active_joints()[index].0];
        let limits = match joint.kind {
            JointKind::Continuous => {
                let what = format!("joint \"{}\" is continuous: the map covers -180 to 180 degrees", joint.name);
                warnings.push(Warning::new(&cell.file, spec.line, what));
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
            FormatError::new(&cell.file, spec.line, format!("robot \"{}\": {e}", robot.name)).hint(hint)
        })?;
        axes.push(axis);
        is_angle.push(joint.kind.turns());
    }
    Ok((axes, is_angle))
}
