//! Resolution levels.

use std::fmt;
use std::str::FromStr;

/// The models that a query compares, from coarse to exact.
///
/// All levels except [`Level::Auto`] and [`Level::L3`] compare enclosing volumes, with conservative answers: "free" is
/// guaranteed; a reported contact may be a false positive; distances are lower bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum Level {
    /// From coarse to exact, only as fine as each pair needs. The answer equals that of [`Level::L3`].
    #[default]
    Auto,
    /// One axis-aligned box in the world per robot with its attached objects, and one per unattached object.
    ///
    /// Links of one robot cannot be separated at this level; they are compared at [`Level::L2`].
    L1,
    /// One oriented box per link or object, after a test of its axis-aligned box.
    L2,
    /// One capsule per link or object.
    Capsule,
    /// The convex hull of each collider.
    Hull,
    /// The exact geometry.
    L3,
}

impl Level {
    /// The levels with their own models, coarse first.
    pub const ANSWERING: [Self; 5] = [Self::L1, Self::L2, Self::Capsule, Self::Hull, Self::L3];
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::L1 => "L1",
            Self::L2 => "L2",
            Self::Capsule => "capsule",
            Self::Hull => "hull",
            Self::L3 => "L3",
        })
    }
}

/// Error of a string that names no level.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no resolution level; write auto, L1, L2, L3, capsule or hull")]
pub struct UnknownLevel(pub String);

impl FromStr for Level {
    type Err = UnknownLevel;

    fn from_str(word: &str) -> Result<Self, UnknownLevel> {
        let all = [Self::Auto].into_iter().chain(Self::ANSWERING);
        all.into_iter().find(|l| l.to_string().eq_ignore_ascii_case(word)).ok_or_else(|| UnknownLevel(word.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for level in Level::ANSWERING.into_iter().chain([Level::Auto]) {
            assert_eq!(level.to_string().parse(), Ok(level));
        }
        assert_eq!("l2".parse(), Ok(Level::L2));
        assert!("L4".parse::<Level>().unwrap_err().to_string().contains("write auto, L1"));
    }
}
