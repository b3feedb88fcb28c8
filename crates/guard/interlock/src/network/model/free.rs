//! Any number of other robots and slots: a cell is reduced to two of its robots and one of its slots.
//!
//! If a cell of any size could break exclusion, two of its robots would share one of its slots. This model keeps
//! only these two robots and this slot. Everything else may do at any time whatever it could do to them, and more:
//!
//! - **The other slots** delay a robot at its places, order the grants, and are a reason for answers. Here a robot may
//!   stay at each place, the arbiter may grant the slot to any robot, also to one that does not wait, or to none
//!   ([`Next`]), and it may answer a robot at any time.
//! - **The other robots** are one robot, without a guard. It may be known to be outside or not, in each step. It may
//!   be found inside, be granted the slot under the arbiter's own conditions, and give it up at any time, which
//!   includes its crashes and clears.
//! - **Requests to give a grant up and halts**, because of cycles or of robots that are found inside: a guard may be
//!   asked to give up its grant whenever it sends. A guard that must halt does nothing that a guard which is asked
//!   could not do too: the robot of such a guard may also stay outside.
//! - **Programs**: a robot is in the warning zone or inside; in a larger model also at rest before the border, where it may
//!   count as one that can no longer stop outside, in any order. A robot that is outside may do nothing that a robot in the
//!   warning zone could not do, if it may be asked to give up its grant, and need not request one. A robot that moves and can
//!   no longer stop was let in. Its next tick finds it inside, which an arbiter treats at least as strictly as committed.
//!
//! So each step of a cell, seen from two of its robots and one slot, is none, one or a few steps of this model.
//! `projection` checks this for each step of long schedules of larger cells.

use super::CellModel;
use super::action::{ArbiterStep, Next, Report};
use super::state::{CellState, NOW};
use crate::{Boot, Occupancy, RobotSlot, SlotId, SlotReport, StateMessage, Token};

const UNDECIDED: &[Next] = &[Next::Undecided];
const ANY: &[Next] = &[Next::Undecided, Next::Robot(RobotSlot(0)), Next::Robot(RobotSlot(1)), Next::Other];

impl CellModel {
    /// The choices for a step of the arbiter that may free the slot if this robot holds it.
    pub(super) fn nexts(&self, state: &CellState, sender: Option<RobotSlot>) -> &'static [Next] {
        let may_be_granted = |slot: SlotId| {
            let is_kept = state.arbiter.is_kept(slot);
            state.arbiter.holder(slot).is_none_or(|h| Some(h) == sender || is_kept && h != state.other())
        };
        let may_be_free = self.slots().any(may_be_granted);
        if self.is_free && may_be_free { ANY } else { UNDECIDED }
    }

    /// Prepares the arbiter so that its next step considers this robot only.
    pub(super) fn choose(&self, state: &mut CellState, next: Next) {
        if !self.is_free {
            return;
        }
        let other = state.other();
        let waiting = match next {
            Next::Undecided => None,
            Next::Robot(robot) => Some(robot),
            Next::Other => Some(other),
        };
        state.arbiter.set_waiting(waiting);
        // A robot beyond the model that is unknown, or not outside, only prevents grants.
        state.arbiter.set_known(other, waiting.is_some(), NOW);
    }

    pub(super) fn steps_of_others(&self, state: &CellState, steps: &mut Vec<ArbiterStep>) {
        if self.is_free {
            let nexts = self.nexts(state, Some(state.other()));
            steps.extend(nexts.iter().map(|next| ArbiterStep::Other(Report::Outside, *next)));
            steps.push(ArbiterStep::Other(Report::Inside, Next::Undecided));
            // While it reports that, nobody else is granted the slot.
            steps.push(ArbiterStep::Other(Report::Committed, Next::Undecided));
            steps.push(ArbiterStep::Other(Report::Committed, Next::Other));
            steps.extend(self.robots().map(ArbiterStep::Answer));
        }
    }

    pub(super) fn hear_other(&self, state: &mut CellState, report: Report, next: Next) {
        self.choose(state, next);
        let occupancy = match report {
            Report::Outside => Occupancy::Outside,
            Report::Committed => Occupancy::Committed,
            Report::Inside => Occupancy::Inside,
        };
        let released = Some(Token { boot: Boot(u64::MAX), number: u64::MAX });
        let report = SlotReport { occupancy, wants: next == Next::Other, token: None, released };
        let (boot, arbiter) = (Boot(1), state.arbiter.boot());
        let message =
            StateMessage { robot: state.other(), boot, sequence: 1, checksum: 0, arbiter, slots: vec![report] };
        let replies = state.arbiter.receive(&message, NOW).replies;
        self.reply(state, replies);
    }
}
