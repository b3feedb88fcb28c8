//! Access classes of users.

use crate::Life;

/// Access classes of users in ascending order; each includes the rights of those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AccessClass {
    /// May read everything and switch nothing.
    Operator,
    /// May switch, add, change and remove temporary regions. User programs have this class.
    Programmer,
    /// May edit everything, including permanent regions and the laws.
    Integrator,
}

impl AccessClass {
    /// Parses `operator`, `programmer` or `integrator`.
    pub fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "operator" => Self::Operator,
            "programmer" => Self::Programmer,
            "integrator" => Self::Integrator,
            _ => return None,
        })
    }

    /// The name that [`parse`](Self::parse) accepts.
    pub fn name(self) -> &'static str {
        match self {
            Self::Operator => "operator",
            Self::Programmer => "programmer",
            Self::Integrator => "integrator",
        }
    }

    /// The lowest class that may edit or switch a region of this life.
    pub fn needed_for(life: Life) -> Self {
        match life {
            Life::Permanent => Self::Integrator,
            Life::Temporary => Self::Programmer,
        }
    }
}

/// Why a switch was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SwitchError {
    /// Permanent regions are always active.
    #[error("region `{0}` is permanent: no program can switch it; make it `life = \"temporary\"` to switch it")]
    Permanent(String),
    /// The access class is too low.
    #[error("region `{region}` can be switched by a {needed:?} or above, not by an {who:?}")]
    Class {
        /// The region.
        region: String,
        /// The class of the caller.
        who: AccessClass,
        /// The lowest class that is allowed.
        needed: AccessClass,
    },
}
