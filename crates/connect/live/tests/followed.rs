//! Region on another robot whose joint values arrive late or without velocities.

use std::sync::Arc;

use crate::common::two_rails;
use elbowroom_cell::configure;
use elbowroom_interlock::{Boot, Micros};
use elbowroom_live::node::{NodeMonitor, NodeTick};
use elbowroom_live::{ControllerClient, ControllerState, configuration_number};
use elbowroom_monitor::RobotSlot;
use elbowroom_robot::RobotId;

const TICK_S: f64 = 0.004;
/// Number of ticks until the answer that counts: too few for unchanged values to be doubted.
const TICKS: usize = 18;
/// Speed of the carrier towards the other robot, m/s.
const SPEED: f64 = 0.5;

/// A region on the hand of the right robot, where the left one moves.
const MORE: &str = r#"[monitor]
stopping_distance = true
direction_aware = true
stale_ms = 100
[region.hand]
shape = "sphere"
centre = [-900, 0, 0]
radius = 200
warning = 100
robots = ["left"]
follow = { robot = "right", frame = "flange" }
"#;

/// Returns the override of the left robot, which is at 0.5 m, while the region on the other robot approaches from above
/// with a true distance of `gap_m`. The received values are `delay` ticks old, except at the beginning.
fn override_at(gap_m: f64, delay: usize, with_velocities: bool, program: f64) -> f64 {
    let cell = Arc::new(two_rails(MORE));
    let checksum = configuration_number(&cell);
    let setup = configure::setups(&cell).expect("setups").remove(0);
    let monitor = NodeMonitor::new(&setup, RobotSlot(0), 0, checksum, Boot(1)).expect("a monitor");
    let mut node = NodeTick::new(cell, setup, monitor, checksum, None);
    let (mut left, mut right) = (ControllerClient::new(1, checksum), ControllerClient::new(1, checksum));
    let time = |tick: usize| Micros(1 + (tick as f64 * TICK_S * 1e6) as u64);
    let mut messages = Vec::new();
    let mut answer = 0.0;
    for tick in 0..TICKS {
        let ahead_s = (TICKS - 1 - tick) as f64 * TICK_S;
        let (q, qd) = ([0.5 + 0.25 + gap_m + SPEED * ahead_s], [-SPEED]);
        let qd = if with_velocities { &qd[..] } else { &[] };
        let state = ControllerState { q: &q, qd, programmed_override: 1.0, ..ControllerState::default() };
        messages.push(right.joint_state(time(tick), &state).to_vec());
        // The first messages show how long messages take.
        let heard = if tick < 3 { Some(tick) } else { tick.checked_sub(delay).filter(|heard| *heard >= 3) };
        if let Some(heard) = heard {
            node.followed_joint_state(RobotId(1), &messages[heard], time(tick));
        }
        let state = ControllerState {
            q: &[0.5],
            qd: &[0.0],
            intent: &[program],
            programmed_override: 1.0,
            ..ControllerState::default()
        };
        node.joint_state(left.joint_state(time(tick), &state), time(tick));
        node.tick(time(tick));
        if let Some(given) = node.take_answer() {
            let mut bytes = Vec::new();
            given.encode(&mut bytes);
            left.receive(&bytes).expect("an answer to this controller");
            answer = given.speed_override;
        }
    }
    answer
}

#[test]
fn what_is_heard_late_lets_nobody_go_faster() {
    let mut limited = 0;
    for k in 1..80 {
        let gap_m = 0.01 * f64::from(k);
        let fresh = override_at(gap_m, 0, true, 0.6);
        for delay in [1, 4, 10] {
            let late = override_at(gap_m, delay, true, 0.6);
            // The warning zone uses the former place of the region: within the zone, the zone's law alone may permit more.
            if gap_m > 0.1 + SPEED * TICK_S * delay as f64 {
                // Less the possible drift of the clocks.
                assert!(late <= fresh + 2e-3, "{gap_m} m, {delay} ticks late: {late} instead of {fresh}");
                limited += i32::from(fresh > 0.0 && fresh < 0.99);
            }
        }
    }
    assert!(limited > 20, "{limited}");
}

#[test]
fn a_carrier_without_velocities_is_not_taken_to_stand() {
    for k in 1..80 {
        let gap_m = 0.01 * f64::from(k);
        let (given, derived) = (override_at(gap_m, 0, true, 0.6), override_at(gap_m, 0, false, 0.6));
        assert!((given - derived).abs() < 1e-3, "{gap_m} m: {derived} instead of {given}");
    }
    // Inside a moving region no robot starts to leave.
    assert_eq!(override_at(-0.1, 0, false, -0.6), 0.0);
}
