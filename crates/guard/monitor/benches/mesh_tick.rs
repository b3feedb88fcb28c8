//! Duration of a tick with every link guarded as its exact mesh.
//!
//! `cargo bench -p elbowroom-monitor --bench mesh_tick`
//!
//! An RX60B of 23,012 triangles moves among 20 regions, beside a second RX60B whose seven links are dynamic regions.

#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::error::Error;
use std::time::Instant;

use common::{RandomGeometry, XorshiftStar, parts};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{
    Configuration, ConfigurationParts, Monitor, OverrideReason, Part, Presence, Region, Snapshot, SourceId,
    SourceState, Volume,
};
use elbowroom_proximity::Shape;
use elbowroom_robot::Robot;
use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

const TICKS: u32 = 20_000;
/// Half of the time over which velocities are derived.
const STEP_S: f64 = 1e-6;

/// Joint values of both arms: slow sines within limits, a phase apart.
fn joints(t: f64, phase: f64) -> [f64; 6] {
    let wave = |speed: f64, reach: f64| reach * (speed * t + phase).sin();
    [wave(0.5, 1.2), 0.3 + wave(0.7, 0.6), 0.8 + wave(0.6, 0.8), wave(0.9, 2.0), wave(0.8, 1.5), wave(1.0, 3.0)]
}

/// The motion of a frame between two poses, [`STEP_S`] before and after now.
fn motion(before: &Pose, after: &Pose) -> FrameMotion {
    let per_second = 1.0 / (2.0 * STEP_S);
    FrameMotion {
        velocity: (after.translation - before.translation) * per_second,
        angular_velocity: (after.rotation * before.rotation.inverse()).to_rotation_vector() * per_second,
        ..FrameMotion::default()
    }
}

/// Every mesh of the arm as a volume, including the stationary base.
fn volumes(robot: &Robot) -> Vec<Volume> {
    let colliders = robot.colliders.iter().enumerate();
    let each = colliders.flat_map(|(link, of_link)| of_link.iter().map(move |b| (link, b)));
    let volume = |(link, b): (usize, &elbowroom_robot::Collider)| Volume {
        name: b.name.clone(),
        part: Part::Arm,
        link: LinkId(link),
        shape: b.shape.clone(),
        in_link: b.in_link,
        presence: Presence::Always,
    };
    each.map(volume).collect()
}

/// Spheres, cylinders and boxes within reach of the arm, each with a warning zone of 10 cm.
fn regions() -> Vec<Region> {
    let mut r = XorshiftStar(5);
    let one = |i: usize| {
        let at = r.direction() * r.between(0.5, 0.9) + Vec3::Z * 0.4;
        let turn = Rotation::from_axis_angle(r.direction(), r.between(-3.0, 3.0));
        let size = r.between(0.03, 0.1);
        let region = match i % 3 {
            0 => Region::sphere(format!("{i}"), at, size),
            1 => Region::cylinder(format!("{i}"), at, size, 2.0 * size, turn),
            _ => Region::cuboid(format!("{i}"), at, Vec3::splat(2.0 * size), turn),
        };
        region.warning(0.1)
    };
    (0..20).map(one).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let urdf = elbowroom_testkit::folder::model("rx60b");
    let robot = load(&urdf, &LoadOptions::default())?.robot;
    let own = volumes(&robot);
    let triangles: usize =
        own.iter().map(|v| if let Shape::Mesh(m) = &v.shape { m.triangles().len() } else { 0 }).sum();
    println!(
        "{} link meshes, {triangles} triangles; 20 regions; a neighbour of {} moving meshes",
        own.len(),
        own.len()
    );
    println!("neighbour at  near it  median µs  p99 µs  p99.9 µs  max µs  slowed  stopped");
    for apart in [0.7, 0.9, 1.1] {
        let mut all = regions();
        let mut sources = Vec::new();
        for (i, v) in own.iter().enumerate() {
            all.push(
                Region::solid(format!("neighbour {}", v.name), v.shape.clone(), Pose::IDENTITY)
                    .warning(0.1)
                    .follow(SourceId(i)),
            );
            sources.push(format!("neighbour {}", v.name).into());
        }
        let parts = ConfigurationParts { sources, ..parts(robot.chain.clone(), own.clone(), all) };
        let mut monitor = Monitor::new(Configuration::new(parts)?, None)?;
        let mut neighbour = ChainState::new(&robot.chain);
        let base = Pose { rotation: Rotation::from_rpy(0.0, 0.0, 3.0), translation: Vec3::X * apart };
        let (mut times, mut near, mut slowed) = (Vec::new(), 0u64, [0u32; 2]);
        for i in 0..TICKS {
            let t = 0.002 * f64::from(i);
            let mut poses = |t: f64| -> Vec<Pose> {
                neighbour.q.copy_from_slice(&joints(t, 1.0));
                robot.chain.forward(&mut neighbour);
                own.iter().map(|v| base * neighbour.link_in_root(v.link) * v.in_link).collect()
            };
            let (before, now, after) = (poses(t - STEP_S), poses(t), poses(t + STEP_S));
            let moving = |i: usize| SourceState { pose: now[i], motion: motion(&before[i], &after[i]), stamp_s: t };
            let sources: Vec<SourceState> = (0..own.len()).map(moving).collect();
            let q = joints(t, 0.0);
            let (before, after) = (joints(t - STEP_S, 0.0), joints(t + STEP_S, 0.0));
            let qd: [f64; 6] = std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * STEP_S));
            let snapshot = Snapshot { qd: &qd, sources: &sources, ..Snapshot::stationary(t, &q) };
            let start = Instant::now();
            let report = monitor.tick(&snapshot);
            times.push(start.elapsed().as_nanos() as f64 / 1e3);
            assert!(!matches!(report.reason, OverrideReason::Fault(_)), "{}", report.reason);
            slowed[0] += u32::from(report.speed_override < 1.0);
            slowed[1] += u32::from(report.speed_override <= 0.0);
            near += u64::from(report.measured_pairs);
        }
        times.sort_by(f64::total_cmp);
        let at = |fraction: f64| times[((times.len() - 1) as f64 * fraction) as usize];
        println!(
            "{apart:10} m  {:7.1}  {:9.1}  {:6.1}  {:8.1}  {:6.1}  {:4.0} %  {:5.0} %",
            near as f64 / f64::from(TICKS),
            at(0.5),
            at(0.99),
            at(0.999),
            at(1.0),
            100.0 * f64::from(slowed[0]) / f64::from(TICKS),
            100.0 * f64::from(slowed[1]) / f64::from(TICKS)
        );
    }
    Ok(())
}
