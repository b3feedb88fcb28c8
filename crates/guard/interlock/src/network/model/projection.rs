//! Long random schedules of cells of three robots and two slots, with faults without limit. Each step, seen from two
//! of the robots and one slot, must be possible in the model of any cell ([`free`](super::free)).

use std::hash::Hasher;

use stateright::Model;

use super::CellModel;
use super::action::{Action, ArbiterStep, Next, Report, Step};
use super::checks::{ANY, CROSSING_AND_ONE, RESTING, THREE_AND_TWO, free_resting, setting, with};
use super::mixer::Mixer;
use super::state::{CellState, FaultBudget, RobotState};
use crate::{Occupancy, RobotSlot, SlotId};

/// Steps of the suite, per cell.
const STEPS: usize = 3_000;
/// Steps after which the random schedule begins again.
const LONGEST: usize = 400;
/// Steps between which numbers are not replaced by their ranks. Guards remember the times of few messages.
const UNRANKED: usize = 4;

/// Places of the model of any cell: at rest before the border, and inside.
const RESTS: usize = 1;
const INSIDE: usize = 2;

/// A rising number for each decision.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 += 1;
        let mut mixer = Mixer::default();
        mixer.write_u64(self.0);
        (mixer.finish() >> 16) as usize % limit
    }
}

/// A robot, seen from one slot.
fn project_robot(cell: &CellModel, state: &CellState, robot: RobotSlot, slot: SlotId) -> RobotState {
    let RobotState { place, enters } = state.robots[robot.0];
    let enters = enters.filter(|next| cell.needed(robot, place, *next).any(|s| s == slot));
    let place = match cell.programs[robot.0].occupancy(place, slot) {
        Occupancy::Inside => INSIDE,
        Occupancy::Committed => RESTS,
        _ => 0,
    };
    RobotState { place, enters: enters.map(|_| INSIDE) }
}

/// A state of a cell, seen from two robots and one slot.
fn project(cell: &CellModel, model: &CellModel, state: &CellState, pair: [RobotSlot; 2], slot: SlotId) -> CellState {
    let guard = |(index, r): (usize, &RobotSlot)| state.guards[r.0].project(RobotSlot(index), slot);
    let mut projected = CellState {
        arbiter: state.arbiter.project(&pair, slot, model.settings()),
        second: None,
        guards: pair.iter().enumerate().map(guard).collect(),
        robots: pair.iter().map(|r| project_robot(cell, state, *r, slot)).collect(),
        to_arbiter: pair.iter().map(|r| state.to_arbiter[r.0].clone()).collect(),
        to_guard: pair.iter().map(|r| state.to_guard[r.0].clone()).collect(),
        faults: model.faults,
    };
    projected.to_arbiter.iter_mut().flatten().for_each(|m| m.slots = vec![m.slots[slot.0]]);
    projected.to_guard.iter_mut().flatten().for_each(|m| m.slots = vec![m.slots[slot.0]]);
    projected.set_indices(|r| r);
    for guard in &mut projected.guards {
        guard.replace_occupancy(Occupancy::Outside, Occupancy::Warning);
    }
    model.simplify(&mut projected);
    projected
}

/// Whether the model can go from one state to another in at most `steps` steps. Only the first may be any step.
fn leads_to(model: &CellModel, from: &CellState, to: &CellState, steps: usize, is_first: bool) -> bool {
    if from == to {
        return true;
    }
    let mut actions = Vec::new();
    model.actions(from, &mut actions);
    if !is_first {
        actions.retain(|action| match action {
            Action::Tick(_, step) => matches!(step, Step::Enter(_)),
            Action::Arbiter(ArbiterStep::Answer(_)) => true,
            // A third robot lets an arbiter start again.
            Action::Arbiter(ArbiterStep::Other(report, next)) => (*report, *next) == (Report::Outside, Next::Undecided),
            _ => false,
        });
    }
    let nexts: Vec<CellState> = actions.into_iter().filter_map(|action| model.next_state(from, action)).collect();
    nexts.contains(to) || steps > 1 && nexts.iter().any(|next| leads_to(model, next, to, steps - 1, false))
}

fn is_fault(action: Action) -> bool {
    matches!(action, Action::CrashGuard(..) | Action::Arbiter(ArbiterStep::Crash(_) | ArbiterStep::Clear(..)))
}

