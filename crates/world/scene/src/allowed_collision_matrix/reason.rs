//! Reasons of the allowed collision matrix: why a pair is tested or not.

use std::fmt;

use elbowroom_robot::Exclusion;
use serde::{Deserialize, Serialize};

/// Why a pair is tested or not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// No reason to skip it: tested.
    Default,
    /// At most one moving joint between them, directly or through fixed joints and links without colliders.
    Adjacent,
    /// No joint moves one against the other.
    NoJointBetween,
    /// The SRDF disables it, for its own reason.
    Srdf(String),
    /// Proven: within the joint limits they are never closer than this, metres.
    OutOfReach {
        /// Least distance of the shapes, metres.
        least_m: f64,
    },
    /// In contact in no sample of the joint space.
    NeverInSamples {
        /// Number of sampled configurations.
        samples: u64,
        /// Confidence of the rule of three: P(contact) < 3 / samples.
        confidence: f64,
    },
    /// In contact in every sample of the joint space.
    AlwaysInContact {
        /// Number of sampled configurations.
        samples: u64,
    },
    /// In contact in the rest pose (all joints at 0, or at the limit nearest to 0), with no collider between them: by design,
    /// or a modelling error.
    TouchesAtRest {
        /// Number of samples in which they were in contact.
        contacts: u32,
        /// Number of sampled configurations.
        samples: u32,
    },
    /// Decided by a user, with this note.
    ByHand(String),
    /// The object is attached to this `robot/link` at present.
    Attached(String),
    /// The object is attached to another link and may touch this one.
    MayTouch(String),
}

impl From<Exclusion> for Reason {
    fn from(exclusion: Exclusion) -> Self {
        match exclusion {
            Exclusion::Adjacent => Self::Adjacent,
            Exclusion::NoJointBetween => Self::NoJointBetween,
            Exclusion::Srdf(why) => Self::Srdf(why),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Default => write!(f, "default"),
            Self::Adjacent => write!(f, "adjacent"),
            Self::NoJointBetween => write!(f, "no joint between"),
            Self::Srdf(why) => write!(f, "SRDF: {why}"),
            Self::OutOfReach { least_m } => {
                write!(f, "out of reach: never closer than {least_m:.4} m; distances count it")
            }
            Self::NeverInSamples { samples, confidence } => write!(
                f,
                "never in {samples} samples: P(contact) < {:.1e} at {:.0} % confidence",
                3.0 / *samples as f64,
                confidence * 100.0
            ),
            Self::AlwaysInContact { samples } => write!(f, "always in contact, in {samples} samples"),
            Self::TouchesAtRest { contacts, samples } => {
                write!(f, "in contact at rest, and in {contacts} of {samples} samples, with no solid between")
            }
            Self::ByHand(note) => write!(f, "by hand: {note}"),
            Self::Attached(link) => write!(f, "attached to {link}"),
            Self::MayTouch(link) => write!(f, "held, may touch {link}"),
        }
    }
}
