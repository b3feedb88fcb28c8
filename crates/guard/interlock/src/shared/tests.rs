//! Tests of the arbiter's rules, one at a time.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};

use crate::{AccessClass, Grant, Occupancy, RobotSlot, SlotId, ZoneArbiter};

const A: SlotId = SlotId(0);
const B: SlotId = SlotId(1);
const LEFT: RobotSlot = RobotSlot(0);
const RIGHT: RobotSlot = RobotSlot(1);

fn arbiter() -> ZoneArbiter {
    let arbiter = ZoneArbiter::new(&["left", "right"], &["a", "b"]);
    for slot in [A, B] {
        for robot in [LEFT, RIGHT] {
            arbiter.register(slot, robot);
            arbiter.publish(slot, robot, Occupancy::Outside, 0.0);
        }
    }
    arbiter
}

/// An arbiter in which `LEFT` holds `A` and `RIGHT` holds `B`, both with this occupancy.
fn both_hold(occupancy: Occupancy) -> ZoneArbiter {
    let arbiter = arbiter();
    for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
        arbiter.publish(slot, robot, occupancy, 0.0);
        assert_eq!(arbiter.request(slot, robot, 0.0), Grant::Held);
    }
    arbiter
}

/// Puts each robot into the warning zone of the slot that the other one holds.
fn approach_each_other(arbiter: &ZoneArbiter) {
    arbiter.publish(B, LEFT, Occupancy::Warning, 0.0);
    arbiter.publish(A, RIGHT, Occupancy::Warning, 0.0);
}

#[test]
fn slots_are_granted_in_the_order_of_requests_and_released_outside() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Warning, 0.0);
    arbiter.publish(A, RIGHT, Occupancy::Warning, 0.0);
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Held);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Waiting(RIGHT));
    arbiter.publish(A, RIGHT, Occupancy::Outside, 0.05);
    assert_eq!(arbiter.request(A, LEFT, 0.05), Grant::Held);
}

#[test]
fn a_robot_that_becomes_silent_inside_keeps_the_slot_until_cleared() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Inside, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Held);
    for t in 1..1000 {
        arbiter.publish(A, RIGHT, Occupancy::Warning, f64::from(t));
        assert_eq!(arbiter.request(A, RIGHT, f64::from(t)), Grant::Waiting(LEFT));
    }
    assert!(!arbiter.clear(A, LEFT, AccessClass::Programmer, 1000.0));
    assert!(arbiter.clear(A, LEFT, AccessClass::Integrator, 1000.0));
    assert_eq!(arbiter.request(A, RIGHT, 1000.0), Grant::Held);
}

#[test]
fn a_silent_robot_is_unknown_until_it_publishes_or_is_cleared() {
    let arbiter = arbiter();
    arbiter.publish(A, RIGHT, Occupancy::Warning, 5.0);
    assert_eq!(arbiter.request(A, RIGHT, 5.0), Grant::Unknown(LEFT));
    arbiter.publish(A, LEFT, Occupancy::Outside, 5.0);
    assert_eq!(arbiter.request(A, RIGHT, 5.05), Grant::Held);
    arbiter.publish(A, RIGHT, Occupancy::Outside, 6.0);
    arbiter.publish(A, RIGHT, Occupancy::Warning, 9.0);
    assert_eq!(arbiter.request(A, RIGHT, 9.0), Grant::Unknown(LEFT));
    assert!(arbiter.clear(A, LEFT, AccessClass::Integrator, 9.0));
    assert_eq!(arbiter.request(A, RIGHT, 12.0), Grant::Held);
}

#[test]
fn a_cycle_of_robots_in_warning_zones_is_resolved_by_yielding() {
    let arbiter = both_hold(Occupancy::Warning);
    approach_each_other(&arbiter);
    arbiter.request(B, LEFT, 0.0);
    arbiter.request(A, RIGHT, 0.0);
    arbiter.request(B, LEFT, 0.0);
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Held, "left yields");
}

#[test]
fn a_cycle_of_robots_inside_is_reported() {
    let arbiter = both_hold(Occupancy::Inside);
    approach_each_other(&arbiter);
    arbiter.request(B, LEFT, 0.0);
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Deadlock);
}

#[test]
fn no_robot_is_granted_a_slot_that_another_cannot_stop_before() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Committed, 0.0);
    arbiter.publish(A, RIGHT, Occupancy::Warning, 0.0);
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Waiting(LEFT));
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Held, "a committed robot precedes older requests");
}

