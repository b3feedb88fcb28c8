//! Duration of a tick: `cargo bench -p elbowroom-monitor --bench tick_time -- [PART]`.
//!
//! A six-axis arm with eight volumes moves among regions; each line is one set of regions. With PART, only the sets with
//! PART in their names.

#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Instant;

use common::{RandomGeometry, XorshiftStar, arm, arm_volumes, configuration, parts};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, Laws, Monitor, OverrideReason, Region, RegionId, Snapshot, StoppingSettings,
};
use elbowroom_spatial::{Rotation, Vec3};

const TICKS: u32 = 50_000;
const TICK_S: f64 = 0.002;

/// The motion of the arm.
fn joints(t: f64) -> [f64; 6] {
    [1.2 * (0.9 * t).sin(), 0.6 * (1.1 * t).sin(), 0.8 * (0.7 * t).cos(), (0.5 * t).sin(), t.cos(), t.sin()]
}

/// The velocities of the motion.
fn velocities(t: f64) -> [f64; 6] {
    let h = 1e-6;
    let (before, after) = (joints(t - h), joints(t + h));
    std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * h))
}

/// The regions that the arm never touches while it moves.
fn untouched(regions: Vec<Region>, count: usize) -> Vec<Region> {
    let mut m = Monitor::new(configuration(arm(), arm_volumes(), regions.clone()), None).expect("valid");
    let mut touched = vec![false; regions.len()];
    for i in 0..TICKS / 50 {
        let t = 0.1 * f64::from(i);
        m.tick(&Snapshot::stationary(t, &joints(t)));
        let mut inside = |r: usize| touched[r] |= m.is_inside(RegionId(r));
        (0..regions.len()).for_each(&mut inside);
    }
    let free = regions.into_iter().zip(touched).filter(|(_, touched)| !touched).map(|(r, _)| r);
    free.take(count).collect()
}

/// Spheres, cylinders and boxes of 4 to 20 cm in a shell around the base of the arm, each with a warning zone of 10 cm.
fn regions(count: usize, nearest: f64, farthest: f64) -> Vec<Region> {
    let mut r = XorshiftStar(17);
    let one = |i: usize| {
        let at = r.direction() * r.between(nearest, farthest) + Vec3::Z * 0.6;
        let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
        let size = r.between(0.02, 0.1);
        let region = match i % 3 {
            0 => Region::sphere(format!("{i}"), at, size),
            1 => Region::cylinder(format!("{i}"), at, size, 2.0 * size, turn),
            _ => Region::cuboid(format!("{i}"), at, Vec3::splat(2.0 * size), turn),
        };
        region.warning(0.1)
    };
    (0..count).map(one).collect()
}

/// Prints one row if its name contains the command's argument. The arm moves by `step_s` of its motion in each tick.
fn measure(name: &str, regions: Vec<Region>, laws: Laws, step_s: f64) {
    if elbowroom_testkit::bench::arguments().next().is_some_and(|part| !name.contains(&part)) {
        return;
    }
    let stops = laws.stopping_distance.is_some();
    let parts = ConfigurationParts { laws, ..parts(arm(), arm_volumes(), regions) };
    let mut m = Monitor::new(Configuration::new(parts).expect("valid"), None).expect("a valid configuration");
    let (mut times, mut pairs) = (Vec::with_capacity(TICKS as usize), 0_u64);
    let mut t = 0.0;
    for i in 0..TICKS {
        let (q, intent) = (joints(t), velocities(t));
        let now_s = TICK_S * f64::from(i);
        // The motion is the same for all laws and versions, whatever override is requested.
        // The stopping-distance law would report that the robot does not brake.
        let qd = intent.map(|v| if stops { 0.0 } else { v * step_s / TICK_S });
        let s = Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &q) };
        let begin = Instant::now();
        let report = std::hint::black_box(m.tick(std::hint::black_box(&s)));
        times.push(begin.elapsed().as_nanos());
        assert!(!matches!(report.reason, OverrideReason::Fault(_)), "{}", report.reason);
        pairs += u64::from(report.measured_pairs);
        t += step_s;
    }
    times.sort_unstable();
    let at = |fraction: f64| times[((times.len() - 1) as f64 * fraction) as usize] as f64 / 1000.0;
    let mean_pairs = pairs as f64 / f64::from(TICKS);
    println!("{name:46} {:8.2} {:8.2} {:8.2} {:8.2} {mean_pairs:9.1}", at(0.5), at(0.99), at(0.999), at(1.0));
}

fn main() {
    println!("{:46} {:>8} {:>8} {:>8} {:>8} {:>9}", "regions (µs per tick)", "median", "p99", "p99.9", "max", "pairs");
    let stopping = StoppingSettings {
        reaction_s: 0.01,
        period_s: 0.002,
        joint_deceleration: vec![30.0; 6],
        // The motion below needs at most 1.2 rad/s².
        joint_acceleration: vec![2.0; 6],
    };
    let all = Laws { direction_aware: true, stopping_distance: Some(stopping), ..Laws::default() };
    // A fifth of the speed of the motion, and all of it.
    let (slow, fast) = (0.2 * TICK_S, TICK_S);
    measure("none", vec![], Laws::default(), slow);
    let free = untouched(regions(4000, 0.3, 1.8), 1000);
    measure("100 around the arm, never touched", free[..100].to_vec(), Laws::default(), slow);
    measure("1,000 around the arm, never touched", free.clone(), Laws::default(), slow);
    measure("1,000 around the arm, never touched, all laws", free, all.clone(), slow);
    let touched = regions(1000, 0.3, 1.6);
    measure("1,000 around the arm, often touched", touched.clone(), Laws::default(), slow);
    measure("1,000 around the arm, often touched, all laws", touched.clone(), all.clone(), slow);
    measure("1,000 often touched, fast", touched.clone(), Laws::default(), fast);
    measure("1,000 often touched, fast, direction-aware", touched, Laws { stopping_distance: None, ..all }, fast);
    measure("10,000 far (3 to 30 m)", regions(10_000, 3.0, 30.0), Laws::default(), slow);
}
