//! Model check: every interleaving of guards, arbiter, messages, crashes and clears of a small cell, on the code that runs.
//!
//! Robots go round programs of a few places. Messages are delivered in any order, any number of times, or never: of each direction
//! at most one or two are under way per robot, and one more replaces the oldest. Time goes on in steps of one validity of a grant. Numbers
//! of which only the order matters are replaced by their ranks ([`canonical`]), so that the states are finitely many.

mod canonical;
mod programs;
mod state;

use elbowroom_monitor::{Occupancy, RobotSlot, SlotId};
use stateright::{Checker, Model, Property};

use crate::{Arbiter, ArbiterSettings, Boot, GrantsMessage, Guard, Micros, RobotSettings, StateMessage, Token};
use programs::Program;
use state::{CellState, NOW};

/// A step of time, and the validity of a grant.
const STEP: Micros = Micros(100);

/// Faults that are built in to see whether the model check finds them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PlantedFault {
    None,
    /// A person clears a robot that is not silent long enough, and grants never expire.
    HastyClear,
    /// A report without the grant counts as one that gives it up.
    TokensUnchecked,
    /// A grant is taken back without the consent of its holder.
    UnilateralRelease,
}

/// A small cell.
struct CellModel {
    programs: Vec<Program>,
    slots: usize,
    /// Messages under way per robot and direction.
    under_way: usize,
    guard_crashes: u8,
    arbiter_crashes: u8,
    clears: u8,
    planted: PlantedFault,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Action {
    /// The robot moves to the next place, and its guard observes it.
    Advance(usize),
    /// The guard observes its robot and sends a message.
    Send(usize),
    /// The arbiter takes a message, which may come again.
    ToArbiter(usize, usize),
    ToGuard(usize, usize),
    TimePasses,
    CrashGuard(usize),
    CrashArbiter,
    Clear(usize),
    TakeBack(usize),
}

impl CellModel {
    fn new(programs: &[&[&str]]) -> Self {
        let programs: Vec<_> = programs.iter().map(|words| Program::new(words)).collect();
        let slots = programs[0].slots();
        Self {
            programs,
            slots,
            under_way: 1,
            guard_crashes: 0,
            arbiter_crashes: 0,
            clears: 0,
            planted: PlantedFault::None,
        }
    }

    fn settings(&self) -> ArbiterSettings {
        let robot = |r: usize| {
            let slots = (0..self.slots).map(SlotId).filter(|s| self.programs[r].uses(*s));
            RobotSettings { stop_time: STEP, ..RobotSettings::new("robot", slots) }
        };
        let robots = (0..self.programs.len()).map(robot).collect();
        ArbiterSettings { validity: STEP, silence: STEP + STEP, ..ArbiterSettings::new(robots, self.slots) }
    }

    fn guard(&self, robot: usize, boot: u64) -> Guard {
        let endless = self.planted == PlantedFault::HastyClear;
        let validity = if endless { Micros(u64::MAX) } else { STEP };
        Guard::new(RobotSlot(robot), self.slots, 0, Boot(boot)).validity(validity)
    }

    /// Whether the robot may be commanded to its next place: what it enters it is granted.
    fn may_advance(&self, state: &CellState, robot: usize) -> bool {
        let (here, there) = (state.places[robot], self.programs[robot].next(state.places[robot]));
        (0..self.slots).map(SlotId).all(|slot| {
            let occupies = |place: usize| self.programs[robot].occupancy(place, slot).occupies();
            !occupies(there) || occupies(here) || state.guards[robot].may_enter(slot, NOW)
        })
    }

    fn observe(&self, state: &mut CellState, robot: usize) {
        for slot in (0..self.slots).map(SlotId) {
            state.guards[robot].observe(slot, self.programs[robot].occupancy(state.places[robot], slot));
        }
    }

    fn reply(&self, state: &mut CellState, replies: Vec<GrantsMessage>) {
        for reply in replies {
            self.push(&mut state.to_guard[reply.robot.0], reply);
        }
    }

    fn push<T>(&self, under_way: &mut Vec<T>, message: T) {
        if under_way.len() == self.under_way {
            under_way.remove(0);
        }
        under_way.push(message);
    }

    /// All robots are outside, and the arbiter knows them.
    fn know_each_other(&self, state: &mut CellState) {
        for r in (0..2).flat_map(|_| 0..self.programs.len()) {
            self.observe(state, r);
            let message = state.guards[r].state(NOW);
            for reply in state.arbiter.receive(&message, NOW).replies {
                let _ = state.guards[reply.robot.0].receive(&reply);
            }
        }
    }

    /// An integrator clears a robot that is at rest outside.
    fn clear(&self, state: &mut CellState, robot: usize) -> bool {
        let is_outside =
            (0..self.slots).all(|s| !self.programs[robot].occupancy(state.places[robot], SlotId(s)).occupies());
        if !is_outside || state.clears == 0 {
            return false;
        }
        state.clears -= 1;
        let outputs = if self.planted == PlantedFault::HastyClear {
            Ok(state.arbiter.clear_at_once(RobotSlot(robot), NOW))
        } else {
            state.arbiter.clear(RobotSlot(robot), NOW)
        };
        outputs.map(|outputs| self.reply(state, outputs.replies)).is_ok()
    }
}

impl Model for CellModel {
    type State = CellState;
    type Action = Action;

