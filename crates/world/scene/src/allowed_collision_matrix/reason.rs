//! Reasons of the allowed collision matrix: why a pair is tested or not.

use std::fmt;

use elbowroom_robot::Exclusion;
use serde::{Deserialize, Serialize};

/// Why a pair is tested or not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// Tested: the pair has no reason to be skipped.
    Default,
    /// At most one moving joint between the links, directly or through fixed joints and links without colliders.
    Adjacent,
    /// No joint moves one geometry against the other.
    NoJointBetween,
    /// Disabled in the SRDF, with the reason given there.
    Srdf(String),
    /// Proven: within the joint limits the geometries are never closer than `least_m`.
    OutOfReach {
        /// Least distance of the shapes, metres.
        least_m: f64,
    },
    /// Never in contact in the sampled configurations.
    NeverInSamples {
        /// Number of sampled configurations.
        samples: u64,
        /// Confidence (rule of three) of the statement P(contact) < 3 / samples.
        confidence: f64,
    },
    /// Always in contact in the sampled configurations.
    AlwaysInContact {
        /// Number of sampled configurations.
        samples: u64,
    },
    /// In contact in the rest pose, without a collider between the links: intended by the design, or a modelling error.
    ///
    /// In the rest pose all joints are at 0, or at the limit nearest to 0.
    TouchesAtRest {
        /// Number of samples in which the geometries were in contact.
        contacts: u32,
        /// Number of sampled configurations.
        samples: u32,
    },
    /// Set by a user, with this note.
    ByHand(String),
    /// The object is at present attached to this `robot/link`.
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
