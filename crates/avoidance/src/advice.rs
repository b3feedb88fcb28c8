//! What goes into a tick beside what is near, and what comes out beside the joint values.

use std::time::Duration;

use crate::Reaction;

/// Where the path wants the robot to be at the end of the tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference<'a> {
    /// Joint values, rad or m.
    pub q: &'a [f64],
    /// Their velocities at the full rate of the path (override 1), rad/s or m/s.
    pub qd: &'a [f64],
    /// What the path is for.
    pub path: PathKind,
}

/// What a path is for (S4.11).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PathKind {
    /// Every point of it counts (a seam, a line): it is slowed down on rather than left, and resumed where it was left.
    Continuous,
    /// Only its end counts: it may be left and joined again farther on.
    PointToPoint,
}

/// What the robot is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Doing {
    /// On its path.
    #[default]
    Following,
    /// Correcting its motion.
    Evading,
    /// On the way back to its path.
    Returning,
    /// Going around on a planned way.
    Rounding,
    /// Wants to move and cannot.
    Waiting,
    /// The override is 0.
    Halted,
}

impl Doing {
    /// In one word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Following => "following",
            Self::Evading => "evading",
            Self::Returning => "returning",
            Self::Rounding => "rounding",
            Self::Waiting => "waiting",
            Self::Halted => "halted",
        }
    }
}

/// How long the stages of a tick took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TickTimes {
    /// Placing everything and finding what is near.
    pub sense: Duration,
    /// Rules and least squares.
    pub correct: Duration,
    /// The sweep between this command and the next.
    pub check: Duration,
}

impl TickTimes {
    /// All stages.
    pub fn total(&self) -> Duration {
        self.sense + self.correct + self.check
    }
}

/// What the tick says beside the joint values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Advice {
    /// How fast the path may be gone on with, as a share of its full rate, 0 to 1.
    pub rate: f64,
    /// What the robot is doing.
    pub doing: Doing,
    /// Of the single look.
    pub reaction: Reaction,
    /// Least distance to what moves or is not known, m; infinite where none of it is near.
    pub nearest_m: f64,
    /// The object or robot link that asked for the correction.
    pub governed_by: Option<usize>,
    /// Off the path by so many seconds of joint motion at full speed.
    pub astray_s: f64,
    /// A sweep found that the command, or a stop after it, would have hit something; it was replaced by braking.
    pub braked: bool,
    /// A proven way is wanted ([`crate::Avoider::plan_to`]): off its path the robot stands and nothing comes, or it has not got on
    /// for the time of patience because of what stands in its way.
    pub wants_way: bool,
    /// How long it took.
    pub times: TickTimes,
}