    fn init_states(&self) -> Vec<CellState> {
        let robots = self.programs.len();
        let mut state = CellState {
            arbiter: Arbiter::new(self.settings(), Boot(1)),
            guards: (0..robots).map(|r| self.guard(r, 1)).collect(),
            places: vec![0; robots],
            to_arbiter: vec![Vec::new(); robots],
            to_guard: vec![Vec::new(); robots],
            guard_crashes: self.guard_crashes,
            arbiter_crashes: self.arbiter_crashes,
            clears: self.clears,
            boots: 1,
        };
        self.know_each_other(&mut state);
        canonical::canonicalize(&mut state);
        vec![state]
    }

    fn actions(&self, state: &CellState, actions: &mut Vec<Action>) {
        for r in 0..self.programs.len() {
            actions.extend([Action::Advance(r), Action::Send(r)]);
            actions.extend((0..state.to_arbiter[r].len()).map(|i| Action::ToArbiter(r, i)));
            actions.extend((0..state.to_guard[r].len()).map(|i| Action::ToGuard(r, i)));
            if state.guard_crashes > 0 {
                actions.push(Action::CrashGuard(r));
            }
            if state.clears > 0 {
                actions.push(Action::Clear(r));
            }
        }
        actions.push(Action::TimePasses);
        if state.arbiter_crashes > 0 {
            actions.push(Action::CrashArbiter);
        }
        if self.planted == PlantedFault::UnilateralRelease {
            actions.extend((0..self.slots).map(Action::TakeBack));
        }
    }

    fn next_state(&self, before: &CellState, action: Action) -> Option<CellState> {
        let mut state = before.clone();
        match action {
            Action::Advance(r) => {
                if !self.may_advance(&state, r) {
                    return None;
                }
                state.places[r] = self.programs[r].next(state.places[r]);
                self.observe(&mut state, r);
            }
            Action::Send(r) => {
                self.observe(&mut state, r);
                let message = state.guards[r].state(NOW);
                self.push(&mut state.to_arbiter[r], message);
            }
            Action::ToArbiter(r, i) => {
                let mut message = state.to_arbiter[r][i].clone();
                if self.planted == PlantedFault::TokensUnchecked {
                    give_up_all(&mut message);
                }
                let outputs = state.arbiter.receive(&message, NOW);
                self.reply(&mut state, outputs.replies);
            }
            Action::ToGuard(r, i) => {
                let message = state.to_guard[r][i].clone();
                let _ = state.guards[r].receive(&message);
            }
            Action::TimePasses => canonical::pass(&mut state, STEP),
            Action::CrashGuard(r) => {
                state.boots += 1;
                state.guard_crashes -= 1;
                state.guards[r] = self.guard(r, state.boots);
            }
            Action::CrashArbiter => {
                state.boots += 1;
                state.arbiter_crashes -= 1;
                state.arbiter = Arbiter::new(self.settings(), Boot(state.boots));
            }
            Action::Clear(r) => {
                if !self.clear(&mut state, r) {
                    return None;
                }
            }
            Action::TakeBack(s) => state.arbiter.take_back(SlotId(s)),
        }
        canonical::canonicalize(&mut state);
        (state != *before).then_some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![Property::always("at most one robot is in a slot", |model: &Self, state: &CellState| {
            (0..model.slots).map(SlotId).all(|slot| {
                let occupancy = |r: usize| model.programs[r].occupancy(state.places[r], slot);
                (0..model.programs.len()).filter(|r| occupancy(*r) >= Occupancy::Committed).count() <= 1
            })
        })]
    }
}

/// A message that gives up every grant that it does not name.
fn give_up_all(message: &mut StateMessage) {
    let every = Token { boot: Boot(u64::MAX), number: u64::MAX };
    for slot in message.slots.iter_mut().filter(|slot| slot.token.is_none()) {
        slot.released = Some(every);
    }
}

/// Explores at most this many states; returns whether the property held, and the number of states.
fn explore(name: &str, model: CellModel, states: usize) -> bool {
    let states = std::env::var("ELBOWROOM_MODEL_STATES").ok().and_then(|n| n.parse().ok()).unwrap_or(states);
    let checker = model.checker().target_state_count(states).spawn_bfs().join();
    let counterexample = checker.discovery("at most one robot is in a slot");
    let complete = if checker.state_count() < states && counterexample.is_none() { "all" } else { "the first" };
    println!("{name}: {complete} {} states, depth {}", checker.unique_state_count(), checker.max_depth());
    if let Some(path) = &counterexample {
        println!("{name}: {:?}", path.clone().into_actions());
    }
    counterexample.is_none()
}

/// Two robots and one slot.
const PAIR: &[&[&str]] = &[&["_.X"], &["_.X"]];
/// Three robots that go through two slots in both directions, from one into the other.
const THREE: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"], &["_.X_", "___."]];

#[test]
fn two_robots_and_every_fault() {
    let model = CellModel { guard_crashes: 1, arbiter_crashes: 1, clears: 1, ..CellModel::new(PAIR) };
    assert!(explore("two robots, one slot, all faults", model, 150_000));
}

#[test]
fn three_robots_and_two_slots() {
    let model = CellModel { guard_crashes: 1, arbiter_crashes: 1, clears: 1, ..CellModel::new(THREE) };
    assert!(explore("three robots, two slots, all faults", model, 100_000));
}

#[test]
fn planted_faults_are_found() {
    for planted in [PlantedFault::HastyClear, PlantedFault::TokensUnchecked, PlantedFault::UnilateralRelease] {
        let model = CellModel { clears: 1, planted, ..CellModel::new(PAIR) };
        assert!(!explore(&format!("{planted:?}"), model, 2_000_000), "{planted:?} is not noticed");
    }
}
