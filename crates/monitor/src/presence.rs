//! Where the robot is with respect to a region, with hysteresis, and the outputs that follow from it (S1.7).

use crate::events::EventLog;
use crate::interlock::Stay;
use crate::{EventKind, Region, RegionId};

/// A region's state between ticks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Presence {
    pub(crate) warned: bool,
    pub(crate) inside: bool,
}

impl Presence {
    /// What the robot says of itself to the others; `stops` where it can stop outside the region.
    pub(crate) fn stay(self, stops: bool) -> Stay {
        match (self.inside, stops, self.warned) {
            (true, ..) => Stay::Inside,
            (false, false, _) => Stay::Committed,
            (false, true, true) => Stay::Warning,
            (false, true, false) => Stay::Outside,
        }
    }

    /// The state at this distance (infinite where far): boundaries count as crossed outwards only beyond hysteresis.
    pub(crate) fn next(self, distance_m: f64, region: &Region) -> Self {
        let h = region.hysteresis_m;
        let inside = distance_m <= 0.0 || (self.inside && distance_m <= h);
        let zone = region.warning_m;
        let warned = inside || distance_m < zone || (self.warned && distance_m <= zone + h);
        Self { warned, inside }
    }
}

/// Digital outputs: a channel is up while any of its regions wants it up.
#[derive(Debug)]
pub(crate) struct Outputs {
    wanting: [u32; 64],
    pub(crate) bits: u64,
}

impl Outputs {
    pub(crate) fn new() -> Self {
        Self { wanting: [0; 64], bits: 0 }
    }

    /// Applies a region's change of state and logs it.
    pub(crate) fn change(&mut self, id: RegionId, region: &Region, from: Presence, to: Presence, log: &mut EventLog) {
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
        let Some(wanting) = self.wanting.get_mut(usize::from(channel)) else { return };
        *wanting = if to { *wanting + 1 } else { wanting.saturating_sub(1) };
        let bit = 1_u64 << channel;
        let up = *wanting > 0;
        if up != (self.bits & bit != 0) {
            self.bits ^= bit;
            log.push(Some(id), if up { EventKind::OutputOn(channel) } else { EventKind::OutputOff(channel) });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Vec3;

    #[test]
    fn outputs_fall_only_beyond_the_hysteresis() {
        let region = Region::sphere("s", Vec3::ZERO, 1.0).warning(0.1);
        let near = Presence::default().next(0.099, &region);
        assert!(near.warned && !near.inside);
        assert!(near.next(0.1005, &region).warned);
        assert!(!near.next(0.1011, &region).warned);
        let inside = near.next(0.0, &region);
        assert!(inside.inside && inside.next(0.0009, &region).inside && !inside.next(0.0011, &region).inside);
    }

    #[test]
    fn a_channel_shared_by_two_regions_stays_up_until_both_are_left() {
        let mut region = Region::sphere("s", Vec3::ZERO, 1.0);
        region.output = Some(63);
        let (mut outputs, mut log) = (Outputs::new(), EventLog::with_capacity(16));
        let (out, inside) = (Presence::default(), Presence { warned: true, inside: true });
        outputs.change(RegionId(0), &region, out, inside, &mut log);
        outputs.change(RegionId(1), &region, out, inside, &mut log);
        outputs.change(RegionId(0), &region, inside, out, &mut log);
        assert_eq!(outputs.bits, 1 << 63);
        outputs.change(RegionId(1), &region, inside, out, &mut log);
        assert_eq!(outputs.bits, 0);
    }
}
