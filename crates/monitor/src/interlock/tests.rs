//! The board's own rules, one at a time.

use super::*;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

const A: SlotId = SlotId(0);
const B: SlotId = SlotId(1);
const LEFT: RobotSlot = RobotSlot(0);
const RIGHT: RobotSlot = RobotSlot(1);

fn board() -> Board {
    let board = Board::new(&["left", "right"], &["a", "b"]);
    for slot in [A, B] {
        for robot in [LEFT, RIGHT] {
            board.expect(slot, robot);
            board.publish(slot, robot, Stay::Outside, 0.0);
        }
    }
    board
}

#[test]
fn first_come_first_served_and_given_back_when_outside() {
    let b = board();
    b.publish(A, LEFT, Stay::Warning, 0.0);
    b.publish(A, RIGHT, Stay::Warning, 0.0);
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Held);
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Waiting(RIGHT));
    b.publish(A, RIGHT, Stay::Outside, 0.05);
    assert_eq!(b.request(A, LEFT, 0.05), Grant::Held);
}

#[test]
fn a_robot_that_vanishes_inside_keeps_the_slot_until_cleared() {
    let b = board();
    b.publish(A, LEFT, Stay::Inside, 0.0);
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Held);
    for t in 1..1000 {
        b.publish(A, RIGHT, Stay::Warning, f64::from(t));
        assert_eq!(b.request(A, RIGHT, f64::from(t)), Grant::Waiting(LEFT));
    }
    assert!(!b.clear(A, LEFT, AccessClass::Programmer, 1000.0));
    assert!(b.clear(A, LEFT, AccessClass::Integrator, 1000.0));
    assert_eq!(b.request(A, RIGHT, 1000.0), Grant::Held);
}

#[test]
fn a_robot_that_falls_silent_is_unknown_until_it_speaks_or_is_cleared() {
    let b = board();
    b.publish(A, RIGHT, Stay::Warning, 5.0);
    assert_eq!(b.request(A, RIGHT, 5.0), Grant::Unknown(LEFT));
    b.publish(A, LEFT, Stay::Outside, 5.0);
    assert_eq!(b.request(A, RIGHT, 5.05), Grant::Held);
    b.publish(A, RIGHT, Stay::Outside, 6.0);
    b.publish(A, RIGHT, Stay::Warning, 9.0);
    assert_eq!(b.request(A, RIGHT, 9.0), Grant::Unknown(LEFT));
    assert!(b.clear(A, LEFT, AccessClass::Integrator, 9.0));
    assert_eq!(b.request(A, RIGHT, 12.0), Grant::Held);
}

#[test]
fn a_circle_of_robots_in_warning_zones_is_opened_by_one_that_yields() {
    let b = board();
    for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
        b.publish(slot, robot, Stay::Warning, 0.0);
        assert_eq!(b.request(slot, robot, 0.0), Grant::Held);
    }
    b.publish(B, LEFT, Stay::Warning, 0.0);
    b.publish(A, RIGHT, Stay::Warning, 0.0);
    b.request(B, LEFT, 0.0);
    b.request(A, RIGHT, 0.0);
    b.request(B, LEFT, 0.0);
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Held, "left yields, right goes on");
}

#[test]
fn a_circle_of_robots_inside_is_reported() {
    let b = board();
    for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
        b.publish(slot, robot, Stay::Inside, 0.0);
        assert_eq!(b.request(slot, robot, 0.0), Grant::Held);
    }
    b.publish(B, LEFT, Stay::Warning, 0.0);
    b.publish(A, RIGHT, Stay::Warning, 0.0);
    b.request(B, LEFT, 0.0);
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Deadlock);
}

#[test]
fn nobody_is_granted_a_slot_that_another_robot_cannot_stop_before() {
    let b = board();
    b.publish(A, LEFT, Stay::Committed, 0.0);
    b.publish(A, RIGHT, Stay::Warning, 0.0);
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Waiting(LEFT));
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Held, "who cannot stop comes first, whoever asked first");
}

