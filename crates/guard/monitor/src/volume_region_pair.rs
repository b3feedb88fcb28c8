//! A guarded volume near a region, and the override that the laws request for the pair.

use elbowroom_proximity::Separation;

use crate::RegionId;

/// A guarded volume near a region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VolumeRegionPair {
    /// The region.
    pub(crate) region: RegionId,
    /// Index of the volume in the configuration.
    pub(crate) volume: usize,
    /// Closest points: `on_a` lies on the volume, `on_b` on the region.
    pub(crate) separation: Separation,
}

/// The speed override that a pair requests, 0..1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RequestedOverride {
    /// The requested override.
    pub(crate) speed_override: f64,
    /// Upper limit in this tick; a limited rate of change must not exceed it.
    pub(crate) immediate_limit: f64,
}

impl RequestedOverride {
    /// An override that applies in this tick.
    pub(crate) fn immediate(speed_override: f64) -> Self {
        Self { speed_override, immediate_limit: speed_override }
    }

    /// An override that may be approached at a limited rate; the rate-limited override is at most `programmed`.
    pub(crate) fn gradual(speed_override: f64, programmed: f64) -> Self {
        Self { speed_override, immediate_limit: programmed }
    }
}
