//! Resolution levels.

use std::fmt;
use std::num::NonZeroU8;
use std::str::FromStr;

/// The deepest level of the box trees: at most 2⁸ boxes per link or object.
pub(crate) const MAX_DEPTH: u8 = 8;

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
    /// The boxes at a depth of each link's or object's tree of oriented boxes, `L2:1` and below.
    ///
    /// Every depth halves the boxes above it, until a box has one triangle or one primitive. Depths beyond
    /// [`Level::MAX_DEPTH`] count as that depth. A deeper answer is never worse: if a depth answers "free", so does every
    /// deeper one, and distances do not decrease. A part inside a closed mesh is in contact with it.
    L2Depth(NonZeroU8),
    /// One capsule per link or object.
    Capsule,
    /// The convex hull of each collider.
    Hull,
    /// The exact geometry.
    L3,
}

impl Level {
    /// The levels with their own models, coarse first. The depths of [`Level::L2Depth`] are counted with [`Level::L2`].
    pub const ANSWERING: [Self; 5] = [Self::L1, Self::L2, Self::Capsule, Self::Hull, Self::L3];

    /// The deepest level of the box trees, with at most 2⁸ boxes per link or object.
    pub const MAX_DEPTH: u8 = MAX_DEPTH;

    /// The oriented boxes at a depth: [`Level::L2`] at depth 0.
    ///
    /// ```
    /// use elbowroom_scene::Level;
    /// assert_eq!("L2:3".parse(), Ok(Level::boxes(3)));
    /// assert_eq!("L2:0".parse(), Ok(Level::L2));
    /// assert_eq!(Level::boxes(3).to_string(), "L2:3");
    /// assert!(Level::L2 < Level::boxes(1) && Level::boxes(1) < Level::boxes(2) && Level::boxes(2) < Level::L3);
    /// ```
    pub fn boxes(depth: u8) -> Self {
        NonZeroU8::new(depth.min(MAX_DEPTH)).map_or(Self::L2, Self::L2Depth)
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::L1 => "L1",
            Self::L2 => "L2",
            Self::L2Depth(depth) => return write!(f, "L2:{depth}"),
            Self::Capsule => "capsule",
            Self::Hull => "hull",
            Self::L3 => "L3",
        })
    }
}

/// Error of a string that names no level.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LevelError {
    /// The word is no level.
    #[error("`{0}` is no resolution level; write auto, L1, L2, L2:1 to L2:{MAX_DEPTH}, L3, capsule or hull")]
    Unknown(String),
    /// The depth is no number, or beyond [`Level::MAX_DEPTH`].
    #[error("`{0}`: the depth of a box tree is a whole number from 0 to {MAX_DEPTH}; write L2:3")]
    Depth(String),
    /// A depth of a level that has none.
    #[error("`{given}`: only L2 has depths; write {level}, or L2:1 to L2:{MAX_DEPTH}")]
    NoDepths {
        /// The string.
        given: String,
        /// The level before the colon.
        level: Level,
    },
}

impl FromStr for Level {
    type Err = LevelError;

    fn from_str(word: &str) -> Result<Self, LevelError> {
        let Some((name, depth)) = word.split_once(':') else { return named(word, word) };
        match named(name, word)? {
            Self::L2 => match depth.parse() {
                // `parse` accepts a sign.
                Ok(number @ 0..=MAX_DEPTH) if !depth.starts_with('+') => Ok(Self::boxes(number)),
                _ => Err(LevelError::Depth(word.into())),
            },
            level => Err(LevelError::NoDepths { given: word.into(), level }),
        }
    }
}

/// The level with a name, without depth.
fn named(name: &str, given: &str) -> Result<Level, LevelError> {
    let all = [Level::Auto].into_iter().chain(Level::ANSWERING);
    let found = all.into_iter().find(|l| l.to_string().eq_ignore_ascii_case(name));
    found.ok_or_else(|| LevelError::Unknown(given.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        let depths = (0..=MAX_DEPTH).map(Level::boxes);
        for level in Level::ANSWERING.into_iter().chain([Level::Auto]).chain(depths) {
            assert_eq!(level.to_string().parse(), Ok(level));
        }
        assert_eq!("l2".parse(), Ok(Level::L2));
        assert_eq!("l2:07".parse(), Ok(Level::boxes(7)));
        assert_eq!((Level::boxes(0), Level::boxes(255)), (Level::L2, Level::boxes(MAX_DEPTH)));
    }

    #[test]
    fn a_wrong_level_says_what_to_write() {
        for (word, hint) in [
            ("L4", "write auto, L1, L2, L2:1 to L2:8"),
            ("", "write auto"),
            ("L4:2", "write auto"),
            ("L2:-1", "whole number from 0 to 8; write L2:3"),
            ("L2:+1", "write L2:3"),
            ("L2:", "write L2:3"),
            ("L2:1.5", "write L2:3"),
            ("L2:3:1", "write L2:3"),
            ("L2:9", "write L2:3"),
            ("L2:99999999999", "write L2:3"),
            ("L3:2", "only L2 has depths; write L3, or L2:1"),
            ("auto:1", "write auto, or L2:1"),
        ] {
            let message = word.parse::<Level>().unwrap_err().to_string();
            assert!(message.contains(&format!("`{word}`")) && message.contains(hint), "{message}");
        }
    }
}
