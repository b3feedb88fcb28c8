//! Options and progress of a run.

use elbowroom_robot::RobotId;

use super::fault_injection::InputFault;

/// Options of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOptions {
    /// Whether the override of the monitor is applied (`--no-monitor`: only computed).
    pub apply_override: bool,
    /// Whether robots with `[avoidance]` evade (`--no-avoidance`: they follow their programs).
    pub avoidance: bool,
    /// Number of repetitions of the programs, multiplied by their own `repeat`.
    pub repeat: u32,
    /// Fault injection: robots that become silent and stop.
    pub silent_from: Vec<SilentFrom>,
    /// Fault injection: faulty inputs of the robots' monitors. If two faults of one robot overlap, the first one in
    /// this list applies.
    pub faults: Vec<InputFault>,
}

/// A robot that is silent and stopped after a given time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SilentFrom {
    /// The robot.
    pub robot: RobotId,
    /// The time, s.
    pub t_s: f64,
}

impl RunOptions {
    pub(super) fn is_silent(&self, robot: RobotId, t_s: f64) -> bool {
        self.silent_from.iter().any(|s| s.robot == robot && t_s >= s.t_s)
    }
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { apply_override: true, avoidance: true, repeat: 1, silent_from: Vec::new(), faults: Vec::new() }
    }
}

/// Progress of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunProgress {
    /// Simulated time, s.
    pub t_s: f64,
    /// Number of robots with completed programs.
    pub finished: usize,
    /// Number of robots.
    pub robots: usize,
}
