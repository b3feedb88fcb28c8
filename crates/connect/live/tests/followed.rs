//! Region on another robot, on a measured encoder or on a measured object, whose values arrive late or without velocities.

use std::sync::Arc;

use crate::common::two_rails;
use elbowroom_cell::configure;
use elbowroom_interlock::{Boot, Micros};
use elbowroom_live::node::{NodeMonitor, NodeTick};
use elbowroom_live::{ControllerClient, ControllerState, configuration_number};
use elbowroom_monitor::{Fault, OverrideReason, RobotSlot, TickReport};
use elbowroom_robot::RobotId;
use elbowroom_testkit::random::SplitMix;

const TICK_S: f64 = 0.004;
/// Number of ticks until the answer that counts: too few for unchanged values to be doubted.
const TICKS: usize = 18;
/// Speed of the carrier towards the other robot, m/s.
const SPEED: f64 = 0.5;

/// What the region follows, on the way of the left robot.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Carrier {
    Robot,
    Encoder,
    Object,
    /// An object that the measured encoder carries.
    OnBelt,
}

const MEASURED: [Carrier; 3] = [Carrier::Encoder, Carrier::Object, Carrier::OnBelt];

impl Carrier {
    /// The tables of the cell file: a region whose centre is as far above the left robot's base as the carrier has travelled.
    fn tables(self) -> String {
        let (centre, follow) = match self {
            Self::Robot => ("[-900, 0, 0]", "{ robot = \"right\", frame = \"flange\" }"),
            Self::Encoder => ("[0, 0, 0]", "{ encoder = \"belt\" }"),
            Self::Object => ("[-3000, 0, 0]", "{ object = \"thing\" }"),
            Self::OnBelt => ("[-3000, 0, 0]", "{ object = \"parcel\" }"),
        };
        format!(
            r#"
[monitor]
stopping_distance = true
direction_aware = true
stale_ms = 100
[encoder.belt]
direction = [0, 0, 1]
speed = 0
measured = true
[object.parcel]
shape = "box"
size = [100, 100, 100]
at = [3000, 0, 0]
follow = {{ encoder = "belt" }}
[object.thing]
shape = "box"
size = [100, 100, 100]
at = [3000, 5000, 0]
measured = true
[region.hand]
shape = "sphere"
centre = {centre}
radius = 200
warning = 100
robots = ["left"]
follow = {follow}
"#
        )
    }

    /// The bytes that its controller sends.
    fn message(self, client: &mut ControllerClient, now: Micros, z: f64, with_velocity: bool) -> Vec<u8> {
        let of_object = [3.0, 0.0, z, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -SPEED, 0.0, 0.0, 0.0];
        let (q, qd): (&[f64], &[f64]) = match self {
            Self::Object => (&of_object[..if with_velocity { 13 } else { 7 }], &[]),
            _ => (&[z], if with_velocity { &[-SPEED] } else { &[] }),
        };
        let state = ControllerState { q, qd, programmed_override: 1.0, ..ControllerState::default() };
        client.joint_state(now, &state).to_vec()
    }

    fn hear(self, node: &NodeTick, bytes: &[u8], now: Micros) {
        match self {
            Self::Robot => node.followed_joint_state(RobotId(1), bytes, now),
            Self::Encoder | Self::OnBelt => node.measured(0, bytes, now),
            Self::Object => node.measured(1, bytes, now),
        }
    }
}

/// The left robot's node and controller.
struct Left {
    checksum: u64,
    node: NodeTick,
    client: ControllerClient,
}

impl Left {
    fn new(tables: &str) -> Self {
        let cell = Arc::new(two_rails(tables));
        let checksum = configuration_number(&cell);
        let setup = configure::setups(&cell).expect("setups").remove(0);
        let monitor = NodeMonitor::new(&setup, RobotSlot(0), 0, checksum, Boot(1)).expect("a monitor");
        let node = NodeTick::new(cell, setup, monitor, checksum, None);
        Self { checksum, node, client: ControllerClient::new(1, checksum) }
    }

    /// Sends a joint state of a robot at rest whose program wants this velocity, and hears the answer.
    fn tick(&mut self, sent: Micros, arrived: Micros, q: f64, program: f64) -> TickReport {
        let state = ControllerState {
            q: &[q],
            qd: &[0.0],
            intent: &[program],
            programmed_override: 1.0,
            ..ControllerState::default()
        };
        self.node.joint_state(self.client.joint_state(sent, &state), arrived);
        let report = self.node.tick(arrived).expect("a report");
        let mut bytes = Vec::new();
        self.node.take_answer().expect("an answer").encode(&mut bytes);
        self.client.receive(&bytes).expect("an answer to this controller");
        report
    }
}

