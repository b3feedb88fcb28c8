//! State of a robot with respect to a region, with hysteresis, and the digital outputs derived from it.

use crate::Occupancy;
use crate::event::EventLog;
use crate::{EventKind, Region, RegionId};

/// Whether a guarded volume is inside a region or its warning zone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct ZoneState {
    pub(crate) warned: bool,
    pub(crate) inside: bool,
}

impl ZoneState {
    /// The occupancy that the robot publishes; `can_stop` if it can stop outside the region.
    pub(crate) fn occupancy(self, can_stop: bool) -> Occupancy {
        match (self.inside, can_stop, self.warned) {
            (true, ..) => Occupancy::Inside,
            (false, false, _) => Occupancy::Committed,
            (false, true, true) => Occupancy::Warning,
            (false, true, false) => Occupancy::Outside,
        }
    }

    /// The state at this distance (m; infinite beyond the measured range). A boundary is crossed outwards only beyond the
    /// hysteresis.
    pub(crate) fn next(self, distance_m: f64, region: &Region) -> Self {
        let h = region.hysteresis_m;
        let inside = distance_m <= 0.0 || (self.inside && distance_m <= h);
        let zone = region.warning_m;
        let warned = inside || distance_m < zone || (self.warned && distance_m <= zone + h);
        Self { warned, inside }
    }
}

/// Digital outputs: a channel is on while any of its regions requests it.
#[derive(Debug)]
pub(crate) struct DigitalOutputs {
    requests: [u32; 64],
    pub(crate) bits: u64,
}

impl DigitalOutputs {
    pub(crate) fn new() -> Self {
        Self { requests: [0; 64], bits: 0 }
    }

    /// Applies a region's change of state and logs it.
    pub(crate) fn change(&mut self, id: RegionId, region: &Region, from: ZoneState, to: ZoneState, log: &mut EventLog) {
        use EventKind::{InsideIn, InsideOut, WarnIn, WarnOut};
        if !from.warned && to.warned {
            log.push(Some(id), WarnIn);
        }
        if from.inside != to.inside {
            log.push(Some(id), if to.inside { InsideIn } else { InsideOut });
        }
        if from.warned && !to.warned {
            log.push(Some(id), WarnOut);
        }
        self.set(id, region.output, from.inside, to.inside, log);
        self.set(id, region.warning_output, from.warned, to.warned, log);
    }

    fn set(&mut self, id: RegionId, channel: Option<u8>, from: bool, to: bool, log: &mut EventLog) {
        let Some(channel) = channel.filter(|_| from != to) else { return };
        let Some(requests) = self.requests.get_mut(usize::from(channel)) else { return };
        *requests = if to { *requests + 1 } else { requests.saturating_sub(1) };
        let bit = 1_u64 << channel;
        let on = *requests > 0;
        if on != (self.bits & bit != 0) {
            self.bits ^= bit;
            log.push(Some(id), if on { EventKind::OutputOn(channel) } else { EventKind::OutputOff(channel) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Vec3;

    #[test]
    fn zone_states_reset_only_beyond_the_hysteresis() {
        let region = Region::sphere("s", Vec3::ZERO, 1.0).warning(0.1);
        let near = ZoneState::default().next(0.099, &region);
        assert!(near.warned && !near.inside);
        assert!(near.next(0.1005, &region).warned);
        assert!(!near.next(0.1011, &region).warned);
        let inside = near.next(0.0, &region);
        assert!(inside.inside && inside.next(0.0009, &region).inside && !inside.next(0.0011, &region).inside);
    }

    #[test]
    fn a_channel_shared_by_two_regions_stays_on_until_both_are_left() {
        let mut region = Region::sphere("s", Vec3::ZERO, 1.0);
        region.output = Some(63);
        let (mut outputs, mut log) = (DigitalOutputs::new(), EventLog::with_capacity(16));
        let (out, inside) = (ZoneState::default(), ZoneState { warned: true, inside: true });
        outputs.change(RegionId(0), &region, out, inside, &mut log);
        outputs.change(RegionId(1), &region, out, inside, &mut log);
        outputs.change(RegionId(0), &region, inside, out, &mut log);
        assert_eq!(outputs.bits, 1 << 63);
        outputs.change(RegionId(1), &region, inside, out, &mut log);
        assert_eq!(outputs.bits, 0);
    }
}
