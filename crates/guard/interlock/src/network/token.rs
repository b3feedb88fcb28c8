//! Numbers that only increase: starts of processes, and grants.

/// Number of the start of a process. A later start of the same role has a higher number; 0 means none.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Boot(pub u64);

impl Boot {
    /// No process.
    pub const NONE: Self = Self(0);

    /// The number after this one.
    #[must_use]
    pub fn next(self) -> Self {
        Self(self.0.saturating_add(1))
    }
}

/// Identifies one grant of one slot. Tokens of a slot increase, also across starts of the arbiter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Token {
    /// Start of the arbiter that granted.
    pub boot: Boot,
    /// Number of the grant since that start.
    pub number: u64,
}
