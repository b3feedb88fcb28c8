//! The cells that the model check explores. For most cells, the suite explores only the first states.
//!
//! `ELBOWROOM_MODEL_STATES` sets another number of states, `ELBOWROOM_MODEL_SECONDS` a time, `ELBOWROOM_MODEL_CELL`
//! the only cell.

use std::time::{Duration, Instant};

use stateright::{Checker, Model};

use super::state::FaultBudget;
use super::{CellModel, Clock, EXCLUSION, PlantedFault};

/// Two robots and one slot.
const PAIR: &[&[&str]] = &[&["_.X"], &["_.X"]];
/// Two robots that enter so fast that no tick finds them near.
const FROM_BEYOND: &[&[&str]] = &[&["._X"], &["._X"]];
/// Three robots and one slot.
const THREE: &[&[&str]] = &[&["_.X"], &["_.X"], &["_.X"]];
/// Two robots that pass through two slots in opposite directions, from one slot into the other.
const CROSSING: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"]];
/// The robots of `CROSSING`, and a third robot in one of the slots.
const CROSSING_AND_ONE: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"], &["_.X_", "____"]];

/// The result of an exploration.
#[derive(Debug)]
struct Explored {
    holds: bool,
    /// True if all reachable states were explored.
    is_complete: bool,
    states: usize,
}

/// A whole number from an environment variable.
fn setting(name: &str) -> Option<usize> {
    std::env::var(name).ok()?.parse().ok()
}

/// Explores until about this many states were generated.
fn explore(name: &str, model: CellModel, states: usize) -> Explored {
    let limit = setting("ELBOWROOM_MODEL_STATES").unwrap_or(states);
    let time = Duration::from_secs(setting("ELBOWROOM_MODEL_SECONDS").unwrap_or(3_600) as u64);
    let started = Instant::now();
    let checker = model.checker().target_state_count(limit).timeout(time).spawn_bfs().join();
    let counterexample = checker.discovery(EXCLUSION);
    let explored = Explored {
        holds: counterexample.is_none(),
        is_complete: checker.state_count() < limit && started.elapsed() < time && counterexample.is_none(),
        states: checker.unique_state_count(),
    };
    let part = if explored.is_complete { "all" } else { "the first" };
    let seconds = started.elapsed().as_secs();
    println!("{name}: {part} {} states, depth {}, {seconds} s", explored.states, checker.max_depth());
    if let Some(path) = counterexample {
        println!("{name}: {:?}", path.into_actions());
    }
    explored
}

/// A cell, and the number of its states that the suite explores.
struct Check {
    name: &'static str,
    model: CellModel,
    states: usize,
    /// True if these are all states of the cell.
    is_complete: bool,
}

/// A check of the first states of a cell that has more.
fn first(name: &'static str, model: CellModel) -> Check {
    Check { name, model, states: 30_000, is_complete: false }
}

fn with(guard_crashes: u8, arbiter_crashes: u8, clears: u8, programs: &[&[&str]]) -> CellModel {
    CellModel { faults: FaultBudget { guard_crashes, arbiter_crashes, clears }, ..CellModel::new(programs) }
}

fn checks() -> Vec<Check> {
    let fine = CellModel { clock: Clock::Fine, ..CellModel::new(PAIR) };
    let overtaking = CellModel { under_way: 2, ..CellModel::new(PAIR) };
    let all = usize::MAX;
    vec![
        Check { name: "pair", model: CellModel::new(PAIR), states: all, is_complete: true },
        Check { name: "pair from beyond", model: CellModel::new(FROM_BEYOND), states: all, is_complete: true },
        first("pair, guard", with(1, 0, 0, PAIR)),
        first("pair, arbiter", with(0, 1, 0, PAIR)),
        first("pair, clear", with(0, 0, 1, PAIR)),
        first("pair, guard and arbiter", with(1, 1, 0, PAIR)),
        first("pair, guard and clear", with(1, 0, 1, PAIR)),
        first("pair, arbiter and clear", with(0, 1, 1, PAIR)),
        first("pair, every fault", with(1, 1, 1, PAIR)),
        first("pair, fine clock", fine),
        first("pair, overtaking", overtaking),
        first("three", CellModel::new(THREE)),
        first("three, arbiter", with(0, 1, 0, THREE)),
        first("three, every fault", with(1, 1, 1, THREE)),
        first("crossing", CellModel::new(CROSSING)),
        first("crossing, arbiter", with(0, 1, 0, CROSSING)),
        first("crossing, every fault", with(1, 1, 1, CROSSING)),
        first("crossing and one", CellModel::new(CROSSING_AND_ONE)),
        first("crossing and one, every fault", with(1, 1, 1, CROSSING_AND_ONE)),
    ]
}

#[test]
fn no_slot_is_ever_shared() {
    let only = std::env::var("ELBOWROOM_MODEL_CELL").ok();
    for Check { name, model, states, is_complete } in checks() {
        if only.as_deref().is_none_or(|only| only == name) {
            let explored = explore(name, model, states);
            assert!(explored.holds, "{name}: {EXCLUSION} is wrong");
            assert!(explored.is_complete || !is_complete, "{name}: {explored:?}");
        }
    }
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
