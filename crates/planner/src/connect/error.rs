//! Why there is no route.

use elbowroom_scene::SceneError;

use crate::path::End;
use crate::timing::MotionError;

/// Why there is no route.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RouteError {
    /// A start or goal that no route can have: a limit is broken.
    #[error(
        "{end}: joint `{joint}` is {value} {unit}, outside its limits: write a value from {lower} to {upper} {unit}{}",
        if *unit == "rad" && value.abs() > 6.3 && *upper < 6.3 { " (are these degrees?)" } else { "" }
    )]
    Beyond {
        /// Which of the two.
        end: End,
        /// The joint.
        joint: String,
        /// Its value, rad or m.
        value: f64,
        /// Smallest allowed.
        lower: f64,
        /// Largest allowed.
        upper: f64,
        /// `rad` or `m`.
        unit: &'static str,
    },
    /// A start or goal in contact, or too near.
    #[error(
        "{end}: `{a}` and `{b}` {}: no path can have it as an end; write joint values that are free",
        if *clearance_m > 0.0 { format!("are {metres} m apart, less than the clearance of {clearance_m} m") } else { "are in collision".into() }
    )]
    Contact {
        /// Which of the two.
        end: End,
        /// Name of one member.
        a: String,
        /// Name of the other.
        b: String,
        /// Their distance less the pair's margin, m.
        metres: f64,
        /// What was asked for, m.
        clearance_m: f64,
    },
    /// A start or goal in what a [`Fence`](crate::Fence) keeps the robot out of: a goal, or a start from which no way leads out.
    #[error(
        "{end}: it is in {what}{}: write joint values outside of it",
        if *end == End::Start { ", and no straight way out was found" } else { "" }
    )]
    Fenced {
        /// Which of the two.
        end: End,
        /// What it is in.
        what: String,
        /// Metres to it: 0 or less, or NaN where that is not known.
        metres: f64,
    },
    /// None was found with what was allowed. That proves nothing.
    #[error(
        "no path found in {seconds:.1} s ({states} states looked at, {nodes} of them joined to start or goal): this proves nothing, \
         there may be one; allow more time, or plan over a state in between{}",
        also(nearer)
    )]
    NotFound {
        /// The time it took, s.
        seconds: f64,
        /// States that were looked at.
        states: u64,
        /// Those that are joined to an end.
        nodes: usize,
        /// Joints of which the same posture has another value, a turn away from the goal's and nearer to the start's, rad.
        nearer: Vec<(String, f64)>,
    },
    /// An option that cannot be.
    #[error("{what} is {value}: write a finite number of {unit}, 0 or more")]
    Option {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// Limits or a period that no motion can have.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Values that the scene refuses, or a robot that it does not have.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

fn also(nearer: &[(String, f64)]) -> String {
    let each: Vec<_> = nearer.iter().map(|(joint, value)| format!("`{joint}` {value} rad")).collect();
    if each.is_empty() { String::new() } else { format!("; the same posture, by a nearer way: {}", each.join(", ")) }
}
