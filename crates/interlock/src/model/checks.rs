//! What the model check explores. `ELBOWROOM_MODEL_STATES` sets how many states; the default keeps the suite short.

use stateright::{Checker, Model};

use super::state::FaultBudget;
use super::{CellModel, Clock, PlantedFault};

pub(super) const EXCLUSION: &str = "at most one robot is in a slot or may enter it";

/// One guard and the arbiter crash once, one robot is cleared.
const EVERY_FAULT: FaultBudget = FaultBudget { guard_crashes: 1, arbiter_crashes: 1, clears: 1 };

/// Two robots and one slot.
const PAIR: &[&[&str]] = &[&["_.X"], &["_.X"]];
/// Two robots that enter so fast that no tick finds them near.
const FROM_BEYOND: &[&[&str]] = &[&["._X"], &["._X"]];
/// Three robots and one slot.
const THREE: &[&[&str]] = &[&["_.X"], &["_.X"], &["_.X"]];
/// Two robots that go through two slots in both directions, from one into the other.
const CROSSING: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"]];
/// The same, and a third one in one of them.
const CROSSING_AND_ONE: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"], &["_.X_", "____"]];

/// What an exploration has shown.
#[derive(Debug)]
struct Explored {
    holds: bool,
    /// All states that can be reached were explored.
    is_complete: bool,
    states: usize,
}

/// Explores at most about this many states.
fn explore(name: &str, model: CellModel, states: usize) -> Explored {
    let limit = std::env::var("ELBOWROOM_MODEL_STATES").ok().and_then(|n| n.parse().ok()).unwrap_or(states);
    let checker = model.checker().target_state_count(limit).spawn_bfs().join();
    let counterexample = checker.discovery(EXCLUSION);
    let explored = Explored {
        holds: counterexample.is_none(),
        is_complete: checker.state_count() < limit && counterexample.is_none(),
        states: checker.unique_state_count(),
    };
    let part = if explored.is_complete { "all" } else { "the first" };
    println!("{name}: {part} {} states, depth {}", explored.states, checker.max_depth());
    if let Some(path) = counterexample {
        println!("{name}: {:?}", path.into_actions());
    }
    explored
}

/// Explores a cell; the property must hold.
fn check(name: &str, model: CellModel, states: usize) -> Explored {
    let explored = explore(name, model, states);
    assert!(explored.holds, "{name}: {EXCLUSION} is wrong");
    explored
}

#[test]
fn two_robots_and_one_slot() {
    let model = CellModel { faults: EVERY_FAULT, ..CellModel::new(PAIR) };
    check("two robots, one slot, every fault", model, 2_000_000);
}

#[test]
fn two_robots_and_one_slot_with_a_fine_clock() {
    let model = CellModel { clock: Clock::Fine, ..CellModel::new(PAIR) };
    check("two robots, one slot, fine clock, no crash", model, 2_000_000);
}

#[test]
fn two_robots_and_messages_that_overtake() {
    let model = CellModel { under_way: 2, ..CellModel::new(PAIR) };
    check("two robots, one slot, two messages under way, no crash", model, 2_000_000);
}

#[test]
fn three_robots_and_one_slot() {
    let model = CellModel { faults: EVERY_FAULT, ..CellModel::new(THREE) };
    check("three robots, one slot, every fault", model, 300_000);
}

#[test]
fn two_robots_and_two_slots() {
    let model = CellModel { faults: EVERY_FAULT, ..CellModel::new(CROSSING) };
    check("two robots, two slots, every fault", model, 300_000);
}

#[test]
fn three_robots_and_two_slots() {
    let model = CellModel { faults: EVERY_FAULT, ..CellModel::new(CROSSING_AND_ONE) };
    check("three robots, two slots, every fault", model, 200_000);
}

#[test]
fn planted_faults_are_found() {
    use PlantedFault::{HastyClear, TokensUnchecked, UnilateralRelease, UnseenRelease};
    for planted in [HastyClear, TokensUnchecked, UnilateralRelease, UnseenRelease] {
        let faults = FaultBudget { clears: 1, ..FaultBudget::default() };
        let cell = if planted == UnseenRelease { FROM_BEYOND } else { PAIR };
        let explored =
            explore(&format!("{planted:?}"), CellModel { faults, planted, ..CellModel::new(cell) }, 2_000_000);
        assert!(!explored.holds, "{planted:?} is not noticed");
    }
}

#[test]
fn size() {
    let model = CellModel::new(PAIR);
    drop(model);
    explore("pair", CellModel::new(PAIR), 20_000_000);
}
