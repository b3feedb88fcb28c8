//! The goal of a path, and the configurations at which it is reached.

use elbowroom_cell::{Cell, TcpTarget};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::surface_ik::PointError;
use elbowroom_planner::{GoalLimits, PointGoal, TaskSpaceRegion};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState};
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Pose, Vec3};

use super::request_validation;

/// Samples from which the configurations for a point are searched, beside the start.
const POINT_SAMPLES: u64 = 32;

/// Goal of a path.
#[derive(Debug, Clone, PartialEq)]
pub enum PathGoal {
    /// Values of all joints in the order of the chain, rad or m.
    Joints(Vec<f64>),
    /// A pose of the TCP: the first solution of inverse kinematics that the target accepts and that is reached.
    Tcp(TcpTarget),
    /// A point of a link at a place; the orientation of the link is free.
    Point(PointGoal),
}

impl Default for PathGoal {
    fn default() -> Self {
        Self::Joints(Vec::new())
    }
}

impl<Q: Into<Vec<f64>>> From<Q> for PathGoal {
    fn from(q: Q) -> Self {
        Self::Joints(q.into())
    }
}

/// The configurations at which a path may end.
pub(super) fn goals(
    cell: &Cell,
    scene: &Scene,
    state: &SceneState,
    id: RobotId,
    to: &PathGoal,
    seed: u64,
    limits: GoalLimits<'_>,
) -> Result<Vec<Vec<f64>>, Diagnostic> {
    let robot = &cell.robots[id.0];
    let target = match to {
        PathGoal::Joints(q) => {
            request_validation::check_joint_values(cell, robot, "goal", q)?;
            return Ok(vec![q.clone()]);
        }
        PathGoal::Tcp(target) => target,
        PathGoal::Point(point) => return point_goals(cell, scene, state, id, point, limits),
    };
    let region = TaskSpaceRegion::at_pose(robot.flange, robot.tcp_in_flange, target.in_world);
    let found = region.configurations(scene, state, id, 0, seed);
    target.choose(robot, cell.units, state.q(id), found).map_err(|why| {
        let what = format!("the goal of robot \"{}\": {why}", robot.name);
        let is_reached = |translation: Vec3| {
            let pose = Pose { translation, ..target.in_world };
            let region = TaskSpaceRegion::at_pose(robot.flange, robot.tcp_in_flange, pose);
            !region.configurations(scene, state, id, 0, seed).is_empty()
        };
        let hint = match in_other_unit(cell, target.in_world.translation, is_reached) {
            Some((numbers, why)) => format!("{numbers},…   ({why})"),
            None => "a pose within reach, or joint values".to_owned(),
        };
        Diagnostic::new(&cell.file, robot.line, what).hint(hint)
    })
}

/// The configurations with a point at its place.
fn point_goals(
    cell: &Cell,
    scene: &Scene,
    state: &SceneState,
    id: RobotId,
    point: &PointGoal,
    limits: GoalLimits<'_>,
) -> Result<Vec<Vec<f64>>, Diagnostic> {
    let robot = &cell.robots[id.0];
    let moving = limits.moving;
    point.configurations(scene, state, id, POINT_SAMPLES, limits).map_err(|e| {
        let link = &robot.robot.chain.links()[point.link.0];
        let why = match e {
            PointError::NotReached { position_error_m, .. } if point.moved_by(scene, id).is_empty() => {
                format!("no joint moves `{link}`, and its point is {} away", cell.units.show_length(position_error_m))
            }
            PointError::NotReached { position_error_m, starts, .. } => {
                let away = cell.units.show_length(position_error_m);
                format!("the point of `{link}` does not get there; the closest of {starts} searches is {away} away")
            }
            other => other.to_string(),
        };
        let is_reached = |in_world: Vec3| {
            let limits = GoalLimits { moving, kept: None };
            PointGoal { in_world, ..*point }.configurations(scene, state, id, 0, limits).is_ok()
        };
        let hint = match in_other_unit(cell, point.in_world, is_reached) {
            Some((numbers, why)) => format!("{numbers}   ({why})"),
            None if moving.is_some() => {
                "a place that the joints of the map reach, or the planner rrt-connect".to_owned()
            }
            None => "a place that the joints before the link reach".to_owned(),
        };
        Diagnostic::new(&cell.file, robot.line, format!("the goal of robot \"{}\": {why}", robot.name)).hint(hint)
    })
}

/// The place in the cell's unit of length, if its numbers are within reach in another unit, which was probably meant;
/// and that this is why.
fn in_other_unit(cell: &Cell, in_world: Vec3, is_reached: impl Fn(Vec3) -> bool) -> Option<(String, String)> {
    let factor = |unit: LengthUnit| unit.to_metres(1.0) / cell.units.length.to_metres(1.0);
    let meant = [LengthUnit::Metre, LengthUnit::Millimetre]
        .into_iter()
        .filter(|unit| *unit != cell.units.length)
        .find(|unit| is_reached(in_world * factor(*unit)))?;
    let numbers = (in_world * factor(meant)).to_array().map(|metres| cell.units.in_file_units(metres));
    let (meant, unit) = (meant.symbol(), cell.units.length.symbol());
    Some((numbers.join(","), format!("in {unit}, the cell's unit; {meant} seem to be meant")))
}
