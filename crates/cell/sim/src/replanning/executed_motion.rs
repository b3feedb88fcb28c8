//! The motion that a robot executes, at one instant.

use elbowroom_cell::PathPlanner;
use elbowroom_query::plan::KeptDirection;

use super::path_ahead::PathAhead;

/// The motion that a robot executes, at one instant: all that a search for another path needs to know of it.
#[derive(Debug, Clone)]
pub struct ExecutedMotion {
    /// The number of the path: another one for each step of a program, and for each path that replaces another.
    pub path: u64,
    /// The rest of the path; `None` if the present step has no motion.
    pub ahead: Option<PathAhead>,
    /// What the present step plans; `None` if its path must be followed.
    pub planned: Option<PlannedGoal>,
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// Joint velocities, rad/s or m/s.
    pub qd: Vec<f64>,
    /// Rate of the program's time, 0..1.
    pub rate: f64,
    /// The largest rate that the program allows, 0..1.
    pub programmed_override: f64,
}

/// The end of a planned move.
#[derive(Debug, Clone)]
pub struct PlannedGoal {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// The fraction of the joints' top speeds that the move uses.
    pub speed: f64,
    /// How its path is planned.
    pub planner: PathPlanner,
    /// The direction that an axis of the TCP keeps on it.
    pub keep: Option<KeptDirection>,
}
