//! Errors of switching a region.

use crate::AccessClass;

/// Why a switch was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SwitchError {
    /// The region is permanent, so it is always active.
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
