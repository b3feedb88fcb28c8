//! Errors of path planning in the exact scene.

use elbowroom_scene::SceneError;

use super::settings::RrtConnectSetting;
use crate::grid_path::PathEnd;
use crate::time_parametrization::TimeParametrizationError;

/// Joint values above a full turn (2π, rounded up) are probably degrees if the limits are within a full turn, rad.
const FULL_TURN_RAD: f64 = 6.3;

/// Unit of a joint value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointUnit {
    /// Radians, for a rotation.
    Radians,
    /// Metres, for a translation.
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

/// Why a linear move ends before its target.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinearMoveEnd {
    /// No joint values within the limits continue the line without a jump.
    #[error("the joints cannot follow: the line leaves the reach or a joint's limits, or passes a singularity")]
    Unreachable,
    /// The next part of the line is not proven free.
    #[error("it is not free")]
    NotFree,
}

/// Why a path cannot be planned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RrtConnectError {
    /// An end is beyond the joint limits.
    #[error(
        "{end}: joint `{joint}` is {value} {unit}, outside its limits: write a value from {lower} to {upper} {unit}{}",
        if *unit == JointUnit::Radians && value.abs() > FULL_TURN_RAD && *upper < FULL_TURN_RAD { " (are these degrees?)" } else { "" }
    )]
    OutOfLimits {
        /// Start or goal.
        end: PathEnd,
        /// Name of the joint.
        joint: String,
        /// Value of the joint, rad or m.
        value: f64,
        /// Lower limit.
        lower: f64,
        /// Upper limit.
        upper: f64,
        /// Unit of the value and the limits.
        unit: JointUnit,
    },
    /// An end is in collision or nearer than the clearance.
    #[error(
        "{end}: `{a}` and `{b}` {}: no path can have it as an end; write joint values that are free",
        if *clearance_m > 0.0 { format!("are {metres} m apart, less than the clearance of {clearance_m} m") } else { "are in collision".into() }
    )]
    InCollision {
        /// Start or goal.
        end: PathEnd,
        /// Name of the first of the pair.
        a: String,
        /// Name of the second of the pair.
        b: String,
        /// Distance of the pair minus its security margin, m.
        metres: f64,
        /// The required clearance, m.
        clearance_m: f64,
    },
    /// An end violates the [`PathConstraint`](crate::PathConstraint): a goal, or a start that no straight segment
    /// leaves.
    #[error(
        "{end}: it is in {what}{}: write joint values outside of it",
        if *end == PathEnd::Start { ", and no straight exit was found" } else { "" }
    )]
    ConstraintViolated {
        /// Start or goal.
        end: PathEnd,
        /// The violation in words.
        what: String,
        /// Distance from the violation in metres: 0 or less, or NaN if it is not known.
        metres: f64,
    },
    /// The search found no path within its limits. A path may still exist.
    #[error(
        "no path found in {seconds:.1} s ({states_checked} states checked, {nodes} of them connected to start or goal): this \
         proves nothing, there may be one; allow more time, or plan over a state in between{}",
        nearer_goal_hint(nearer)
    )]
    NotFound {
        /// Duration of the search, s.
        seconds: f64,
        /// Number of checked configurations.
        states_checked: u64,
        /// Number of nodes in the two trees.
        nodes: usize,
        /// Joints for which the goal's posture has another value, full turns away and nearer to the start, rad.
        nearer: Vec<(String, f64)>,
    },
    /// Proven: no path exists within the joint limits. Some joints cannot get from start to goal without a collision,
    /// regardless of the other joints.
    #[error(
        "no path exists: {} cannot get from start to goal without a collision, whatever the other joints do: choose another \
         posture as the goal{}",
        names(joints),
        nearer_goal_hint(nearer)
    )]
    Disconnected {
        /// Names of the joints.
        joints: Vec<String>,
        /// Joints for which the goal's posture has another value, full turns away and nearer to the start, rad.
        nearer: Vec<(String, f64)>,
    },
    /// No goal was given, or no configuration was found in a region of goals.
    #[error("there is no goal: write at least one configuration, or a pose that the robot reaches")]
    NoGoal,
    /// A linear move cannot be followed to its end.
    #[error(
        "the straight line can be followed for {percent:.1} % only, there {end}: plan a free motion, or move start or target"
    )]
    LinearMove {
        /// Followed part of the line, percent.
        percent: f64,
        /// Why the move ends there.
        end: LinearMoveEnd,
    },
    /// A straight line is planned on sphere covers, and a link has none.
    #[error("a link without bounds cannot be enclosed in spheres, which a linear move needs: plan a free motion")]
    LinearMoveWithoutCovers,
    /// A setting is invalid.
    #[error("{setting} is {value}: write {}", .setting.range())]
    InvalidSetting {
        /// The setting.
        setting: RrtConnectSetting,
        /// Value of the setting.
        value: f64,
    },
    /// The limits or the period do not allow a trajectory.
    #[error(transparent)]
    TimeParametrization(#[from] TimeParametrizationError),
    /// The scene rejects the values, or does not have the robot.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

impl RrtConnectError {
    /// Counts the effort of a search before this one, if both found no path.
    pub(crate) fn after(mut self, before: &Self) -> Self {
        if let (
            Self::NotFound { seconds, states_checked, nodes, .. },
            Self::NotFound { seconds: earlier_s, states_checked: earlier_states, nodes: earlier_nodes, .. },
        ) = (&mut self, before)
        {
            *seconds += earlier_s;
            *states_checked += earlier_states;
            *nodes += earlier_nodes;
        }
        self
    }
}

fn names(joints: &[String]) -> String {
    let each: Vec<_> = joints.iter().map(|joint| format!("`{joint}`")).collect();
    each.join(" and ")
}

fn nearer_goal_hint(nearer: &[(String, f64)]) -> String {
    let each: Vec<_> = nearer.iter().map(|(joint, value)| format!("`{joint}` {value} rad")).collect();
    if each.is_empty() { String::new() } else { format!("; the same posture nearer to the start: {}", each.join(", ")) }
}
