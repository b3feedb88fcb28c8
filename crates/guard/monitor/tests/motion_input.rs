//! The stopping-distance law with incomplete or wrong input: positions only, frozen readings, jumps, brakes that fail.

use crate::common::{gantry, parts};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{
    Configuration, ConfigurationParts, Fault, Guards, Laws, Monitor, OverrideReason, Region, Snapshot,
    StoppingSettings, Volume,
};
use elbowroom_spatial::{Rotation, Vec3};

const TICK_S: f64 = 0.002;
const BRAKES: f64 = 4.0;

fn monitor() -> Monitor {
    reacting_after(TICK_S)
}

fn reacting_after(reaction_s: f64) -> Monitor {
    let stopping = StoppingSettings {
        reaction_s,
        period_s: TICK_S,
        joint_deceleration: vec![BRAKES; 6],
        joint_acceleration: vec![8.0; 6],
    };
    let laws = Laws { stopping_distance: Some(stopping), ..Laws::default() };
    let size = Vec3::new(1.0, 4.0, 4.0);
    let wall = Region::cuboid("wall", Vec3::new(2.5, 0.0, -2.0), size, Rotation::IDENTITY).guards(Guards::TCP);
    let volumes = vec![Volume::tcp(LinkId(6), Vec3::ZERO)];
    let parts = ConfigurationParts { laws, ..parts(gantry(), volumes, vec![wall]) };
    Monitor::new(Configuration::new(parts).unwrap(), None).unwrap()
}

/// A point on the x axis whose program moves at 2 m/s towards the wall at x = 2. It accelerates at 8 m/s² and brakes
/// at 4 m/s².
struct PointRobot {
    x: f64,
    speed: f64,
}

impl PointRobot {
    fn apply(&mut self, speed_override: f64, brakes: f64) {
        let commanded = 2.0 * speed_override;
        let next = commanded.clamp((self.speed - brakes * TICK_S).max(0.0), self.speed + 8.0 * TICK_S);
        self.x += 0.5 * (self.speed + next) * TICK_S;
        self.speed = next;
    }
}

#[test]
fn with_positions_alone_the_robot_stops_outside() {
    for intent in [None, Some([2.0, 0.0, 0.0, 0.0, 0.0, 0.0])] {
        let (mut m, mut robot) = (monitor(), PointRobot { x: 0.0, speed: 0.0 });
        let mut max_speed = 0.0_f64;
        for tick in 0..6000 {
            let q = [robot.x, 0.0, 0.0, 0.0, 0.0, 0.0];
            let s = Snapshot {
                intent: intent.as_ref().map(|i| &i[..]),
                ..Snapshot::stationary(TICK_S * f64::from(tick), &q)
            };
            let report = m.tick(&s);
            assert_eq!(
                matches!(report.reason, OverrideReason::Fault(Fault::NoVelocity)),
                tick == 0,
                "{}",
                report.reason
            );
            robot.apply(report.speed_override, BRAKES);
            max_speed = max_speed.max(robot.speed);
            assert!(robot.x < 2.0, "inside at tick {tick}");
        }
        assert!(max_speed > 1.0 && robot.x > 1.98, "{max_speed} m/s, at {} m", robot.x);
    }
}

