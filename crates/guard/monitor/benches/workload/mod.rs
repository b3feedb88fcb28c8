//! The arm, its motion and its regions: what the benches of the tick share.

#[path = "../../tests/common/mod.rs"]
pub mod common;

use std::hint::black_box;
use std::time::Instant;

use common::{RandomGeometry, XorshiftStar, arm, arm_volumes, parts};
use elbowroom_monitor::{Configuration, ConfigurationParts, Laws, Monitor, OverrideReason, Region, Snapshot};
use elbowroom_spatial::{Rotation, Vec3};

/// Time between two ticks, s.
pub const TICK_S: f64 = 0.002;
/// Step of the arm's motion in a tick that is a fifth as fast as the motion, s.
pub const SLOW_S: f64 = 0.2 * TICK_S;

/// The motion of the arm.
pub fn joints(t: f64) -> [f64; 6] {
    [1.2 * (0.9 * t).sin(), 0.6 * (1.1 * t).sin(), 0.8 * (0.7 * t).cos(), (0.5 * t).sin(), t.cos(), t.sin()]
}

/// The velocities of the motion.
fn velocities(t: f64) -> [f64; 6] {
    let h = 1e-6;
    let (before, after) = (joints(t - h), joints(t + h));
    std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * h))
}

/// Spheres, cylinders and boxes of 4 to 20 cm, times `scale`, around the base of the arm, each with a warning zone of 10 cm.
/// `distance` draws how far each is, m.
pub fn regions(count: usize, mut distance: impl FnMut(&mut XorshiftStar) -> f64, scale: f64) -> Vec<Region> {
    let mut r = XorshiftStar(17);
    let one = |i: usize| {
        let at = r.direction() * distance(&mut r) + Vec3::Z * 0.6;
        let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
        let size = scale * r.between(0.02, 0.1);
        let region = match i % 3 {
            0 => Region::sphere(format!("{i}"), at, size),
            1 => Region::cylinder(format!("{i}"), at, size, 2.0 * size, turn),
            _ => Region::cuboid(format!("{i}"), at, Vec3::splat(2.0 * size), turn),
        };
        region.warning(0.1)
    };
    (0..count).map(one).collect()
}

/// A monitor of the arm.
pub fn monitor(regions: Vec<Region>, laws: Laws) -> Monitor {
    let parts = ConfigurationParts { laws, ..parts(arm(), arm_volumes(), regions) };
    Monitor::new(Configuration::new(parts).expect("valid"), None).expect("a valid configuration")
}

/// Microseconds of each tick, and the mean number of pairs that a tick measured. The arm moves by `step_s` of its motion in
/// each tick. If the robot does not brake by itself, the law of the stopping distance must see it stationary.
pub fn tick_times(m: &mut Monitor, ticks: u32, step_s: f64, is_stationary: bool) -> (Vec<f64>, f64) {
    let (mut times, mut pairs) = (Vec::with_capacity(ticks as usize), 0_u64);
    let mut t = 0.0;
    for i in 0..ticks {
        let (q, intent) = (joints(t), velocities(t));
        let now_s = TICK_S * f64::from(i);
        // The motion is the same for all laws and versions, whatever override is requested.
        let qd = intent.map(|v| if is_stationary { 0.0 } else { v * step_s / TICK_S });
        let s = Snapshot { qd: &qd, intent: Some(&intent), ..Snapshot::stationary(now_s, &q) };
        let begin = Instant::now();
        let report = black_box(m.tick(black_box(&s)));
        times.push(begin.elapsed().as_secs_f64() * 1e6);
        assert!(!matches!(report.reason, OverrideReason::Fault(_)), "{}", report.reason);
        pairs += u64::from(report.measured_pairs);
        t += step_s;
    }
    (times, pairs as f64 / f64::from(ticks))
}
