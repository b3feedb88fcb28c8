//! What the oracle finds in a recording.

/// A surface counts as crossed when it is crossed by more than this, m: rounding is below it.
pub const TOLERANCE_M: f64 = 1e-6;

/// What a run did that it must not do.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// A robot drove into a forbidden region that it was outside of.
    Entry { robot: usize, region: usize, t_s: f64, speed: f64 },
    /// A robot was in a forbidden region although `check` says that entry is excluded.
    Excluded { robot: usize, region: usize, t_s: f64, speed: f64 },
    /// Two robots were inside one exchange region.
    TwoInside { region: usize, robots: [usize; 2], t_s: f64 },
    /// Robots wait for one another for ever, and the recording does not report it.
    SilentDeadlock { robots: Vec<usize> },
    /// A joint slowed down harder than it can.
    TooHard { robot: usize, joint: usize, t_s: f64, deceleration: f64, limit: f64 },
}

/// What was found, and what else is worth counting.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    pub list: Vec<Finding>,
    /// Entries into regions that accelerated just before, and tools that were exchanged into an exchange region where `check` says
    /// that this is not excluded: nobody can foresee that.
    pub unforeseen_entries: usize,
    /// Sets of robots that wait for one another for ever.
    pub deadlocks: usize,
    /// Pairs of robot and region that were watched for entry.
    pub watched: usize,
}