/// Returns the override of the left robot, which is at 0.5 m, while the region on the carrier approaches from above
/// with a true distance of `gap_m`. The received values are `delay` ticks old, except at the beginning.
fn override_at(carrier: Carrier, gap_m: f64, delay: usize, with_velocities: bool, program: f64) -> f64 {
    let mut left = Left::new(&carrier.tables());
    let mut right = ControllerClient::new(1, left.checksum);
    let time = |tick: usize| Micros(1 + (tick as f64 * TICK_S * 1e6) as u64);
    let mut messages = Vec::new();
    let mut answer = 0.0;
    for tick in 0..TICKS {
        let ahead_s = (TICKS - 1 - tick) as f64 * TICK_S;
        let z = 0.5 + 0.25 + gap_m + SPEED * ahead_s;
        messages.push(carrier.message(&mut right, time(tick), z, with_velocities));
        // The first messages show how long messages take.
        let heard = if tick < 3 { Some(tick) } else { tick.checked_sub(delay).filter(|heard| *heard >= 3) };
        if let Some(heard) = heard {
            carrier.hear(&left.node, &messages[heard], time(tick));
        }
        answer = left.tick(time(tick), time(tick), 0.5, program).speed_override;
    }
    answer
}

#[test]
fn what_is_heard_late_lets_nobody_go_faster() {
    for carrier in [Carrier::Robot, Carrier::Encoder, Carrier::Object] {
        let mut limited = 0;
        for k in 1..80 {
            let gap_m = 0.01 * f64::from(k);
            let fresh = override_at(carrier, gap_m, 0, true, 0.6);
            for delay in [1, 4, 10] {
                let late = override_at(carrier, gap_m, delay, true, 0.6);
                // The warning zone uses the former place of the region: within the zone, the zone's law alone may permit more.
                if gap_m > 0.1 + SPEED * TICK_S * delay as f64 {
                    // Less the possible drift of the clocks.
                    assert!(late <= fresh + 2e-3, "{gap_m} m, {delay} ticks late: {late} instead of {fresh}");
                    limited += i32::from(fresh > 0.0 && fresh < 0.99);
                }
            }
        }
        assert!(limited > 20, "{carrier:?}: {limited}");
    }
}

#[test]
fn a_carrier_without_velocities_is_not_taken_to_stand() {
    for carrier in [Carrier::Robot, Carrier::Encoder, Carrier::Object] {
        for k in 1..80 {
            let gap_m = 0.01 * f64::from(k);
            let given = override_at(carrier, gap_m, 0, true, 0.6);
            let derived = override_at(carrier, gap_m, 0, false, 0.6);
            assert!((given - derived).abs() < 1e-3, "{carrier:?}, {gap_m} m: {derived} instead of {given}");
        }
        // Inside a moving region no robot starts to leave.
        assert_eq!(override_at(carrier, -0.1, 0, false, -0.6), 0.0);
    }
}

#[test]
fn what_is_measured_counts_as_what_a_robot_carries() {
    for carrier in MEASURED {
        for k in 1..80 {
            let gap_m = 0.01 * f64::from(k);
            let (robot, measured) =
                (override_at(Carrier::Robot, gap_m, 0, true, 0.6), override_at(carrier, gap_m, 0, true, 0.6));
            // A rail knows a bound of its acceleration, which allows no more.
            assert!((robot - measured).abs() < 1e-9, "{carrier:?}, {gap_m} m: {measured} instead of {robot}");
        }
    }
}

