//! State of each region of a monitor: whether it is on, and whether the robot is in it.

use crate::event::EventLog;
use crate::grid_states::GridStates;
use crate::placement::Placement;
use crate::region_clearances::RegionClearances;
use crate::region_state::RegionState;
use crate::region_sweep::RegionSweep;
use crate::zone_state::{DigitalOutputs, ZoneState};
use crate::{Configuration, EventKind, RegionId};

/// The regions of a monitor, by their indices, and the digital outputs that they and the grids request.
#[derive(Debug)]
pub(crate) struct RegionStates {
    states: Vec<RegionState>,
    /// Regions in whose warning zone the robot is, in this tick and in the previous one.
    warned: Vec<u32>,
    previously_warned: Vec<u32>,
    /// Regions switched since the last tick.
    switched: Vec<(RegionId, bool)>,
    /// Regions switched for this tick; the motion since the previous tick does not count for them.
    just_switched: Vec<RegionId>,
    outputs: DigitalOutputs,
    grids: GridStates,
}

impl RegionStates {
    /// The initial states: permanent regions are on, temporary regions are off.
    pub(crate) fn new(config: &Configuration) -> Self {
        let count = config.regions.len();
        Self {
            states: config.regions.iter().map(RegionState::new).collect(),
            warned: Vec::with_capacity(count),
            previously_warned: Vec::with_capacity(count),
            switched: Vec::with_capacity(2 * count + 16),
            just_switched: Vec::with_capacity(2 * count + 16),
            outputs: DigitalOutputs::new(),
            grids: GridStates::new(config),
        }
    }

    pub(crate) fn get(&self, region: RegionId) -> &RegionState {
        &self.states[region.0]
    }

    pub(crate) fn as_slice(&self) -> &[RegionState] {
        &self.states
    }

    pub(crate) fn is_active(&self, region: RegionId) -> bool {
        self.states[region.0].active
    }

    /// The digital outputs, one bit each.
    pub(crate) fn output_bits(&self) -> u64 {
        self.outputs.bits | self.grids.bits
    }

    /// Switches a region; returns false if it is in that state already.
    pub(crate) fn switch(&mut self, region: RegionId, on: bool) -> bool {
        let is_change = self.states[region.0].active != on;
        self.states[region.0].active = on;
        if is_change && self.switched.len() < self.switched.capacity() {
            self.switched.push((region, on));
        }
        is_change
    }

    /// Begins a tick: switches since the last tick take effect.
    pub(crate) fn begin(&mut self, log: &mut EventLog) {
        self.just_switched.clear();
        for (region, on) in self.switched.drain(..) {
            self.just_switched.push(region);
            log.push(Some(region), if on { EventKind::On } else { EventKind::Off });
        }
    }

    /// States whether the pose of a region that follows a source is known in this tick.
    pub(crate) fn set_placed(&mut self, region: RegionId, is_placed: bool) {
        self.states[region.0].is_placed = is_placed;
    }

    /// Updates where the robot is, and logs the changes.
    pub(crate) fn update(
        &mut self,
        config: &Configuration,
        clearances: &RegionClearances,
        sweep: &mut RegionSweep,
        log: &mut EventLog,
    ) {
        std::mem::swap(&mut self.warned, &mut self.previously_warned);
        self.warned.clear();
        let Self { states, warned, previously_warned, just_switched, outputs, .. } = self;
        let is_kept = |r: &&u32| clearances.is_kept(RegionId(**r as usize));
        warned.extend(previously_warned.iter().filter(is_kept));
        let left = |r: &&u32| !is_kept(r) && clearances.get(RegionId(**r as usize)).is_none();
        let left = previously_warned.iter().filter(left);
        for r in clearances.near().iter().chain(left) {
            let (id, region) = (RegionId(*r as usize), &config.regions[*r as usize]);
            let state = &mut states[id.0];
            let from = state.presence;
            let mut to = from.next(clearances.get(id).map_or(f64::INFINITY, |c| c.distance), region);
            if let Some(clearance) = clearances.get(id).filter(|_| !to.inside && !just_switched.contains(&id))
                && let ends = [clearances.previous_distance(id), clearance.distance]
                && let Some(passed_m) = sweep.passed(config, id, ends, from.warned || to.warned)
            {
                // A region that a volume passed is reported for one tick.
                to = from.next(passed_m, region);
            }
            state.presence = to;
            let reported = if state.active { to } else { ZoneState::default() };
            if reported != state.zone {
                outputs.change(id, region, state.zone, reported, log);
                state.zone = reported;
            }
            if to.warned {
                warned.push(*r);
            }
        }
    }

    /// Finds the cells of the grids in which the robot is now.
    pub(crate) fn update_grids(&mut self, config: &Configuration, now: &Placement) {
        self.grids.update(config, now);
    }

    /// Copies the state of each region that has not changed; all other regions keep their state. The cells of the
    /// grids are copied, too.
    pub(crate) fn continue_from(
        &mut self,
        config: &Configuration,
        former: &Self,
        same: &[Option<RegionId>],
        log: &mut EventLog,
    ) {
        self.warned.clear();
        self.grids.continue_from(&former.grids);
        for (r, before) in same.iter().enumerate() {
            let Some(before) = before else { continue };
            let (state, before) = (&mut self.states[r], *former.get(*before));
            self.outputs.change(RegionId(r), &config.regions[r], state.zone, before.zone, log);
            *state = before;
            if before.presence.warned {
                self.warned.push(r as u32);
            }
        }
    }
}
