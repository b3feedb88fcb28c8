//! State of a robot with respect to an exchange region.

/// State of a robot with respect to an exchange region and the regions that share its slot (`docs/laws.md`, section
/// 11).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExchangeState {
    /// Beyond the warning zone.
    Outside,
    /// In the warning zone, without the grant.
    Waiting,
    /// Granted, and able to stop outside.
    Granted,
    /// Not inside, but possibly unable to stop outside.
    Committed,
    /// Inside.
    Inside,
}

impl ExchangeState {
    /// The name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Waiting => "waiting",
            Self::Granted => "granted",
            Self::Committed => "committed",
            Self::Inside => "inside",
        }
    }

    pub(crate) fn from_u8(v: u8) -> Self {
        match v {
            1 => Self::Waiting,
            2 => Self::Granted,
            3 => Self::Committed,
            4 => Self::Inside,
            _ => Self::Outside,
        }
    }
}