#[test]
fn a_robot_that_cannot_stop_does_not_yield() {
    let b = board();
    for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
        b.publish(slot, robot, Stay::Warning, 0.0);
        assert_eq!(b.request(slot, robot, 0.0), Grant::Held);
        b.publish(slot, robot, Stay::Committed, 0.0);
    }
    b.publish(B, LEFT, Stay::Warning, 0.0);
    b.publish(A, RIGHT, Stay::Warning, 0.0);
    for _ in 0..3 {
        assert_eq!(b.request(B, LEFT, 0.0), Grant::Waiting(RIGHT));
        assert_eq!(b.request(A, RIGHT, 0.0), Grant::Waiting(LEFT));
    }
    b.publish(A, LEFT, Stay::Warning, 0.0);
    b.request(B, LEFT, 0.0);
    assert_eq!(b.holder(A), None, "left can stop now, and yields");
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Held);
}

#[test]
fn a_holder_that_can_stop_gives_way_to_a_robot_that_got_in_without_the_slot() {
    let b = board();
    b.publish(A, LEFT, Stay::Warning, 0.0);
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Held);
    b.publish(A, RIGHT, Stay::Inside, 0.0);
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Waiting(RIGHT));
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Held);
}

#[test]
fn a_robot_that_speaks_is_not_cleared() {
    let b = board();
    b.publish(A, LEFT, Stay::Warning, 0.0);
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Held);
    assert!(!b.clear(A, LEFT, AccessClass::Integrator, 0.05));
    assert_eq!(b.holder(A), Some(LEFT));
}

#[test]
fn a_circle_is_told_with_the_slots_that_its_robots_wait_for() {
    let b = board();
    for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
        b.publish(slot, robot, Stay::Inside, 0.0);
        b.request(slot, robot, 0.0);
    }
    b.publish(B, LEFT, Stay::Warning, 0.0);
    b.request(B, LEFT, 0.0);
    assert!(b.circle(LEFT, 0.0).is_empty(), "right waits for nothing yet");
    b.publish(A, RIGHT, Stay::Warning, 0.0);
    b.request(A, RIGHT, 0.0);
    assert_eq!(b.circle(LEFT, 0.0), [(LEFT, B), (RIGHT, A)]);
    // Right falls silent: it may speak again, so nobody calls it a deadlock.
    b.publish(A, LEFT, Stay::Inside, 5.0);
    b.publish(B, LEFT, Stay::Warning, 5.0);
    assert!(b.circle(LEFT, 5.0).is_empty());
}

#[test]
fn two_robots_inside_one_region_wait_for_each_other() {
    let b = board();
    b.publish(A, LEFT, Stay::Inside, 0.0);
    b.publish(A, RIGHT, Stay::Inside, 0.0);
    b.request(A, LEFT, 0.0);
    assert_eq!(b.request(A, RIGHT, 0.0), Grant::Deadlock);
    assert_eq!(b.request(A, LEFT, 0.0), Grant::Deadlock);
    assert_eq!(b.circle(RIGHT, 0.0), [(LEFT, A), (RIGHT, A)]);
}

#[test]
fn threads_racing_for_a_slot_are_never_both_inside() {
    let board = Arc::new(board());
    let inside = Arc::new(AtomicUsize::new(0));
    let run = |robot: RobotSlot| {
        let (board, inside) = (board.clone(), inside.clone());
        std::thread::spawn(move || {
            let mut entered = 0;
            while entered < 2000 {
                board.publish(A, robot, Stay::Warning, 0.0);
                if board.request(A, robot, 0.0) == Grant::Held {
                    board.publish(A, robot, Stay::Inside, 0.0);
                    assert_eq!(inside.fetch_add(1, SeqCst), 0);
                    std::hint::spin_loop();
                    inside.fetch_sub(1, SeqCst);
                    entered += 1;
                    board.publish(A, robot, Stay::Outside, 0.0);
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
