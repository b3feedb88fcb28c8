//! Published occupancies of slots, and answers to requests.

use crate::RobotSlot;

/// Position of a robot with respect to the regions of a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Occupancy {
    /// Never published. An occupancy that was published too long ago counts as unknown too.
    Unknown,
    /// Beyond the warning zone, and able to stop outside the regions.
    Outside,
    /// In the warning zone, and able to stop outside the regions.
    Warning,
    /// Outside the regions, but not proven to stop outside: the robot moves too fast, or its deceleration is not known.
    Committed,
    /// Inside.
    Inside,
}

impl Occupancy {
    pub(crate) fn from_u8(v: u8) -> Self {
        match v {
            1 => Self::Outside,
            2 => Self::Warning,
            3 => Self::Committed,
            4 => Self::Inside,
            _ => Self::Unknown,
        }
    }

    /// True if the robot is in the slot's regions or may enter them whatever is commanded now: [`Occupancy::Committed`]
    /// and [`Occupancy::Inside`]. Then the slot is not granted to other robots, and the robot does not release it.
    pub fn occupies(self) -> bool {
        self >= Self::Committed
    }
}

/// The arbiter's answer to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grant {
    /// The robot holds the slot.
    Held,
    /// This other robot holds the slot, occupies it, requested it first, or must come first so that all robots can
    /// finish.
    Waiting(RobotSlot),
    /// The occupancy of this other robot is not known.
    Unknown(RobotSlot),
    /// Robots wait for each other in a cycle, and each is inside a region that the next one needs.
    Deadlock,
}