#[test]
fn a_source_that_is_not_heard_or_says_nothing_sensible_stops_the_robot() {
    let pose = [3.0, 0.0, 1.7, 0.0, 0.0, 0.0, 1.0];
    let nan = f64::NAN;
    let bad: [(Carrier, &[f64]); 7] = [
        (Carrier::Encoder, &[]),
        (Carrier::Encoder, &[nan]),
        (Carrier::Encoder, &[1.7, 0.0]),
        (Carrier::Object, &pose[..6]),
        (Carrier::Object, &[3.0, 0.0, 1.7, 0.0, 0.0, 0.0, 0.0]),
        (Carrier::Object, &[3.0, 0.0, 1.7, 0.0, 0.0, 0.0, 1.0, nan, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (Carrier::Object, &[1.7]),
    ];
    for (carrier, q) in bad {
        let mut left = Left::new(&carrier.tables());
        let mut sender = ControllerClient::new(1, 0);
        let mut tick = |n: u64, message: Option<&[f64]>| {
            let now = Micros(1 + 4000 * n);
            if let Some(q) = message {
                let state = ControllerState { q, programmed_override: 1.0, ..ControllerState::default() };
                carrier.hear(&left.node, sender.joint_state(now, &state), now);
            }
            left.tick(now, now, 0.5, 0.0).speed_override
        };
        assert_eq!(tick(0, None), 0.0, "nothing was heard");
        let good = if carrier == Carrier::Encoder { &pose[2..3] } else { &pose[..] };
        let free = (1..12).map(|n| tick(n, Some(good))).fold(0.0, f64::max);
        assert!(free > 0.0, "{carrier:?}");
        assert_eq!(tick(12, Some(q)), 0.0, "{carrier:?}: {q:?}");
        assert!((13..24).map(|n| tick(n, Some(good))).fold(0.0, f64::max) > 0.0, "{carrier:?}");
        // 100 ms later the last place is stale.
        let silent: Vec<f64> = (24..60).map(|n| tick(n, None)).collect();
        assert!(silent[..20].iter().any(|o| *o > 0.0) && silent[27..].iter().all(|o| *o == 0.0), "{silent:?}");
    }
}

/// The controller's messages arrive at its node with random delays of up to 0.3 ms, those of the carrier in every `every`th
/// tick.
fn faults_of_the_source(carrier: Carrier, every: u64, seed: u64) -> Vec<String> {
    let mut left = Left::new(&carrier.tables());
    let mut right = ControllerClient::new(1, left.checksum);
    let (mut random, mut faults) = (SplitMix(seed), Vec::new());
    for n in 0..1000 {
        let now = Micros(1 + 4000 * n);
        if n % every == 0 {
            let late = now + Micros(random.below(300) as u64);
            carrier.hear(&left.node, &carrier.message(&mut right, now, 1.9 - SPEED * 0.001 * n as f64, true), late);
        }
        let report = left.tick(now, now + Micros(300 + random.below(300) as u64), 0.1, 0.0);
        if n > 20 && matches!(report.reason, OverrideReason::Fault(Fault::Source { .. } | Fault::SourceJump { .. })) {
            faults.push(format!("{carrier:?}, tick {n}: {:?}", report.reason));
        }
    }
    faults
}

/// The highest override beside a region on a belt at 6 m/s that wraps at 0.4 m, whose encoder sends its travel alone, in every
/// `every`th tick.
fn override_beside_a_wrapping_belt(every: u64) -> f64 {
    let mut left = Left::new(&Carrier::Encoder.tables().replace("speed = 0", "speed = 0\nwrap = 400"));
    let mut sender = ControllerClient::new(1, 0);
    let mut highest = 0.0_f64;
    for n in 0..120 {
        let now = Micros(1 + 4000 * n);
        if n % every == 0 {
            let travel_m = (6.0 * 0.004 * n as f64).rem_euclid(0.4);
            let state = ControllerState { q: &[travel_m], programmed_override: 1.0, ..ControllerState::default() };
            left.node.measured(0, sender.joint_state(now, &state), now);
        }
        let report = left.tick(now, now, 1.9, 0.0);
        highest = highest.max(if n > 20 { report.speed_override } else { 0.0 });
    }
    highest
}

#[test]
fn which_way_a_belt_went_is_not_guessed() {
    assert!(override_beside_a_wrapping_belt(2) > 0.0);
    // In 24 ms it goes 144 mm: it may have gone 256 mm back.
    assert_eq!(override_beside_a_wrapping_belt(6), 0.0);
}

#[test]
fn a_tick_without_news_of_the_carrier_is_no_fault() {
    for carrier in [Carrier::Robot, Carrier::Encoder, Carrier::Object, Carrier::OnBelt] {
        for every in [1, 2, 3, 7] {
            let faults = faults_of_the_source(carrier, every, every);
            assert!(faults.is_empty(), "every {every}: {} faults, {}", faults.len(), faults[0]);
        }
    }
}
