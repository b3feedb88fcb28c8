//! What a tick answers.

use std::fmt;

use elbowroom_spatial::Vec3;

use crate::RegionId;

/// The answer of one tick: fixed size, plain data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TickReport {
    /// Time stamp of the snapshot it answers, s.
    pub stamp_s: f64,
    /// The speed override to obey, 0..1, the programmed override in it.
    pub speed_override: f64,
    /// Why it is what it is.
    pub reason: Reason,
    /// The virtual TCP that asks for the smallest override, where one asks for any.
    pub governing: Option<VirtualTcp>,
    /// Digital outputs, bit i is channel i.
    pub outputs: u64,
    /// Pairs of volume and region that were measured exactly in this tick.
    pub measured_pairs: u32,
}

/// The closest point of the guarded volume to a region (S1.11, CPD).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualTcp {
    /// The region.
    pub region: RegionId,
    /// Index of the volume in the configuration.
    pub volume: usize,
    /// Distance to the region, 0 inside, m.
    pub distance_m: f64,
    /// The point of the volume, in the world, m.
    pub position: Vec3,
    /// The closest point of the region, in the world, m.
    pub on_region: Vec3,
    /// Velocity of the point relative to the region, m/s.
    pub velocity: Vec3,
    /// Acceleration of the point relative to the region, m/s².
    pub acceleration: Vec3,
}

/// Why an override is what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reason {
    /// No region asks for less than the programmed override.
    Free,
    /// A forbidden region is near.
    Region(RegionId),
    /// A speed zone is near.
    SpeedZone(RegionId),
    /// An exchange region is near that another robot holds.
    Waiting(RegionId),
    /// The override is still rising or falling at its largest rate.
    Rate,
    /// The input cannot be trusted.
    Fault(Fault),
}

impl Reason {
    /// The region that governs, where one does.
    pub fn region(self) -> Option<RegionId> {
        match self {
            Self::Region(r) | Self::SpeedZone(r) | Self::Waiting(r) => Some(r),
            Self::Free | Self::Rate | Self::Fault(_) => None,
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Free => write!(f, "free"),
            Self::Region(r) => write!(f, "near forbidden region {}", r.0),
            Self::SpeedZone(r) => write!(f, "speed zone {}", r.0),
            Self::Waiting(r) => write!(f, "waiting for exchange region {}", r.0),
            Self::Rate => write!(f, "override changing at its largest rate"),
            Self::Fault(fault) => write!(f, "{fault}"),
        }
    }
}

/// Input that stops the robot (P.6).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Older than the configured age.
    Stale,
    /// Its time stamp lies before that of the snapshot before, or in the future.
    Backwards,
    /// A number is NaN or infinite.
    NotFinite,
    /// A slice has not one entry per joint, or per source.
    WrongLength,
    /// The programmed override is not within 0..1.
    ProgrammedOverride,
    /// A joint is beyond its limits.
    BeyondLimits {
        /// Index of the joint in `q`.
        joint: usize,
    },
    /// A joint is faster than it can be, or jumped farther than it can since the snapshot before.
    TooFast {
        /// Index of the joint in `q`.
        joint: usize,
    },
    /// The stopping-distance law is on, and no velocity is known yet: none was given, and this is the first position.
    NoVelocity,
    /// The joint values have not changed by a bit although the robot was told to move: the reading is frozen.
    Frozen,
    /// The robot brakes less than was stated ([`Stopping`](crate::Stopping)).
    Braking,
    /// The source of motion that an active region follows is stale or not finite.
    Source {
        /// The region.
        region: RegionId,
    },
    /// The source of motion that an active region follows is farther away than it can be by now, or than the motion that it
    /// states explains.
    SourceJump {
        /// The region.
        region: RegionId,
    },
}

impl Fault {
    /// True where the snapshot's times were found to be in order: others may have no meaning.
    pub(crate) fn knows_the_time(self) -> bool {
        use Fault::{BeyondLimits, Braking, Frozen, NoVelocity, Source, SourceJump, TooFast};
        matches!(
            self,
            BeyondLimits { .. } | TooFast { .. } | NoVelocity | Frozen | Braking | Source { .. } | SourceJump { .. }
        )
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stale => write!(f, "input is stale"),
            Self::Backwards => write!(f, "input is out of order"),
            Self::NotFinite => write!(f, "input is not a finite number"),
            Self::WrongLength => write!(f, "input has the wrong number of values"),
            Self::ProgrammedOverride => write!(f, "the programmed override is not within 0..1"),
            Self::BeyondLimits { joint } => write!(f, "joint {joint} is beyond its limits"),
            Self::TooFast { joint } => write!(f, "joint {joint} moves faster than it can"),
            Self::NoVelocity => write!(f, "no joint velocities are known yet"),
            Self::Frozen => write!(f, "joint values do not change although the robot is told to move"),
            Self::Braking => write!(f, "the robot brakes less than its stated deceleration"),
            Self::Source { region } => write!(f, "the source that region {} follows is lost", region.0),
            Self::SourceJump { region } => {
                write!(f, "the source that region {} follows jumped, or moves otherwise than it says", region.0)
            }
        }
    }
}
