//! Why there is no path.

use elbowroom_scene::SceneError;

use super::settings::RrtConnectSetting;
use crate::path::PathEnd;
use crate::time_parametrization::TimeParametrizationError;

/// Joint values beyond a full turn (2π, rounded up) where the limits are within one are probably degrees, rad.
const FULL_TURN_RAD: f64 = 6.3;

/// Unit of a joint's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointUnit {
    /// Radians, of a rotation.
    Radians,
    /// Metres, of a translation.
    Metres,
}

impl std::fmt::Display for JointUnit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Radians => "rad",
            Self::Metres => "m",
        })
    }
}

/// What ends a linear move before its target.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinearMoveEnd {
    /// No joint values within the limits continue the line without a leap.
    #[error("the joints cannot follow: the line leaves the reach or a joint's limits, or passes a singularity")]
    Unreachable,
    /// The line is not proven free there.
    #[error("it is not free")]
    NotFree,
}

/// Why there is no path.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RrtConnectError {
    /// An end beyond the joint limits.
    #[error(
        "{end}: joint `{joint}` is {value} {unit}, outside its limits: write a value from {lower} to {upper} {unit}{}",
        if *unit == JointUnit::Radians && value.abs() > FULL_TURN_RAD && *upper < FULL_TURN_RAD { " (are these degrees?)" } else { "" }
    )]
    OutOfLimits {
        /// Start or goal.
        end: PathEnd,
        /// Name of the joint.
        joint: String,
        /// Its value, rad or m.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
        /// Unit of these numbers.
        unit: JointUnit,
    },
    /// An end in collision, or nearer than the clearance.
    #[error(
        "{end}: `{a}` and `{b}` {}: no path can have it as an end; write joint values that are free",
        if *clearance_m > 0.0 { format!("are {metres} m apart, less than the clearance of {clearance_m} m") } else { "are in collision".into() }
    )]
    InCollision {
        /// Start or goal.
        end: PathEnd,
        /// Name of one of the pair.
        a: String,
        /// Name of the other.
        b: String,
        /// Their distance less the pair's security margin, m.
        metres: f64,
        /// The required clearance, m.
        clearance_m: f64,
    },
    /// An end that violates the [`PathConstraint`](crate::PathConstraint): a goal, or a start that no straight segment leaves.
    #[error(
        "{end}: it is in {what}{}: write joint values outside of it",
        if *end == PathEnd::Start { ", and no straight exit was found" } else { "" }
    )]
    ConstraintViolated {
        /// Start or goal.
        end: PathEnd,
        /// The violation in words.
        what: String,
        /// Distance from it in metres: 0 or less, or NaN if it is not known.
        metres: f64,
    },
    /// No path was found within the limits. That proves nothing.
    #[error(
        "no path found in {seconds:.1} s ({states_checked} states checked, {nodes} of them connected to start or goal): this \
         proves nothing, there may be one; allow more time, or plan over a state in between{}",
        nearer_goal_hint(nearer)
    )]
    NotFound {
        /// Duration of the search, s.
        seconds: f64,
        /// Configurations that were checked.
        states_checked: u64,
        /// Nodes of both trees.
        nodes: usize,
        /// Joints of which the goal's posture has another value, full turns away and nearer to the start, rad.
        nearer: Vec<(String, f64)>,
    },
    /// No path exists within the joint limits: some joints cannot get from start to goal without a collision, whatever the
    /// others do. This is proven.
    #[error(
        "no path exists: {} cannot get from start to goal without a collision, whatever the other joints do: choose another \
         posture as the goal{}",
        names(joints),
        nearer_goal_hint(nearer)
    )]
    Disconnected {
        /// Names of the joints.
        joints: Vec<String>,
        /// Joints of which the goal's posture has another value, full turns away and nearer to the start, rad.
        nearer: Vec<(String, f64)>,
    },
    /// No goal was given, or a region of goals contains no configuration that was found.
    #[error("there is no goal: write at least one configuration, or a pose that the robot reaches")]
    NoGoal,
    /// A linear move cannot be followed to its end.
    #[error(
        "the straight line can be followed for {percent:.1} % only, there {end}: plan a free motion, or move start or target"
    )]
    LinearMove {
        /// How much of it.
        percent: f64,
        /// Why.
        end: LinearMoveEnd,
    },
    /// An invalid setting.
    #[error("{setting} is {value}: write {}", .setting.range())]
    InvalidSetting {
        /// Which one.
        setting: RrtConnectSetting,
        /// Its value.
        value: f64,
    },
    /// Limits or a period for which there is no trajectory.
    #[error(transparent)]
    TimeParametrization(#[from] TimeParametrizationError),
    /// Values that the scene rejects, or a robot that it does not have.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

fn names(joints: &[String]) -> String {
    let each: Vec<_> = joints.iter().map(|joint| format!("`{joint}`")).collect();
    each.join(" and ")
}

fn nearer_goal_hint(nearer: &[(String, f64)]) -> String {
    let each: Vec<_> = nearer.iter().map(|(joint, value)| format!("`{joint}` {value} rad")).collect();
    if each.is_empty() { String::new() } else { format!("; the same posture nearer to the start: {}", each.join(", ")) }
}