/// Takes random steps, and calls `check` with the state before and after each.
fn walk(cell: &CellModel, steps: usize, mut check: impl FnMut(&CellState, Action, &CellState)) {
    let (mut dice, mut actions) = (Dice(0), Vec::new());
    let mut state = cell.init_states().remove(0);
    for step in 0..steps {
        if step % LONGEST == 0 {
            state = cell.init_states().remove(0);
        }
        actions.clear();
        cell.actions(&state, &mut actions);
        let action = actions[dice.below(actions.len())];
        let mut next = state.clone();
        let is_rare = is_fault(action) || action == Action::TimePasses;
        if is_rare && dice.below(12) > 0 || cell.act(&mut next, action).is_none() {
            continue;
        }
        // A process whose clock is set back takes a number between ranks.
        if step % UNRANKED == 0 || cell.faults.is_set_back {
            cell.simplify(&mut next);
        }
        check(&state, action, &next);
        state = next;
    }
}

/// All pairs of robots with a slot that both use.
fn sharing(cell: &CellModel) -> Vec<([RobotSlot; 2], SlotId)> {
    let uses = |r: RobotSlot, slot| cell.programs[r.0].uses(slot);
    let pairs = || cell.robots().flat_map(|a| cell.robots().filter(move |b| a.0 < b.0).map(move |b| [a, b]));
    cell.slots()
        .flat_map(|slot| pairs().filter(move |pair| pair.iter().all(|r| uses(*r, slot))).map(move |p| (p, slot)))
        .collect()
}

/// Three robots and two slots, with every fault any number of times. Robots keep their index.
fn cells() -> [(&'static str, CellModel); 4] {
    let cell = |programs| CellModel { classes: vec![0, 1, 2], ..with(ANY, ANY, ANY, programs) };
    let three_in_two = cell(THREE_AND_TWO);
    let faults = FaultBudget { is_set_back: true, ..three_in_two.faults };
    let set_back = CellModel { faults, ..cell(THREE_AND_TWO) };
    let resting = cell(RESTING);
    [
        ("crossing and one", cell(CROSSING_AND_ONE)),
        ("three in two", three_in_two),
        ("set back", set_back),
        ("resting", resting),
    ]
}

#[test]
fn each_step_of_three_robots_and_two_slots_is_possible_in_the_model_of_any_cell() {
    for (name, cell) in cells() {
        let model = CellModel { faults: cell.faults, ..free_resting(ANY, ANY, ANY) };
        let initial = cell.init_states().remove(0);
        let mut moved = 0;
        for (pair, slot) in sharing(&cell) {
            assert_eq!(project(&cell, &model, &initial, pair, slot), model.init_states()[0], "{name}: {pair:?}");
            walk(&cell, setting("ELBOWROOM_MODEL_PROJECTED").unwrap_or(STEPS), |before, action, after| {
                let [from, to] = [before, after].map(|state| project(&cell, &model, state, pair, slot));
                moved += usize::from(from != to);
                let is_possible = leads_to(&model, &from, &to, 3, true);
                assert!(is_possible, "{name}, {pair:?}, {slot:?}: {action:?}\n{from:#?}\n{to:#?}");
            });
        }
        println!("{name}: {moved} changes seen from two robots and one slot");
        assert!(moved > 1_000);
    }
}

/// Without merging, a step may lead from each of the states that are one state in the model. The walk takes steps from
/// states that are not merged.
#[test]
fn each_step_without_merging_is_a_step_with_merging() {
    for (name, cell) in cells() {
        let merged = |state: &CellState| {
            let mut merged = state.clone();
            cell.simplify(&mut merged);
            merged
        };
        walk(&cell, setting("ELBOWROOM_MODEL_PROJECTED").unwrap_or(STEPS), |before, action, after| {
            let is_possible = leads_to(&cell, &merged(before), &merged(after), 1, true);
            assert!(is_possible, "{name}: {action:?}\n{before:#?}\n{after:#?}");
        });
    }
}

#[test]
fn no_slot_is_shared_in_long_random_schedules() {
    for (name, cell) in cells() {
        let (mut steps, mut grants) = (0, 0);
        walk(&cell, setting("ELBOWROOM_MODEL_STEPS").unwrap_or(100_000), |before, _, after| {
            steps += 1;
            grants += cell
                .slots()
                .filter(|s| before.arbiter.holder(*s).is_none() && after.arbiter.holder(*s).is_some())
                .count();
            assert!(cell.is_exclusive(after), "{name}: {after:#?}");
        });
        println!("{name}: {steps} random steps, {grants} grants");
    }
}
