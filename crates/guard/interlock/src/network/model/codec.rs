//! States as bytes: about 60 bytes for two robots and one slot instead of 1,000, and without allocation.
//!
//! Only canonical states are encoded: their numbers and times are small. What no step changes is not encoded.

use super::state::{CellState, FaultBudget, RobotState};
use crate::{Boot, GrantsMessage, Micros, Occupancy, RobotSlot, SlotReport, StateMessage, Token};

/// All times are multiples of this.
const UNIT: u64 = 50;

/// Writes the fields of a state, or reads them, in the same order.
#[derive(Debug, Default)]
pub(crate) struct Codec {
    bytes: Vec<u8>,
    /// The next byte to read; `None` while writing.
    at: Option<usize>,
}

impl Codec {
    pub(crate) fn number(&mut self, number: &mut u64) {
        if let Some(at) = &mut self.at {
            *number = u64::from(self.bytes[*at]);
            *at += 1;
        } else {
            self.bytes.push(u8::try_from(*number).expect("numbers of canonical states are small"));
        }
    }

    pub(crate) fn index(&mut self, index: &mut usize) {
        let mut number = *index as u64;
        self.number(&mut number);
        *index = number as usize;
    }

    pub(crate) fn boot(&mut self, boot: &mut Boot) {
        self.number(&mut boot.0);
    }

    pub(crate) fn flag(&mut self, flag: &mut bool) {
        let mut number = u64::from(*flag);
        self.number(&mut number);
        *flag = number == 1;
    }

    pub(crate) fn time(&mut self, time: &mut Micros) {
        let mut units = time.0 / UNIT;
        self.number(&mut units);
        *time = Micros(units * UNIT);
    }

    pub(crate) fn occupancy(&mut self, occupancy: &mut Occupancy) {
        let mut number = *occupancy as u64;
        self.number(&mut number);
        *occupancy = Occupancy::from_u8(number as u8);
    }

    pub(crate) fn option<T: Copy>(&mut self, value: &mut Option<T>, some: T, code: impl FnOnce(&mut Self, &mut T)) {
        let mut is_some = value.is_some();
        self.flag(&mut is_some);
        if is_some {
            code(self, value.get_or_insert(some));
        } else {
            *value = None;
        }
    }

    pub(crate) fn token(&mut self, token: &mut Option<Token>) {
        self.option(token, Token { boot: Boot::NONE, number: 0 }, |codec, token| {
            codec.boot(&mut token.boot);
            codec.number(&mut token.number);
        });
    }

    pub(crate) fn list<T>(&mut self, list: &mut Vec<T>, new: impl Fn() -> T, code: impl Fn(&mut Self, &mut T)) {
        let mut length = list.len();
        self.index(&mut length);
        list.resize_with(length, new);
        for element in list {
            code(self, element);
        }
    }

    pub(crate) fn robots(&mut self, robots: &mut Vec<RobotSlot>) {
        self.list(robots, || RobotSlot(0), |codec, robot| codec.index(&mut robot.0));
    }

    pub(crate) fn report(&mut self, report: &mut SlotReport) {
        self.occupancy(&mut report.occupancy);
        self.flag(&mut report.wants);
        self.token(&mut report.token);
        self.token(&mut report.released);
    }

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
            self.flag(enters);
            self.list(&mut state.to_arbiter[r], || StateMessage::with_slots(slots), Self::message);
            self.list(&mut state.to_guard[r], || GrantsMessage::with_slots(slots), Self::answer);
        }
        self.budget(&mut state.faults);
        state.set_indices(|r| r);
    }

    /// Encodes a canonical state.
    pub(super) fn encode(&mut self, state: &mut CellState) -> &[u8] {
        self.bytes.clear();
        self.at = None;
        self.state(state);
        &self.bytes
    }

    /// Replaces a canonical state of the same model by the encoded one.
    pub(super) fn decode(&mut self, bytes: &[u8], state: &mut CellState) {
        self.bytes.clear();
        self.bytes.extend_from_slice(bytes);
        self.at = Some(0);
        self.state(state);
    }
}
