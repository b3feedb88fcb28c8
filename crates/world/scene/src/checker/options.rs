//! Settings of a checker.

use crate::Level;

/// Settings of a [`Checker`](crate::Checker).
///
/// Only [`CheckerOptions::level`] changes answers, with one exception: at levels of enclosing volumes, the allowed
/// collision matrix makes distances more exact, because its proofs are tighter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CheckerOptions {
    /// The level of the models that are compared.
    pub level: Level,
    /// First level of [`Level::Auto`]: [`Level::L1`], [`Level::L2`], or [`Level::L3`] (exact geometry only).
    pub start: Level,
    /// Whether the pairs most likely to collide, by kinematics and earlier contacts, are tested first.
    ///
    /// Otherwise the order is that of the hierarchy: of several contacts, the one nearest to a base is reported.
    pub weights: bool,
    /// Whether pairs that the allowed collision matrix proves out of reach are skipped.
    ///
    /// Pairs excluded by rule (adjacent links, SRDF, by hand) never count.
    pub matrix: bool,
}

impl Default for CheckerOptions {
    fn default() -> Self {
        Self { level: Level::Auto, start: Level::L1, weights: true, matrix: true }
    }
}

impl CheckerOptions {
    /// The level at which single pairs are compared.
    pub(crate) fn pair_level(self) -> Level {
        match self.level {
            Level::Auto => Level::L3,
            Level::L1 => Level::L2,
            level => level,
        }
    }

    /// True if the boxes of a pair may decide that it is clear, because the answer is the same.
    pub(crate) fn uses_boxes(self) -> bool {
        match self.level {
            Level::Auto => self.start <= Level::L2,
            Level::L1 | Level::L2 | Level::L2Depth(_) | Level::Hull => true,
            // A capsule may extend beyond the box.
            Level::Capsule | Level::L3 => false,
        }
    }

    /// True if the boxes around whole robots may decide that all their pairs are clear.
    pub(crate) fn uses_robot_boxes(self) -> bool {
        match self.level {
            Level::Auto => self.start <= Level::L1,
            level => level == Level::L1,
        }
    }
}
