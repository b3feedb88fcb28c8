//! What a guide answers: after a look, and at every tick.

use elbowroom_planner::How;

use super::{Doing, LookTimes, Reason};

/// What a look at a new map told.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outlook {
    /// How the present path came about; `None` where there is none, or none was needed.
    pub how: Option<How>,
    /// The rest of the path was blocked somewhere when it was looked at.
    pub was_blocked: bool,
    /// The path went over to another one while the arm moved.
    pub in_motion: bool,
    /// Why there is no path, where there is none.
    pub reason: Option<Reason>,
    /// Time per stage.
    pub times: LookTimes,
}

/// One control tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// All joint values of the robot, radians or metres.
    pub q: Vec<f64>,
    /// Speeds of the map's joints, planar, rad/s.
    pub qd: [f64; 3],
    /// How fast the planned motion's time runs, 0 to 1.
    pub rate: f64,
    /// What the arm is doing.
    pub doing: Doing,
}
