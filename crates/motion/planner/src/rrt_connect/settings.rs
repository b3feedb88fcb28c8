//! Settings of RRT-Connect.

use std::time::Duration;

/// Settings of [`RrtConnect`](crate::RrtConnect).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RrtConnectSettings {
    /// Time limit of search and shortcutting together, approximately.
    pub time_limit: Duration,
    /// Approximate limit of checked configurations. Unlike a time limit, it acts in the same way on every machine.
    pub max_states: u64,
    /// Distance that pairs keep in addition to their security margins, m.
    pub clearance_m: f64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Longest edge of a tree in the exact scene, Euclidean over all values, rad (and m). A constraint that projects has
    /// its own.
    pub edge_length: f64,
    /// Largest step of a discrete check in the exact scene: a step moves solids about as far as this motion (rad or m)
    /// of the joint that moves them most. The proof finds collisions in between.
    pub check_resolution: f64,
}

impl Default for RrtConnectSettings {
    /// 5 s, any number of configurations, clearance 0.
    fn default() -> Self {
        Self {
            time_limit: Duration::from_secs(5),
            max_states: u64::MAX,
            clearance_m: 0.0,
            seed: 1,
            edge_length: 0.6,
            check_resolution: 0.06,
        }
    }
}

/// A setting that can be invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RrtConnectSetting {
    /// [`RrtConnectSettings::clearance_m`].
    Clearance,
    /// [`RrtConnectSettings::edge_length`].
    EdgeLength,
    /// [`RrtConnectSettings::check_resolution`].
    CheckResolution,
}

impl RrtConnectSetting {
    /// Valid values of the setting in words.
    pub(super) fn range(self) -> &'static str {
        match self {
            Self::Clearance => "a finite number of metres, 0 or more",
            Self::EdgeLength | Self::CheckResolution => "a finite number above 0",
        }
    }
}

impl std::fmt::Display for RrtConnectSetting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Clearance => "the clearance",
            Self::EdgeLength => "the edge length",
            Self::CheckResolution => "the check resolution",
        })
    }
}

impl RrtConnectSettings {
    /// The first invalid setting and its value.
    pub(crate) fn invalid(&self) -> Option<(RrtConnectSetting, f64)> {
        let clearance_is_valid = self.clearance_m.is_finite() && self.clearance_m >= 0.0;
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if !clearance_is_valid {
            Some((RrtConnectSetting::Clearance, self.clearance_m))
        } else if !positive(self.edge_length) {
            Some((RrtConnectSetting::EdgeLength, self.edge_length))
        } else if !positive(self.check_resolution) {
            Some((RrtConnectSetting::CheckResolution, self.check_resolution))
        } else {
            None
        }
    }
}
