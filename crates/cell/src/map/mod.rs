//! The joint-space map of a robot of a cell: what `elbowroom map` answers.
//!
//! Every object is an obstacle, those that move where they are at the start. The robot's own links among themselves, other robots, and links that none of the map's
//! joints moves are left out.

mod pictures;

use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use elbowroom_cspace::{Axis, AxisError, Blocks, Dense, Model, Others, RobotFiller, RobotMapError};
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::JointKind;

use crate::plan::subject;
use crate::{Cell, CellRobot, MapSpec};

/// What is asked for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MapRequest {
    /// Name of the robot; may be left out where there is one, or one map.
    pub robot: Option<String>,
    /// In what form objects are obstacles.
    pub model: Model,
}

/// A robot's map and what each object blocks of it.
#[derive(Debug, Clone)]
pub struct CellMap {
    /// Name of the robot.
    pub robot: String,
    /// The joints, cut into cells.
    pub axes: Vec<Axis>,
    /// Per axis: true where it is an angle.
    pub turns: Vec<bool>,
    /// Per object of the cell, in its order.
    pub obstacles: Vec<MapObstacle>,
    /// Number of cells that any object blocks.
    pub blocked: u64,
    /// Number of cells that an object blocks that nothing moves.
    pub static_blocked: u64,
    /// All of it, cell by cell; `None` where there are too many cells.
    pub dense: Option<Dense>,
    /// What a user should know, none of it fatal.
    pub warnings: Vec<Warning>,
}

/// What one object blocks.
#[derive(Debug, Clone)]
pub struct MapObstacle {
    /// Its name.
    pub name: String,
    /// In what form it was an obstacle.
    pub model: Model,
    /// What it blocks.
    pub blocks: Blocks,
    /// How long that took.
    pub time: Duration,
}

/// Makes the map of a robot.
///
/// ```
/// use elbowroom_cell::{Cell, map::{MapRequest, map}};
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
/// An unknown robot, several to choose from, a joint without limits, too many cells for the memory.
pub fn map(cell: &Cell, request: &MapRequest) -> Result<CellMap, FormatError> {
    let (robot, spec) = chosen(cell, request.robot.as_deref())?;
    let wrong = |what: String, hint: &str| FormatError::new(&cell.file, spec.line, what).hint(hint);
    let mut warnings = Vec::new();
    let (axes, turns) = axes(cell, robot, &spec, &mut warnings)?;
    let others = if spec.others_at_start { Others::Held(&robot.start) } else { Others::Any };
    let refuse = |e: RobotMapError| {
        let hint = match e {
            RobotMapError::Memory { .. } => "step = 5   (a larger step, or fewer joints)",
            RobotMapError::Count(_) | RobotMapError::Joint { .. } => "joints = [\"joint_1\", \"joint_2\", \"joint_3\"]",
            _ => "a number for every place and size",
        };
        wrong(format!("robot \"{}\": {e}", robot.name), hint)
    };
    let filler = RobotFiller::new(&robot.robot, robot.base_in_world, &axes, &spec.joints, others).map_err(refuse)?;
    let base = filler.base_in_world();
    let solids = |o: &elbowroom_scene::Object| request.model.solids(&o.shape, &o.in_world, &base);
    let mut obstacles = Vec::with_capacity(cell.objects.len());
    for object in &cell.objects {
        let begin = Instant::now();
        let blocks = filler.fill(&solids(object)).map_err(refuse)?;
        let (name, model) = (object.name.clone(), request.model);
        obstacles.push(MapObstacle { name, model, blocks, time: begin.elapsed() });
    }
    let moves = |o: usize| cell.movers.iter().any(|m| m.object == o);
    let count = |dense: Option<&Dense>, which: &dyn Fn(usize) -> bool| {
        if let Some(dense) = dense {
            return Ok(dense.blocked());
        }
        let all: Vec<_> = cell.objects.iter().enumerate().filter(|o| which(o.0)).flat_map(|o| solids(o.1)).collect();
        filler.fill(&all).map(|b| b.blocked()).map_err(refuse)
    };
    let dense = Dense::of(&axes, obstacles.iter().map(|o| &o.blocks));
    let blocked = count(dense.as_ref(), &|_| true)?;
    let static_blocked = if cell.movers.is_empty() {
        blocked
    } else {
        let standing = obstacles.iter().enumerate().filter(|o| !moves(o.0)).map(|o| &o.1.blocks);
        count(Dense::of(&axes, standing).as_ref(), &|o| !moves(o))?
    };
    for m in &cell.movers {
        let what = format!("object \"{}\" moves: the map has it where it is at the start", cell.objects[m.object].name);
        warnings.push(Warning::new(&cell.file, spec.line, what));
    }
    if cell.robots.len() > 1 {
        let what = format!("the map of \"{}\" leaves the other robots out: they move", robot.name);
        warnings.push(Warning::new(&cell.file, spec.line, what));
    }
    Ok(CellMap { robot: robot.name.clone(), axes, turns, obstacles, blocked, static_blocked, dense, warnings })
}

impl CellMap {
    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.axes.iter().map(|a| a.count() as u64).fold(1, u64::saturating_mul)
    }

    /// Memory of the trees of boxes, bytes.
    pub fn bytes(&self) -> usize {
        self.obstacles.iter().map(|o| o.blocks.bytes()).sum()
    }

    /// Writes pictures of slices and a page that shows them, `index.html`, to a folder; how many pictures.
    ///
    /// # Errors
    /// What the file system says.
    pub fn write_pictures(&self, folder: &Path) -> io::Result<usize> {
        pictures::write(self, folder)
    }
}

/// Whose map: the robot asked for, the only one with a map, or the only one.
fn chosen<'c>(cell: &'c Cell, name: Option<&str>) -> Result<(&'c CellRobot, MapSpec), FormatError> {
    let robot = match (name, &cell.maps[..]) {
        (None, [only]) => only.robot,
        _ => subject::robot(cell, name)?.0,
    };
    let spec = cell.maps.iter().find(|m| m.robot == robot).cloned();
    let spec = spec.unwrap_or_else(|| MapSpec::of(robot, &cell.robots[robot]));
    Ok((&cell.robots[robot], spec))
}

/// The joints cut into cells. Those without limits go once around.
fn axes(
    cell: &Cell,
    robot: &CellRobot,
    spec: &MapSpec,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<Axis>, Vec<bool>), FormatError> {
    let chain = &robot.robot.chain;
    let mut axes = Vec::new();
    let mut turns = Vec::new();
    for (&index, &step) in spec.joints.iter().zip(&spec.step) {
        let joint = &chain.joints()[chain.active_joints()[index].0];
        let limits = match joint.kind {
            JointKind::Continuous => {
                let what =
                    format!("joint \"{}\" turns without limits: the map has -180 to 180 degrees of it", joint.name);
                warnings.push(Warning::new(&cell.file, spec.line, what));
                [-std::f64::consts::PI, std::f64::consts::PI]
            }
            _ => [joint.limits.lower, joint.limits.upper],
        };
        let axis = Axis::new(&joint.name, limits[0], limits[1], step).map_err(|e| {
            let hint = match e {
                AxisError::TooMany { .. } | AxisError::Step { .. } => "step = 2   (larger, in the cell's units)",
                _ => "lower and upper limits for the joint in the robot's model, or joints = [...] without it",
            };
            FormatError::new(&cell.file, spec.line, format!("robot \"{}\": {e}", robot.name)).hint(hint)
        })?;
        axes.push(axis);
        turns.push(joint.kind.turns());
    }
    Ok((axes, turns))
}
