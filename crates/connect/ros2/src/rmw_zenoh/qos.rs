//! Quality of service, in the form of a token.

/// Whether samples may be lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reliability {
    /// Samples are not lost.
    #[default]
    Reliable,
    /// Samples may be lost.
    BestEffort,
}

/// Whether a subscription that comes later gets the last samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Durability {
    /// Late subscriptions get the last samples, which the publisher keeps ("latched").
    TransientLocal,
    /// Late subscriptions get only new samples.
    #[default]
    Volatile,
}

/// Quality of service: the settings that differ from the defaults of `rmw_zenoh`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Qos {
    /// Whether samples may be lost.
    pub reliability: Reliability,
    /// Whether late subscriptions get the last samples.
    pub durability: Durability,
    /// Number of samples that are kept.
    pub depth: usize,
}

/// The depth that a token omits.
const DEFAULT_DEPTH: usize = 42;

impl Qos {
    /// Reliable, without samples for late subscriptions: `rclcpp::QoS(depth)`.
    pub const fn keep_last(depth: usize) -> Self {
        Self { reliability: Reliability::Reliable, durability: Durability::Volatile, depth }
    }

    /// Reliable, with the last sample for late subscriptions: `/robot_description`, `/tf_static`.
    pub const fn latched() -> Self {
        Self { durability: Durability::TransientLocal, ..Self::keep_last(1) }
    }

    /// Best effort, for measurements.
    pub const fn sensor_data() -> Self {
        Self { reliability: Reliability::BestEffort, ..Self::keep_last(5) }
    }

    /// The last part of a token: `reliability:durability:history,depth:deadline:lifespan:liveliness`; a part is empty
    /// for the default (reliable, volatile, keep the last 42, no times, automatic).
    pub fn token(self) -> String {
        let reliability = if self.reliability == Reliability::BestEffort { "2" } else { "" };
        let durability = if self.durability == Durability::TransientLocal { "1" } else { "" };
        let depth = if self.depth == DEFAULT_DEPTH { String::new() } else { self.depth.to_string() };
        format!("{reliability}:{durability}:,{depth}:,:,:,,")
    }
}
