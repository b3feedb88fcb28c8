//! How the TCP moves on a path: freely, on a straight line, or with an axis that keeps its direction.

use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{Cell, CellRobot, KeptAxis};
use elbowroom_formats::Diagnostic;
use elbowroom_planner::{LinearMove, OrientationConstraint, PathConstraint};
use elbowroom_robot::RobotId;
use elbowroom_scene::Scene;

use super::kept_axis::KeptDirection;
use super::path_goal::PathGoal;

/// Largest distance of the TCP from a straight line between waypoints, m, and rotation from the orientation there, rad.
pub(crate) const LINE_TOLERANCE: (f64, f64) = (5e-4, 1e-3);

/// The motion of the TCP on a path.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum TcpMotion {
    /// Any.
    #[default]
    Free,
    /// Straight to the goal, which is a pose; the orientation turns uniformly. In one posture, within 0.5 mm and 0.06°.
    Linear,
    /// An axis of the TCP keeps its direction in the world.
    KeptAxis(KeptAxis),
}

/// The straight line to a goal, if the TCP moves on one; `is_searched` if the request is one for a search on a map, or
/// for shorter and shorter paths.
///
/// # Errors
/// A goal that is not a pose; a search that finds no straight lines.
pub(super) fn line(
    cell: &Cell,
    robot: &CellRobot,
    motion: TcpMotion,
    to: &PathGoal,
    is_searched: bool,
) -> Result<Option<LinearMove>, Diagnostic> {
    if motion != TcpMotion::Linear {
        return Ok(None);
    }
    let PathGoal::Tcp(target) = to else {
        let what = "a linear move leads to a pose of the TCP";
        return Err(refused(cell, robot, what).hint("a pose as the goal, or a free motion"));
    };
    if is_searched {
        let what = "a linear move has one path, and no map is searched for it";
        return Err(refused(cell, robot, what).hint("the planner rrt-connect, without optimizing"));
    }
    Ok(Some(LinearMove {
        link: robot.flange,
        tip_in_link: robot.tcp_in_flange,
        target_in_world: target.in_world,
        tolerance_m: LINE_TOLERANCE.0,
        tolerance_rad: LINE_TOLERANCE.1,
    }))
}

/// The constraint of a kept axis, if the TCP keeps one.
///
/// # Errors
/// An axis without direction or a tolerance that is not above 0.
pub(super) fn kept_axis(
    cell: &Cell,
    scene: &Scene,
    (id, from): (RobotId, &[f64]),
    motion: TcpMotion,
) -> Result<Option<OrientationConstraint>, Diagnostic> {
    let TcpMotion::KeptAxis(kept) = motion else {
        return Ok(None);
    };
    let robot = &cell.robots[id.0];
    if kept.axis_in_tcp.try_normalize().is_none() {
        return Err(refused(cell, robot, "the axis to keep has no direction").hint("an axis other than 0, as 0,0,1"));
    }
    if !(kept.tolerance_rad > 0.0 && kept.tolerance_rad < std::f64::consts::PI) {
        let what = "the angle by which a kept axis may turn is not between 0 and half a turn";
        return Err(refused(cell, robot, what).hint("an angle above 0 and below half a turn"));
    }
    Ok(Some(KeptDirection::of(robot, kept, from).constraint(scene, id)))
}

/// All constraints of a path: a kept axis, and the regions closed to the robot.
///
/// # Errors
/// A start in a region, from which a path with a kept axis is not planned.
pub(super) fn constraints<'m>(
    cell: &Cell,
    (id, from): (RobotId, &[f64]),
    kept: Option<OrientationConstraint>,
    regions: Option<RegionConstraint<'m>>,
) -> Result<Vec<Box<dyn PathConstraint + 'm>>, Diagnostic> {
    let mut all: Vec<Box<dyn PathConstraint + 'm>> = Vec::new();
    let keeps = kept.is_some();
    all.extend(kept.map(|kept| Box::new(kept) as Box<dyn PathConstraint>));
    if let Some(mut regions) = regions {
        // Out of a region a path leads in any way that comes no deeper.
        if keeps && !(regions.distance_m(from, 0.0) > 0.0) {
            let what = format!("its start is in {}", regions.describe_nearest(from));
            return Err(refused(cell, &cell.robots[id.0], &what).hint("a free motion out of it first"));
        }
        all.push(Box::new(regions));
    }
    Ok(all)
}

fn refused(cell: &Cell, robot: &CellRobot, what: &str) -> Diagnostic {
    Diagnostic::new(&cell.file, robot.line, format!("robot \"{}\": {what}", robot.name))
}
