//! Model check of the exchange protocol: every reachable state of small worlds, over the board's own code.
//!
//! A world is two or three robots on programs of a few places. Each place is outside, in the warning zone or inside of
//! each slot. A robot moves one place per tick at most and needs one more to stop: told to stop while it moves, it ends
//! one place farther on. What it does in a tick is what a monitor does: publish for all slots, ask for those it is
//! near, then go on only if it holds a slot or can still stop outside it. In any state any robot may be next; any may
//! also stand though it may go on, fall silent (its controller stops it), speak again, or be cleared by an integrator
//! who sees it outside. `docs/laws.md`, section 11, lists the properties and the numbers of states.

mod explore;
mod world;

use explore::{Graph, explore};
use world::{Faults, World};

use super::Planted;

/// Opposite ways through two regions that are passed without leaving both between.
const OPPOSITE: [&[&str]; 2] = [&["_.XXX.___", "___.XXX._"], &["___.XXX._", "_.XXX.___"]];
/// Each of three robots goes from its own region into the next one's.
const RING: [&[&str]; 3] =
    [&["_.XX.__", "__.XX._", "_______"], &["_______", "_.XX.__", "__.XX._"], &["__.XX._", "_______", "_.XX.__"]];
/// Three robots and one region.
const SHARED: [&[&str]; 3] = [&["_.XX._"], &["_.XX._"], &["_..X._"]];
/// A pipeline: all go through the same two regions in the same order; a third robot needs only the second.
const PIPELINE: [&[&str]; 3] = [&["_.XX.__", "__.XX._"], &["_.XX.__", "__.XX._"], &["_______", "__.XX._"]];
/// Two robots and three regions, one after the other and back.
const CHAIN: [&[&str]; 2] = [&["_.X._____", "__.XX.___", "____.XX._"], &["____.XX._", "__.XX.___", "_.X._____"]];
/// As `OPPOSITE`, with wide warning zones: both wait while they move, outside of what they hold.
const WIDE: [&[&str]; 2] = [&["_...XX.__", "__...XX._"], &["__...XX._", "_...XX.__"]];
/// Three robots and one region that is switched on at any time, also over two or three of them.
const SWITCHED: [&[&str]; 3] = [&["_.XX._"], &["_.XX._"], &["_.XX._"]];

fn world(programs: &[&[&str]]) -> World {
    World::new(programs)
}

fn explored(world: &World) -> Graph {
    explore(world).unwrap_or_else(|broken| panic!("{broken}"))
}

/// All properties of a world in which every robot declares what it needs.
fn holds_for(name: &str, world: &World) {
    let graph = explored(world);
    println!("{name}: {} states, {} steps", graph.states.len(), graph.steps());
    let (stuck, first) = graph.stuck_states(world);
    assert_eq!(stuck, 0, "{name}: not all robots can finish from {first}");
}

#[test]
fn two_robots_that_declare_are_never_both_inside_and_always_able_to_finish() {
    holds_for("opposite", &world(&OPPOSITE).declared().faults(Faults::All));
    holds_for("chain", &world(&CHAIN).declared().faults(Faults::All));
    holds_for("wide", &world(&WIDE).declared().faults(Faults::All));
}

#[test]
fn three_robots_that_declare_are_never_two_inside_and_always_able_to_finish() {
    holds_for("ring", &world(&RING).declared().faults(Faults::First));
    holds_for("shared", &world(&SHARED).declared().faults(Faults::First));
    holds_for("pipeline", &world(&PIPELINE).declared().faults(Faults::First));
}

#[test]
fn nobody_gets_in_while_a_silent_robot_may_be_moved_by_hand() {
    for (name, programs) in [("shared", &SHARED[..]), ("ring", &RING)] {
        let graph = explored(&world(programs).declared().faults(Faults::First).jogged());
        println!("{name}, moved by hand: {} states, {} steps", graph.states.len(), graph.steps());
    }
}

#[test]
fn robots_whose_braking_is_not_known_give_back_at_rest_only() {
    holds_for("shared, braking unknown", &world(&SHARED).declared().faults(Faults::First).braking_unknown());
    holds_for("wide, braking unknown", &world(&WIDE).declared().faults(Faults::All).braking_unknown());
    holds_for("opposite, braking unknown", &world(&OPPOSITE).declared().faults(Faults::All).braking_unknown());
}

/// Steps of different robots between publishing and asking, one atomic operation of the board each.
#[test]
fn operations_of_two_robots_may_interleave() {
    holds_for("opposite, interleaved", &world(&OPPOSITE).declared().interleaved());
    holds_for("wide, interleaved", &world(&WIDE).declared().interleaved());
    holds_for("chain, interleaved", &world(&CHAIN).declared().interleaved());
}

#[test]
fn every_deadlock_of_robots_that_declare_nothing_is_detected() {
    for (name, world) in
        [("ring", world(&RING)), ("opposite", world(&OPPOSITE)), ("chain", world(&CHAIN)), ("wide", world(&WIDE))]
    {
        let graph = explored(&world);
        let (dead, silent) = graph.deadlocks(&world);
        println!("{name}, undeclared: {} states, {dead} deadlocked", graph.states.len());
        assert_eq!(silent, 0, "{name}: deadlocks that no circle tells");
    }
    // A region that is switched on over two robots: nobody enters, and who cannot leave is told of.
    let switched = world(&SWITCHED).switched().faults(Faults::First);
    println!("switched: {} states", explored(&switched).states.len());
    assert_eq!(explored(&world(&SWITCHED).switched()).deadlocks(&switched).1, 0, "two inside, and no word");
    let ring = world(&RING);
    assert!(explored(&ring).deadlocks(&ring).0 > 0, "the ring never closed: the order is not what prevents it");
}

#[test]
fn nobody_waits_for_ever() {
    for (name, programs) in [("opposite", &OPPOSITE[..]), ("ring", &RING), ("shared", &SHARED), ("pipeline", &PIPELINE)]
    {
        let world = world(programs).declared().repeating();
        let graph = explored(&world);
        println!("{name}, repeating: {} states", graph.states.len());
        assert_eq!(graph.starving(&world), None, "{name}: a robot can wait for ever while all others go on");
    }
}

#[test]
fn planted_faults_are_found() {
    let caught = |name: &str, world: World| {
        let found = match explore(&world) {
            Err(broken) => Some(broken),
            Ok(graph) => {
                let (stuck, first) = graph.stuck_states(&world);
                (stuck > 0).then(|| format!("{stuck} states from which not all can finish: {first}"))
            }
        };
        println!("{name}: {found:?}");
        assert!(found.is_some(), "{name} was not found");
    };
    let jogged = world(&SHARED).declared().faults(Faults::First).jogged();
    // A robot that moves too fast to stop says only that it is in the warning zone.
    caught("commitment not said", world(&WIDE).commitment_unsaid());
    caught("grant while another is inside", world(&SWITCHED).switched().planted(Planted::GrantWhileOccupied));
    caught("old news believed", world(&SWITCHED).switched().planted(Planted::KeepsOldNews));
    caught("silence taken for absence", jogged.planted(Planted::SilenceIsAbsence));
    caught("yields while it cannot stop", world(&WIDE).planted(Planted::YieldsCommitted));
    caught("order not looked at", world(&RING).declared().planted(Planted::NoOrder));
    caught("queue not passed", world(&RING).declared().planted(Planted::StrictQueue));
    caught("order not looked at again", world(&OPPOSITE).declared().interleaved().planted(Planted::NoSecondLook));
}
