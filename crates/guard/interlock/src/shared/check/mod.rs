//! Model check of the exchange protocol: explores every reachable state of small models, with the arbiter's own
//! code.
//!
//! A model has two or three robots on programs of a few places. Each place is outside, in the warning zone or inside
//! of each slot. A robot moves by at most one place per tick and needs one more place to stop: if it is commanded to
//! stop while it moves, it stops one place farther on.
//!
//! A robot ticks as a monitor does: publish for all slots, request the slots that the robot is near, then
//! move only if the robot holds a slot or can still stop outside it. In any state any robot may be next. Any robot
//! may also rest although it may move, become silent (its controller stops it), publish again, or be cleared by an
//! integrator who sees it outside.
//!
//! `docs/laws.md`, section 11, lists the properties and the numbers of states.

mod explore;
mod model;

use explore::{StateGraph, explore};
use model::{Faults, ProtocolModel};

use super::shared_state::InjectedFault;

/// Two robots pass through two regions in opposite directions, and each stays in at least one of them in between.
const OPPOSITE: [&[&str]; 2] = [&["_.XXX.___", "___.XXX._"], &["___.XXX._", "_.XXX.___"]];
/// Each of three robots goes from its own region into the next robot's region.
const RING: [&[&str]; 3] =
    [&["_.XX.__", "__.XX._", "_______"], &["_______", "_.XX.__", "__.XX._"], &["__.XX._", "_______", "_.XX.__"]];
/// Three robots and one region.
const SHARED: [&[&str]; 3] = [&["_.XX._"], &["_.XX._"], &["_..X._"]];
/// Two robots go through the same two regions in the same order; a third robot needs only the second region.
const PIPELINE: [&[&str]; 3] = [&["_.XX.__", "__.XX._"], &["_.XX.__", "__.XX._"], &["_______", "__.XX._"]];
/// Two robots pass through two regions in opposite directions, and a third robot needs both at once.
const CROSSING: [&[&str]; 3] = [&["_.XX.__", "__.XX._"], &["__.XX._", "_.XX.__"], &["_.XX.__", "_.XX.__"]];
/// Two robots and three regions, one after the other and back.
const CHAIN: [&[&str]; 2] = [&["_.X._____", "__.XX.___", "____.XX._"], &["____.XX._", "__.XX.___", "_.X._____"]];
/// Like `OPPOSITE`, with wide warning zones: both robots wait while they move, outside the slots that they hold.
const WIDE: [&[&str]; 2] = [&["_...XX.__", "__...XX._"], &["__...XX._", "_...XX.__"]];
/// Three robots and one region that is switched on at any time, also while two or three robots are inside.
const SWITCHED: [&[&str]; 3] = [&["_.XX._"], &["_.XX._"], &["_.XX._"]];

fn model(programs: &[&[&str]]) -> ProtocolModel {
    ProtocolModel::new(programs)
}

fn explored(model: &ProtocolModel) -> StateGraph {
    explore(model).unwrap_or_else(|broken| panic!("{broken}"))
}

/// Checks all properties of a model in which every robot declares its needs.
fn holds_for(name: &str, model: &ProtocolModel) {
    let graph = explored(model);
    println!("{name}: {} states, {} steps", graph.states(), graph.steps());
    let (stuck, first) = graph.stuck_states(model);
    assert_eq!(stuck, 0, "{name}: not all robots can finish from {first}");
}

#[test]
fn two_robots_that_declare_are_never_both_inside_and_always_able_to_finish() {
    holds_for("opposite", &model(&OPPOSITE).declared().faults(Faults::All));
    holds_for("chain", &model(&CHAIN).declared().faults(Faults::All));
    holds_for("wide", &model(&WIDE).declared().faults(Faults::All));
}

#[test]
fn three_robots_that_declare_are_never_two_inside_and_always_able_to_finish() {
    holds_for("ring", &model(&RING).declared().faults(Faults::First));
    holds_for("shared", &model(&SHARED).declared().faults(Faults::First));
    holds_for("pipeline", &model(&PIPELINE).declared().faults(Faults::First));
    holds_for("crossing", &model(&CROSSING).declared().faults(Faults::First));
}

/// Minutes: only with `ELBOWROOM_MODEL_SECONDS`.
#[test]
fn three_robots_and_two_regions_with_all_faults() {
    if std::env::var_os("ELBOWROOM_MODEL_SECONDS").is_none() {
        return;
    }
    for (name, programs) in [("pipeline, all", &PIPELINE), ("crossing, all", &CROSSING)] {
        holds_for(name, &model(programs).declared().faults(Faults::All));
    }
}

