//! Parts of the hashes.

/// A part of the hashes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Collision, distance and tolerance of random states.
    Queries,
    /// Runs of random cells under the monitor.
    Overrides,
    /// Paths of planning problems.
    Plans,
}

impl Part {
    pub const ALL: [Self; 3] = [Self::Queries, Self::Overrides, Self::Plans];

    /// Returns the name: `queries`, `overrides` or `plans`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Queries => "queries",
            Self::Overrides => "overrides",
            Self::Plans => "plans",
        }
    }
}