#[test]
fn a_frozen_reading_stops_the_robot_before_it_is_inside() {
    for frozen_at in [0.0, 0.3, 0.9, 1.5, 1.9, 1.97] {
        for all in [true, false] {
            let (mut m, mut robot) = (monitor(), PointRobot { x: 0.0, speed: 0.0 });
            let intent = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            let mut frozen = None;
            let mut found = false;
            for tick in 0..4000 {
                if robot.x >= frozen_at {
                    frozen.get_or_insert((robot.x, robot.speed));
                }
                let (x, then) = frozen.unwrap_or((robot.x, robot.speed));
                let speed = if all { then } else { robot.speed };
                let (q, qd) = ([x, 0.0, 0.0, 0.0, 0.0, 0.0], [speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
                let stationary = Snapshot::stationary(TICK_S * f64::from(tick), &q);
                let report = m.tick(&Snapshot { qd: &qd, intent: Some(&intent), ..stationary });
                found |= matches!(report.reason, OverrideReason::Fault(Fault::Frozen | Fault::Braking));
                robot.apply(report.speed_override, BRAKES);
                assert!(robot.x < 2.0, "inside, frozen at {frozen_at}");
            }
            assert!(robot.speed < 1e-3 && (found || frozen_at > 1.8), "frozen at {frozen_at}: {} m/s", robot.speed);
        }
    }
}

/// A robot that starts to move 0.3 s after the command is valid; a robot that does not start then is frozen.
#[test]
fn a_robot_that_reacts_late_is_not_frozen() {
    let mut m = reacting_after(0.3);
    let intent = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut reason = |tick: u32| {
        let stationary = Snapshot::stationary(TICK_S * f64::from(tick), &[-20.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        m.tick(&Snapshot { qd: &[0.0; 6], intent: Some(&intent), ..stationary }).reason
    };
    let ticks = |time_s: f64| (time_s / TICK_S) as u32;
    assert!((0..ticks(0.3)).all(|tick| !matches!(reason(tick), OverrideReason::Fault(_))));
    assert!((ticks(0.3)..ticks(1.5)).any(|tick| reason(tick) == OverrideReason::Fault(Fault::Frozen)));
}

/// A robot whose brakes open later than its reaction time is frozen, rests for a second, and tries again; then it
/// moves.
#[test]
fn a_robot_that_was_frozen_tries_again_after_a_rest() {
    let (mut m, mut robot) = (monitor(), PointRobot { x: -20.0, speed: 0.0 });
    let intent = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut first_go = None;
    let mut faults = Vec::new();
    for tick in 0..2000 {
        let (q, qd) = ([robot.x, 0.0, 0.0, 0.0, 0.0, 0.0], [robot.speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let stationary = Snapshot::stationary(TICK_S * f64::from(tick), &q);
        let report = m.tick(&Snapshot { qd: &qd, intent: Some(&intent), ..stationary });
        if report.speed_override > 0.0 {
            first_go.get_or_insert(tick);
        }
        if first_go.is_some_and(|go| tick > go + 75) {
            robot.apply(report.speed_override, BRAKES);
        }
        if report.reason == OverrideReason::Fault(Fault::Frozen) {
            faults.push(tick);
        }
    }
    let rested = (1.0 / TICK_S) as usize;
    assert!((rested..rested + 20).contains(&faults.len()), "{} ticks of the fault, {faults:?}", faults.len());
    assert!(robot.x > -18.0, "it stands at {}", robot.x);
}

/// A controller that receives no override stops by itself and reports programmed override 0. However long that
/// lasts, its robot is not frozen, and its position is known.
#[test]
fn a_robot_whose_controller_stops_it_is_not_frozen() {
    let mut m = monitor();
    let intent = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut tick = |tick: u32, programmed_override: f64| {
        // The robot is 100 mm before the wall.
        let stationary = Snapshot::stationary(TICK_S * f64::from(tick), &[1.9, 0.0, 0.0, 0.0, 0.0, 0.0]);
        m.tick(&Snapshot { qd: &[0.0; 6], intent: Some(&intent), programmed_override, ..stationary })
    };
    let at_first = tick(0, 1.0).speed_override;
    assert!(at_first > 0.0);
    for i in 1..5000 {
        let report = tick(i, 0.0);
        assert_eq!((report.speed_override, report.reason), (0.0, OverrideReason::Free), "tick {i}");
    }
    let again = tick(5000, 1.0).speed_override;
    assert!(again > 0.9 * at_first, "{again}, at first {at_first}");
}

/// A robot stopped by its host is at rest although its program would move it; it continues when the host allows it.
#[test]
fn a_robot_that_its_host_stops_is_not_frozen() {
    let mut m = monitor();
    let intent = [0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut tick = |tick: u32, fault: Option<Fault>| {
        m.set_external_fault(fault);
        let stationary = Snapshot::stationary(TICK_S * f64::from(tick), &[-20.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let report = m.tick(&Snapshot { qd: &[0.0; 6], intent: Some(&intent), ..stationary });
        (report.speed_override, report.reason, m.input_fault())
    };
    for i in 0..5000 {
        assert_eq!(tick(i, Some(Fault::Regions)), (0.0, OverrideReason::Fault(Fault::Regions), None), "tick {i}");
    }
    let (speed_override, reason, fault) = tick(5000, None);
    assert!(speed_override > 0.0 && fault.is_none(), "{reason}");
    // The robot stops again, whatever override was reached.
    assert_eq!(tick(5001, Some(Fault::Regions)).0, 0.0);
}

#[test]
fn a_reading_that_has_jumped_is_a_fault_until_it_returns() {
    let mut m = monitor();
    let at = |m: &mut Monitor, tick: u32, x: f64| {
        let q = [x, 0.0, 0.0, 0.0, 0.0, 0.0];
        m.tick(&Snapshot { qd: &[0.0; 6], ..Snapshot::stationary(TICK_S * f64::from(tick), &q) }).reason
    };
    assert_eq!(at(&mut m, 0, 0.5), OverrideReason::Free);
    for tick in 1..5000 {
        assert_eq!(at(&mut m, tick, 0.4), OverrideReason::Fault(Fault::TooFast { joint: 0 }), "tick {tick}");
    }
    assert_eq!(at(&mut m, 5000, 0.5), OverrideReason::Free);
}

#[test]
fn a_robot_that_brakes_less_than_stated_is_a_fault() {
    for (brakes, fails) in [(BRAKES, false), (0.8 * BRAKES, true)] {
        let (mut m, mut robot) = (monitor(), PointRobot { x: 0.0, speed: 0.0 });
        let intent = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let mut found = false;
        for tick in 0..6000 {
            let (q, qd) = ([robot.x, 0.0, 0.0, 0.0, 0.0, 0.0], [robot.speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let stationary = Snapshot::stationary(TICK_S * f64::from(tick), &q);
            // The operator stops the robot.
            let programmed_override = if robot.x > 0.9 { 0.0 } else { 1.0 };
            let report = m.tick(&Snapshot { qd: &qd, intent: Some(&intent), programmed_override, ..stationary });
            found |= matches!(report.reason, OverrideReason::Fault(Fault::Braking));
            robot.apply(report.speed_override, brakes);
        }
        assert_eq!(found, fails, "{brakes} m/s²");
    }
}

/// A robot at rest after a stop does not count as frozen, and invalid times are not stored in the override history.
#[test]
fn a_stop_by_a_fault_ends_with_the_fault() {
    let (q, intent) = ([0.0; 6], [2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    // The times are not a number, from the future, out of order, stale.
    for stamp_s in [f64::NAN, f64::INFINITY, -1.0, 1.0] {
        let mut m = monitor();
        let at = |now_s: f64| Snapshot { qd: &[0.0; 6], intent: Some(&intent), ..Snapshot::stationary(now_s, &q) };
        assert_eq!(m.tick(&at(1.0)).reason, OverrideReason::Free);
        for tick in 1..1000 {
            let report = m.tick(&Snapshot { stamp_s, ..at(1.0 + TICK_S * f64::from(tick)) });
            assert!(report.speed_override == 0.0 || (stamp_s == 1.0 && tick <= 10), "{stamp_s}, tick {tick}");
        }
        let report = m.tick(&at(3.1));
        assert!(report.speed_override > 0.9, "{stamp_s}: {}", report.reason);
    }
}