#[test]
fn no_robot_enters_while_a_silent_robot_may_be_moved_by_hand() {
    for (name, programs) in [("shared", &SHARED[..]), ("ring", &RING)] {
        let graph = explored(&model(programs).declared().faults(Faults::First).joggable());
        println!("{name}, moved by hand: {} states, {} steps", graph.states(), graph.steps());
    }
}

#[test]
fn robots_with_unknown_braking_release_at_rest_only() {
    holds_for("shared, braking unknown", &model(&SHARED).declared().faults(Faults::First).braking_unknown());
    holds_for("wide, braking unknown", &model(&WIDE).declared().faults(Faults::All).braking_unknown());
    holds_for("opposite, braking unknown", &model(&OPPOSITE).declared().faults(Faults::All).braking_unknown());
}

/// Steps of different robots between publication and request, one atomic operation of the arbiter each.
#[test]
fn operations_of_two_robots_may_interleave() {
    holds_for("opposite, interleaved", &model(&OPPOSITE).declared().interleaved());
    holds_for("wide, interleaved", &model(&WIDE).declared().interleaved());
    holds_for("chain, interleaved", &model(&CHAIN).declared().interleaved());
}

#[test]
fn every_deadlock_of_robots_without_declarations_is_detected() {
    for (name, model) in
        [("ring", model(&RING)), ("opposite", model(&OPPOSITE)), ("chain", model(&CHAIN)), ("wide", model(&WIDE))]
    {
        let graph = explored(&model);
        let (dead, unreported) = graph.deadlocks(&model);
        println!("{name}, undeclared: {} states, {dead} deadlocked", graph.states());
        assert_eq!(unreported, 0, "{name}: deadlocks without a reported cycle");
    }
    // A region is switched on while two robots are inside: no other robot enters, and the deadlock is reported.
    let switched = model(&SWITCHED).switchable().faults(Faults::First);
    println!("switched: {} states", explored(&switched).states());
    assert_eq!(explored(&model(&SWITCHED).switchable()).deadlocks(&switched).1, 0, "two inside, not reported");
    let ring = model(&RING);
    assert!(explored(&ring).deadlocks(&ring).0 > 0, "the ring has no deadlock: the safe order is not tested");
}

#[test]
fn no_robot_waits_for_ever() {
    for (name, programs) in [("opposite", &OPPOSITE[..]), ("ring", &RING), ("shared", &SHARED), ("pipeline", &PIPELINE)]
    {
        let model = model(programs).declared().repeating();
        let graph = explored(&model);
        println!("{name}, repeating: {} states", graph.states());
        assert_eq!(graph.starving(&model), None, "{name}: a robot can wait for ever while all others proceed");
    }
}

#[test]
fn injected_faults_are_detected() {
    let assert_detected = |name: &str, model: ProtocolModel| {
        let found = match explore(&model) {
            Err(broken) => Some(broken.to_string()),
            Ok(graph) => {
                let (stuck, first) = graph.stuck_states(&model);
                (stuck > 0).then(|| format!("{stuck} states from which not all can finish: {first}"))
            }
        };
        println!("{name}: {found:?}");
        assert!(found.is_some(), "{name} was not detected");
    };
    let joggable = model(&SHARED).declared().faults(Faults::First).joggable();
    // A robot that moves too fast to stop publishes only that it is in the warning zone.
    assert_detected("commitment not published", model(&WIDE).commitment_unpublished());
    assert_detected(
        "grant while another is inside",
        model(&SWITCHED).switchable().inject(InjectedFault::GrantWhileOccupied),
    );
    assert_detected("stale occupancy kept", model(&SWITCHED).switchable().inject(InjectedFault::KeepsStaleOccupancy));
    assert_detected("silence taken for absence", joggable.inject(InjectedFault::SilenceIsAbsence));
    assert_detected("yields while it cannot stop", model(&WIDE).inject(InjectedFault::YieldsCommitted));
    assert_detected("safe order not tested", model(&RING).declared().inject(InjectedFault::NoSafeOrder));
    assert_detected("queue not overtaken", model(&RING).declared().inject(InjectedFault::StrictQueue));
    assert_detected(
        "safe order not tested again",
        model(&OPPOSITE).declared().interleaved().inject(InjectedFault::NoSecondCheck),
    );
}
