//! States as bytes: about 60 bytes for two robots and one slot instead of 1,000, and without allocation.
//!
//! Only canonical states are encoded: their numbers and times are small. What no step changes is not encoded.

use super::codec::Codec;
use super::state::{CellState, FaultBudget, RobotState};
use crate::{GrantsMessage, StateMessage};

impl Codec {
    fn message(&mut self, message: &mut StateMessage) {
        self.boot(&mut message.boot);
        self.number(&mut message.sequence);
        self.boot(&mut message.arbiter);
        message.slots.iter_mut().for_each(|report| self.report(report));
    }

    fn answer(&mut self, message: &mut GrantsMessage) {
        self.boot(&mut message.arbiter);
        self.number(&mut message.serial);
        self.boot(&mut message.robot_boot);
        self.number(&mut message.echo);
        for slot in &mut message.slots {
            self.token(&mut slot.granted);
            self.flag(&mut slot.release_requested);
            self.flag(&mut slot.halt);
        }
    }

    fn budget(&mut self, faults: &mut FaultBudget) {
        let FaultBudget { guard_crashes, arbiter_crashes, clears, second_arbiters, is_set_back: _ } = faults;
        for number in [guard_crashes, arbiter_crashes, clears, second_arbiters] {
            let mut wide = u64::from(*number);
            self.number(&mut wide);
            *number = wide as u8;
        }
    }

    fn state(&mut self, state: &mut CellState) {
        let slots = state.guards[0].slots();
        state.arbiter.code(self);
        let mut is_second = state.second.is_some();
        self.flag(&mut is_second);
        if is_second {
            state.second.get_or_insert_with(|| state.arbiter.clone()).code(self);
        } else {
            state.second = None;
        }
        for r in 0..state.guards.len() {
            state.guards[r].code(self);
            let RobotState { place, enters } = &mut state.robots[r];
            self.index(place);
            self.option(enters, 0, Codec::index);
            self.list(&mut state.to_arbiter[r], || StateMessage::with_slots(slots), Self::message);
            self.list(&mut state.to_guard[r], || GrantsMessage::with_slots(slots), Self::answer);
        }
        self.budget(&mut state.faults);
        state.set_indices(|r| r);
    }

    /// Encodes a canonical state.
    pub(super) fn encode(&mut self, state: &mut CellState) -> &[u8] {
        self.write();
        self.state(state);
        self.written()
    }

    /// Replaces a canonical state of the same model by the encoded one.
    pub(super) fn decode(&mut self, bytes: &[u8], state: &mut CellState) {
        self.read(bytes);
        self.state(state);
    }
}
