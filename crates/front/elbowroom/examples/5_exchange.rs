//! Two robots share a pallet: one is granted the exchange region; the other waits at its border, then enters by itself.
//!
//! `cargo run --release -p elbowroom --example 5_exchange`
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::Arc;

use elbowroom::monitor::{ExchangeState, RegionId, RegionKind, RobotSlot, SlotId, ZoneArbiter, arm_volumes};
use elbowroom::prelude::*;
use elbowroom::proximity::VolumeModel;

/// Period of the controllers, s.
const TICK_S: f64 = 0.004;
/// Deceleration and acceleration of the joints, rad/s².
const BRAKE: f64 = 6.0;
/// The pallet, the only region of each monitor.
const PALLET: RegionId = RegionId(0);

/// A controller: its program swings joint 1 over the pallet and back.
struct Controller {
    name: &'static str,
    monitor: Monitor,
    q: [f64; 6],
    qd: [f64; 6],
    /// Speed of joint 1 in the program, rad/s: forward until the arm is over the pallet, then backward.
    speed: f64,
    state: ExchangeState,
}

impl Controller {
    fn new(robot: &Robot, slot: usize, arbiter: &Arc<ZoneArbiter>, speed: f64) -> Result<Self, Box<dyn Error>> {
        let (name, side) = [("left", -1.0), ("right", 1.0)][slot];
        let stopping = StoppingSettings {
            reaction_s: 0.02,
            period_s: TICK_S,
            joint_deceleration: vec![BRAKE; 6],
            joint_acceleration: vec![BRAKE; 6],
        };
        let kind = RegionKind::Exchange { slot: SlotId(0) };
        let (low, high) = (Vec3::new(-0.5, -0.45, 0.0), Vec3::new(0.5, 0.45, 1.5));
        let configuration = Configuration::new(ConfigurationParts {
            robot: name.into(),
            // The robots are on opposite sides of the pallet and face it.
            base_in_world: Pose::from_xyz_rpy([0.0, side * mm(1300.0), 0.0], [0.0, 0.0, -side * FRAC_PI_2]),
            volumes: arm_volumes(robot, VolumeModel::default()),
            regions: vec![Region::cuboid_from_corners("pallet", low, high).warning(mm(200.0)).kind(kind)],
            sources: vec![],
            grids: vec![],
            laws: Laws { direction_aware: true, stopping_distance: Some(stopping), ..Laws::default() },
            chain: robot.chain.clone(),
        })?;
        let monitor = Monitor::new(configuration, Some((arbiter.clone(), RobotSlot(slot)).into()))?;
        let q = [deg(-90.0), deg(20.0), deg(10.0), 0.0, deg(40.0), 0.0];
        Ok(Self { name, monitor, q, qd: [0.0; 6], speed, state: ExchangeState::Outside })
    }

    /// Runs one tick: the monitor publishes where the robot is and asks for the region; the robot obeys the override.
    fn tick(&mut self, now_s: f64) {
        let intent = [self.speed, 0.0, 0.0, 0.0, 0.0, 0.0];
        let snapshot = Snapshot { qd: &self.qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &self.q) };
        let speed_override = self.monitor.tick(&snapshot).speed_override;
        let state = self.monitor.exchange_state(PALLET).unwrap_or(ExchangeState::Outside);
        if state != self.state {
            println!("{now_s:>5.2} s  {:<5}  {:<9}  joint_1 {:>6.1}°", self.name, state.name(), self.q[0].to_degrees());
            self.state = state;
        }
        self.qd[0] += (speed_override * self.speed - self.qd[0]).clamp(-BRAKE * TICK_S, BRAKE * TICK_S);
        self.q[0] += self.qd[0] * TICK_S;
        if self.q[0] > 0.0 {
            self.speed = -self.speed.abs();
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/models/ns16/ns16.urdf");
    let robot = load_robot(&urdf, &LoadOptions::default())?.robot;
    // This example is one process; `docs/live.md` describes the same exchange between controllers on a network.
    let arbiter = Arc::new(ZoneArbiter::new(&["left", "right"], &["pallet"]));
    let mut robots = [Controller::new(&robot, 0, &arbiter, 0.8)?, Controller::new(&robot, 1, &arbiter, 0.7)?];
    let mut both_inside = 0;
    for tick in 0..2000 {
        for robot in &mut robots {
            robot.tick(f64::from(tick) * TICK_S);
        }
        both_inside += usize::from(robots.iter().all(|robot| robot.state == ExchangeState::Inside));
    }
    println!("ticks with both inside: {both_inside}");
    Ok(())
}
