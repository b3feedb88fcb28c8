//! Validation of a request: selection of the robot, joint values, limits.

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_kinematics::{JointKind, JointLimits};
use elbowroom_planner::{PathEnd, RrtConnectError};
use elbowroom_robot::RobotId;

/// The robot of this name; without a name, the only robot that is no mechanism.
///
/// # Errors
/// An error if the robot does not exist, or if there are several robots and no name.
pub fn select_robot<'c>(cell: &'c Cell, name: Option<&str>) -> Result<(RobotId, &'c CellRobot), Diagnostic> {
    let names = || cell.robots.iter().map(|r| r.name.as_str());
    let wrong = |what: String, hint: String| Err(Diagnostic::new(&cell.file, None, what).hint(hint));
    let Some(name) = name else {
        return match cell.guarded_robots().collect::<Vec<_>>()[..] {
            [only] => Ok((only, &cell.robots[only.0])),
            ref robots => {
                let guarded = robots.iter().map(|id| cell.robots[id.0].name.as_str());
                wrong(format!("has {} robots: name one", robots.len()), suggest::hint("", guarded))
            }
        };
    };
    match cell.robots.iter().position(|r| r.name == name) {
        Some(i) => Ok((RobotId(i), &cell.robots[i])),
        None => wrong(format!("has no robot \"{name}\""), suggest::hint(name, names())),
    }
}

/// Motion limits of the robot's joints. Speeds must be given: a guess would be unsafe.
pub(super) fn joint_limits<'c>(cell: &Cell, robot: &'c CellRobot) -> Result<&'c [JointLimits], Diagnostic> {
    let chain = &robot.robot.chain;
    let joints = || chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
    let known = |v: Option<f64>| v.is_some_and(|v| v > 0.0 && v.is_finite());
    let unknown: Vec<&str> = joints().filter(|j| !known(j.limits.velocity)).map(|j| j.name.as_str()).collect();
    if !unknown.is_empty() {
        let what = format!(
            "robot \"{}\" has no largest speed for {}: time parametrization needs one for each joint",
            robot.name,
            unknown.join(", ")
        );
        let each = joints().map(|j| {
            let is_prismatic = j.kind == JointKind::Prismatic;
            let guess = if is_prismatic { 1.0 } else { std::f64::consts::PI };
            let speed =
                cell.units.show_joint(is_prismatic, j.limits.velocity.filter(|v| known(Some(*v))).unwrap_or(guess));
            speed.split(' ').next().unwrap_or_default().to_owned()
        });
        let hint = format!(
            "speed = [{}]   (in [robot.{}]: per joint, in {} or, where it slides, {} per second)",
            each.collect::<Vec<_>>().join(", "),
            robot.name,
            cell.units.angle.symbol(),
            cell.units.length.symbol(),
        );
        return Err(Diagnostic::new(&cell.file, robot.line, what).hint(hint));
    }
    Ok(&robot.limits)
}

/// Checks that there is one finite value per joint.
pub(super) fn check_joint_values(cell: &Cell, robot: &CellRobot, end: &str, q: &[f64]) -> Result<(), Diagnostic> {
    let names = robot.joint_names();
    let order = || format!("one value per joint in this order, rad (m for prismatic joints): {}", names.join(","));
    let wrong = |what: String| Diagnostic::new(&cell.file, robot.line, what).hint(order());
    if q.len() != names.len() {
        let joints = names.len();
        return Err(wrong(format!(
            "the {end} of robot \"{}\" has {} value{} for {joints} joint{}",
            robot.name,
            q.len(),
            if q.len() == 1 { "" } else { "s" },
            if joints == 1 { "" } else { "s" },
        )));
    }
    match q.iter().position(|v| !v.is_finite()) {
        Some(i) => Err(wrong(format!("the {end} of robot \"{}\" has {} for `{}`", robot.name, q[i], names[i]))),
        None => Ok(()),
    }
}

/// The error if the planner rejects the request.
pub(super) fn planner_error(cell: &Cell, robot: &CellRobot, e: &RrtConnectError) -> Diagnostic {
    let error = |what: String| Diagnostic::new(&cell.file, robot.line, what);
    let of = |end: &PathEnd| format!("the {end} of robot \"{}\"", robot.name);
    match e {
        RrtConnectError::OutOfLimits { end, joint, value, lower, upper, unit } => {
            let degrees = if *unit == elbowroom_planner::JointUnit::Radians && value.abs() > 6.3 && *upper < 6.3 {
                "; are these degrees?"
            } else {
                ""
            };
            error(format!("{}: `{joint}` is {value} {unit}, outside its limits{degrees}", of(end)))
                .hint(format!("a value from {lower} to {upper} {unit} for `{joint}`"))
        }
        RrtConnectError::InCollision { end, a, b, metres, clearance_m } => {
            let near = if *clearance_m > 0.0 && *metres > 0.0 {
                format!("are {metres} m apart, nearer than the clearance of {clearance_m} m")
            } else {
                "are in collision".into()
            };
            let apart = format!(
                "joint values at which they are apart (`elbowroom query` computes the distance): another {end}"
            );
            let own = |name: &str| name.strip_prefix(&robot.name)?.strip_prefix('/').map(str::to_owned);
            let hint = match (own(a), own(b)) {
                (Some(a), Some(b)) => {
                    format!(
                        "{apart}; or, if they always touch: ignore = [[\"{a}\", \"{b}\"]] in [robot.{}]",
                        robot.name
                    )
                }
                _ => format!(
                    "{apart}; or, if they may touch: {{ a = \"{a}\", b = \"{b}\", reason = \"…\" }} in the cell's file of `pairs`"
                ),
            };
            error(format!("{}: `{a}` and `{b}` {near}", of(end))).hint(hint)
        }
        RrtConnectError::ConstraintViolated { end, what, .. } => {
            let no_exit = if *end == PathEnd::Start { ", and no straight path out of it was found" } else { "" };
            let hint = if what.starts_with("region") {
                format!("joint values with all guarded volumes outside of it: another {end}")
            } else {
                format!("another {end}, or a wider angle for the axis that is kept")
            };
            error(format!("{}: in {what}{no_exit}", of(end))).hint(hint)
        }
        other => error(other.to_string()),
    }
}
