//! The robot of a map, and the axes.

use elbowroom_cell::{Cell, CellRobot, MapSpec};
use elbowroom_cspace::{GridAxis, GridAxisError};
use elbowroom_formats::Diagnostic;
use elbowroom_kinematics::JointKind;
use elbowroom_robot::RobotId;

use crate::plan::request_validation::select_robot;

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
pub(super) fn axes(
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