#[test]
fn a_robot_that_cannot_stop_does_not_yield() {
    let arbiter = both_hold(Occupancy::Warning);
    arbiter.publish(A, LEFT, Occupancy::Committed, 0.0);
    arbiter.publish(B, RIGHT, Occupancy::Committed, 0.0);
    approach_each_other(&arbiter);
    for _ in 0..3 {
        assert_eq!(arbiter.request(B, LEFT, 0.0), Grant::Waiting(RIGHT));
        assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Waiting(LEFT));
    }
    arbiter.publish(A, LEFT, Occupancy::Warning, 0.0);
    arbiter.request(B, LEFT, 0.0);
    assert_eq!(arbiter.holder(A), None, "left can stop now, and yields");
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Held);
}

#[test]
fn a_holder_that_can_stop_yields_to_a_robot_that_entered_without_the_slot() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Warning, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Held);
    arbiter.publish(A, RIGHT, Occupancy::Inside, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Waiting(RIGHT));
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Held);
}

/// A robot that grips a part inside a region, or starts there, is inside without the slot.
#[test]
fn a_holder_that_may_come_to_rest_inside_does_not_go_on_towards_a_robot_that_is_inside() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Committed, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Held);
    arbiter.publish(A, RIGHT, Occupancy::Inside, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Waiting(RIGHT));
    assert_eq!(arbiter.holder(A), Some(LEFT), "it may come to rest inside");
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Deadlock);
    arbiter.publish(A, RIGHT, Occupancy::Warning, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Held);
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Waiting(LEFT));
}

#[test]
fn a_robot_that_publishes_is_not_cleared() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Warning, 0.0);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Held);
    assert!(!arbiter.clear(A, LEFT, AccessClass::Integrator, 0.05));
    assert_eq!(arbiter.holder(A), Some(LEFT));
}

#[test]
fn a_cycle_is_reported_with_the_slots_that_its_robots_wait_for() {
    let arbiter = both_hold(Occupancy::Inside);
    arbiter.publish(B, LEFT, Occupancy::Warning, 0.0);
    arbiter.request(B, LEFT, 0.0);
    assert!(arbiter.wait_cycle(LEFT, 0.0).is_empty(), "right does not wait yet");
    arbiter.publish(A, RIGHT, Occupancy::Warning, 0.0);
    arbiter.request(A, RIGHT, 0.0);
    assert_eq!(arbiter.wait_cycle(LEFT, 0.0), [(LEFT, B), (RIGHT, A)]);
    // A silent robot may publish again: no deadlock is reported.
    arbiter.publish(A, LEFT, Occupancy::Inside, 5.0);
    arbiter.publish(B, LEFT, Occupancy::Warning, 5.0);
    assert!(arbiter.wait_cycle(LEFT, 5.0).is_empty());
}

#[test]
fn two_robots_inside_one_region_wait_for_each_other() {
    let arbiter = arbiter();
    arbiter.publish(A, LEFT, Occupancy::Inside, 0.0);
    arbiter.publish(A, RIGHT, Occupancy::Inside, 0.0);
    arbiter.request(A, LEFT, 0.0);
    assert_eq!(arbiter.request(A, RIGHT, 0.0), Grant::Deadlock);
    assert_eq!(arbiter.request(A, LEFT, 0.0), Grant::Deadlock);
    assert_eq!(arbiter.wait_cycle(RIGHT, 0.0), [(LEFT, A), (RIGHT, A)]);
}

#[test]
fn threads_racing_for_a_slot_are_never_both_inside() {
    let arbiter = Arc::new(arbiter());
    let inside = Arc::new(AtomicUsize::new(0));
    let run = |robot: RobotSlot| {
        let (arbiter, inside) = (arbiter.clone(), inside.clone());
        std::thread::spawn(move || {
            let mut entered = 0;
            while entered < 2000 {
                arbiter.publish(A, robot, Occupancy::Warning, 0.0);
                if arbiter.request(A, robot, 0.0) == Grant::Held {
                    arbiter.publish(A, robot, Occupancy::Inside, 0.0);
                    assert_eq!(inside.fetch_add(1, SeqCst), 0);
                    std::hint::spin_loop();
                    inside.fetch_sub(1, SeqCst);
                    entered += 1;
                    arbiter.publish(A, robot, Occupancy::Outside, 0.0);
                } else {
                    std::thread::yield_now();
                }
            }
        })
    };
    let threads = [run(LEFT), run(RIGHT)];
    for thread in threads {
        thread.join().unwrap();
    }
}
