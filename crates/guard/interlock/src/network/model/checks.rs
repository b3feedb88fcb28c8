//! The cells that the model check explores. For most cells, the suite explores only the first states.
//!
//! `ELBOWROOM_MODEL_STATES` sets another number of states, `ELBOWROOM_MODEL_SECONDS` a time, `ELBOWROOM_MODEL_CELL`
//! the only cell.

use std::time::{Duration, Instant};

use stateright::{Checker, Model};

use super::explorer::{self, Explored, Limits};
use super::state::FaultBudget;

/// A number of faults without limit.
pub(super) const ANY: u8 = FaultBudget::ANY;
use super::programs::Program;
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
pub(super) const CROSSING_AND_ONE: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"], &["_.X_", "____"]];

/// Two robots that pass through two slots in opposite directions, and a third one that enters both at once.
pub(super) const THREE_AND_TWO: &[&[&str]] = &[&["_.X.__", "__.XX."], &["__.XX.", "_.X.__"], &["_.X", "_.X"]];
/// Three robots in two slots, which come to rest before each, turn back, or pass from one into the other.
pub(super) const RESTING: &[&[&str]] = &[&["_.cX.c_", "__.cXX."], &["__.cXX.", "_.cX.c_"], &["_.cXc", "_..cX"]];
/// Two robots that stay in the warning zone or inside.
const FREE: &[&[&str]] = &[&[".X"], &[".X"]];
/// The robots of `FREE`, which also come to rest before the border, where they count as committed.
const FREE_RESTING: &[&[&str]] = &[&[".cX"], &[".cX"]];

/// A whole number from an environment variable.
pub(super) fn setting(name: &str) -> Option<usize> {
    std::env::var(name).ok()?.parse().ok()
}

/// Explores until about this many states were found.
fn explore(name: &str, model: &CellModel, states: usize) -> Explored {
    let states = setting("ELBOWROOM_MODEL_STATES").unwrap_or(states);
    let time = Duration::from_secs(setting("ELBOWROOM_MODEL_SECONDS").unwrap_or(3_600) as u64);
    let started = Instant::now();
    let explored = explorer::explore(model, Limits { states, time });
    let part = if explored.is_complete { "all" } else { "the first" };
    let seconds = started.elapsed().as_secs_f64();
    println!("{name}: {part} {} states, depth {}, {seconds:.1} s", explored.states, explored.depth);
    if let Some(path) = &explored.counterexample {
        println!("{name}: {path:?}");
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
    Check { name, model, states: 10_000, is_complete: false }
}

/// A check of fewer states of a cell, of which the others were explored before or take long.
fn few(name: &'static str, model: CellModel) -> Check {
    Check { states: 3_000, ..first(name, model) }
}

pub(super) fn with(guard_crashes: u8, arbiter_crashes: u8, clears: u8, programs: &[&[&str]]) -> CellModel {
    let faults = FaultBudget { guard_crashes, arbiter_crashes, clears, ..FaultBudget::default() };
    CellModel { faults, ..CellModel::new(programs) }
}

/// Two robots and a slot of any cell, with faults without limit.
fn free(guard_crashes: u8, arbiter_crashes: u8, clears: u8) -> CellModel {
    CellModel { is_free: true, ..with(guard_crashes, arbiter_crashes, clears, FREE) }
}

/// Like `free`, with robots that may be committed without a grant.
pub(super) fn free_resting(guard_crashes: u8, arbiter_crashes: u8, clears: u8) -> CellModel {
    let model = with(guard_crashes, arbiter_crashes, clears, FREE_RESTING);
    let programs = model.programs.into_iter().map(Program::in_any_order).collect();
    CellModel { is_free: true, programs, ..model }
}

impl CellModel {
    fn set_back(self) -> Self {
        Self { faults: FaultBudget { is_set_back: true, ..self.faults }, ..self }
    }

    fn two_arbiters(self) -> Self {
        Self { faults: FaultBudget { second_arbiters: 1, ..self.faults }, ..self }
    }
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
        Check { name: "any cell", model: free(0, 0, 0), states: all, is_complete: true },
        few("any cell, guards", free(ANY, 0, 0)),
        few("any cell, arbiter", free(0, ANY, 0)),
        few("any cell, clears", free(0, 0, ANY)),
        few("any cell, every fault", free(ANY, ANY, ANY)),
        few("any cell, guards set back", free(ANY, 0, 0).set_back()),
        few("any cell, arbiter set back", free(0, ANY, 0).set_back()),
        few("any cell, set back", free(ANY, ANY, ANY).set_back()),
        few("any cell, two arbiters", free(0, 0, 0).two_arbiters()),
        few("any cell, two arbiters, guards", free(ANY, 0, 0).two_arbiters()),
        few("any cell, two arbiters, crashes", free(ANY, ANY, 0).two_arbiters()),
        few("any cell, two arbiters, clears", free(0, 0, ANY).two_arbiters()),
        few("any cell, at rest", free_resting(0, 0, 0)),
        few("any cell, at rest, guards", free_resting(ANY, 0, 0)),
        few("any cell, at rest, arbiter", free_resting(0, ANY, 0)),
        few("any cell, at rest, clears", free_resting(0, 0, ANY)),
        few("any cell, at rest, every fault", free_resting(ANY, ANY, ANY)),
        first("crossing and one", CellModel::new(CROSSING_AND_ONE)),
        first("crossing and one, every fault", with(1, 1, 1, CROSSING_AND_ONE)),
    ]
}

#[test]
fn no_slot_is_ever_shared() {
    let only = std::env::var("ELBOWROOM_MODEL_CELL").ok();
    for Check { name, model, states, is_complete } in checks() {
        if only.as_deref().is_none_or(|only| only == name) {
            let explored = explore(name, &model, states);
            assert!(explored.counterexample.is_none(), "{name}: {EXCLUSION} is wrong");
            assert!(explored.is_complete || !is_complete, "{name}: {explored:?}");
        }
    }
}

#[test]
fn planted_faults_are_found() {
    use PlantedFault::{CommittedIsInside, HastyClear, TokensUnchecked, UnilateralRelease, UnseenRelease};
    let is_found = |planted: PlantedFault, name: &str, model: CellModel| {
        let explored = explore(&format!("{planted:?}, {name}"), &CellModel { planted, ..model }, 2_000_000);
        assert!(explored.counterexample.is_some(), "{planted:?} is not noticed: {name}");
    };
    is_found(CommittedIsInside, "any cell, at rest", free_resting(0, 1, 0));
    for planted in [HastyClear, TokensUnchecked, UnilateralRelease, UnseenRelease] {
        let cell = if planted == UnseenRelease { FROM_BEYOND } else { PAIR };
        let any = [("any cell", free(0, 0, 1)), ("any cell, at rest", free_resting(0, 0, 1))];
        for (name, model) in std::iter::once(("pair", with(0, 0, 1, cell))).chain(any) {
            is_found(planted, name, model);
        }
    }
}

/// Another checker, which compares whole states, finds the same states.
#[test]
fn as_many_states_as_by_another_checker() {
    for model in [CellModel::new(FROM_BEYOND), free(0, 0, 0)] {
        let states = explore("again", &model, usize::MAX).states;
        assert_eq!(model.checker().spawn_bfs().join().unique_state_count(), states);
    }
}
