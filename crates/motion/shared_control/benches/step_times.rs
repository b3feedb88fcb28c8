//! Time of a step of the navigator in contact, for surfaces of 1,000 to 100,000 triangles.
//!
//! `cargo bench -p elbowroom-shared_control --bench step_times` prints one row per size: a ball of 5,120 triangles (10 mm)
//! that a hand drags over a wavy relief, from below its ground.

#![allow(clippy::print_stdout, reason = "a bench prints")]

use std::time::Instant;

use elbowroom_shared_control::{NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};

#[path = "../tests/common/mod.rs"]
mod common;

const STEPS: usize = 10_000;

fn main() {
    let tool = common::ball(0.01, 4);
    println!("tool of {} triangles, {STEPS} steps of 1 ms per row", tool.triangles().len());
    println!("triangles   median µs   p99 µs   largest µs   in contact   largest change m/s");
    for side in [24, 72, 225] {
        let mesh = common::relief(side);
        let surface = ProtectedSurface::new(mesh.clone(), Pose::IDENTITY).expect("a closed relief");
        let settings = NavigatorSettings { speed_m_s: 0.1, ..Default::default() };
        let start = Pose::from_translation(Vec3::new(-0.15, 0.0, 0.03));
        let mut navigator =
            SurfaceNavigator::new(tool.clone(), vec![surface], start, settings).expect("the tool starts above");
        let (mut times, mut contacts) = (Vec::with_capacity(STEPS), 0);
        let (mut last, mut change) = (Vec3::ZERO, 0.0_f64);
        for k in 0..STEPS {
            let t = k as f64 * 1e-3;
            let hand = Vec3::new(-0.15 * (0.5 * t).cos(), 0.12 * (0.37 * t).sin(), -0.01);
            let start = Instant::now();
            let step = navigator.step(&Pose::from_translation(hand), 1e-3);
            times.push(start.elapsed().as_secs_f64() * 1e6);
            contacts += usize::from(step.active_rows > 0);
            change = change.max(step.velocity.distance(last));
            last = step.velocity;
        }
        times.sort_by(f64::total_cmp);
        let (triangles, share) = (mesh.triangles().len(), 100 * contacts / STEPS);
        let (median, p99, largest) = (times[STEPS / 2], times[STEPS * 99 / 100], times[STEPS - 1]);
        println!("{triangles:9}   {median:9.1}   {p99:6.1}   {largest:10.1}   {share:8} %   {change:10.3}");
    }
}
