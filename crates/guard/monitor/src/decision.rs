//! The speed override that the regions request, and the region that governs it.

use crate::region_clearance::RegionClearance;
use crate::region_clearances::RegionClearances;
use crate::region_states::RegionStates;
use crate::zone_client::ZoneClient;
use crate::{Configuration, OverrideReason, RegionId, RegionKind, Snapshot};

/// The smallest requested override and its reason.
pub(crate) struct Decision<'a> {
    pub(crate) speed_override: f64,
    /// Upper limit in this tick; a limited rate of change must not exceed it.
    pub(crate) immediate_limit: f64,
    pub(crate) reason: OverrideReason,
    pub(crate) governing: Option<&'a RegionClearance>,
}

impl<'a> Decision<'a> {
    /// Override 0, applied at once.
    pub(crate) fn stop(reason: OverrideReason, governing: Option<&'a RegionClearance>) -> Self {
        Self { speed_override: 0.0, immediate_limit: 0.0, reason, governing }
    }

    /// The minimum over all regions (Romanelli 2011, eq. 4); of equal requests, the one of the region with the lowest
    /// index.
    pub(crate) fn of(
        config: &Configuration,
        regions: &RegionStates,
        clearances: &'a RegionClearances,
        zone_client: Option<&ZoneClient>,
        s: &Snapshot,
    ) -> Self {
        if let Some(region) = zone_client.and_then(ZoneClient::halted_by) {
            return Self::stop(OverrideReason::Halted(region), clearances.get(region));
        }
        let v0 = s.programmed_override;
        let mut decision =
            Self { speed_override: v0, immediate_limit: v0, reason: OverrideReason::Free, governing: None };
        for id in clearances.near().iter().map(|r| RegionId(*r as usize)).filter(|id| regions.is_active(*id)) {
            let Some(clearance) = clearances.get(id) else { continue };
            let kind = config.regions[id.0].kind;
            let may_enter = |slot| zone_client.is_some_and(|client| client.may_enter(slot, s.now_s));
            let reason = match kind {
                RegionKind::Exchange { slot } if may_enter(slot) => continue,
                RegionKind::Exchange { .. } => OverrideReason::Waiting(id),
                RegionKind::Forbidden => OverrideReason::Region(id),
                RegionKind::Monitored { .. } => OverrideReason::SpeedZone(id),
            };
            decision.immediate_limit = decision.immediate_limit.min(clearance.immediate_limit);
            let requested = clearance.requested_override;
            let is_tie =
                requested == decision.speed_override && decision.governing.is_some_and(|g| id < g.governing.region);
            if requested < decision.speed_override || is_tie {
                (decision.speed_override, decision.reason, decision.governing) = (requested, reason, Some(clearance));
            }
        }
        decision
    }
}
