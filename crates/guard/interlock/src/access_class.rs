//! Access classes of users.

/// Access classes of users in ascending order; each class includes the rights of all lower classes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AccessClass {
    /// May read everything and may not switch anything.
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
}
