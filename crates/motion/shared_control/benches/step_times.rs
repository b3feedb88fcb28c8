//! Time of a step of the navigator in contact, for surfaces of 1,000 to 100,000 triangles.
//!
//! `cargo bench -p elbowroom-shared_control --bench step_times` prints one row per size: a ball of 5,120 triangles (10 mm)
//! that a hand drags over a wavy relief, from below its ground; then the same with a point of entry 0.15 m above it.

#![allow(clippy::print_stdout, reason = "a bench prints")]

use std::sync::Arc;
use std::time::Instant;

use elbowroom_proximity::TriMesh;
use elbowroom_shared_control::{Guide, NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};

#[path = "../tests/common/mod.rs"]
mod common;

const STEPS: usize = 10_000;

fn main() {
    let tool = common::ball(0.01, 4);
    println!("tool of {} triangles, {STEPS} steps of 1 ms per row", tool.triangles().len());
    println!("triangles   entry   median µs   p99 µs   largest µs   in contact   largest change m/s");
    for (side, has_entry) in [24, 72, 225].into_iter().flat_map(|side| [(side, false), (side, true)]) {
        row(&tool, side, has_entry);
    }
}

fn row(tool: &Arc<TriMesh>, side: usize, has_entry: bool) {
    let mesh = common::relief(side);
    let surface = ProtectedSurface::new(mesh.clone(), Pose::IDENTITY).expect("a closed relief");
    let settings = NavigatorSettings { speed_m_s: 0.1, ..Default::default() };
    let start = Vec3::new(-0.15, 0.0, 0.03);
    let mut navigator = SurfaceNavigator::new(tool.clone(), vec![surface], Pose::from_translation(start), settings)
        .expect("the tool starts above");
    let any_depth = (f64::NEG_INFINITY, f64::INFINITY);
    let mut guide = has_entry
        .then(|| Guide::entry(start + Vec3::Z * 0.15, -Vec3::Z, 0.0, any_depth).expect("a point and a direction"));
    navigator.set_remote_center(guide.as_ref().and_then(Guide::remote_center).copied());
    let (mut times, mut contacts) = (Vec::with_capacity(STEPS), 0);
    let (mut last, mut change) = (Vec3::ZERO, 0.0_f64);
    for k in 0..STEPS {
        let t = k as f64 * 1e-3;
        let hand = Pose::from_translation(Vec3::new(-0.15 * (0.5 * t).cos(), 0.12 * (0.37 * t).sin(), -0.01));
        let start = Instant::now();
        let wanted = guide.as_mut().map_or(hand, |guide| guide.toward(&navigator.tool_in_world(), &hand));
        let step = navigator.step(&wanted, 1e-3);
        times.push(start.elapsed().as_secs_f64() * 1e6);
        contacts += usize::from(step.active_rows > 0);
        change = change.max(step.velocity.distance(last));
        last = step.velocity;
    }
    times.sort_by(f64::total_cmp);
    let (triangles, share) = (mesh.triangles().len(), 100 * contacts / STEPS);
    let (median, p99, largest) = (times[STEPS / 2], times[STEPS * 99 / 100], times[STEPS - 1]);
    println!("{triangles:9}   {has_entry:5}   {median:9.1}   {p99:6.1}   {largest:10.1}   {share:8} %   {change:10.3}");
}
