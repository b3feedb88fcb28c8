//! Times of building the map of a whole robot with its own solids, among a table, a column, a mesh obstacle of 5,000
//! triangles, and one of 50,000.
//!
//! `cargo bench -p elbowroom-cspace --bench robot_map -- [ROBOT.urdf [STEP_DEG [THREADS]]]`
//!
//! Without a robot: the KR125 of the examples. The map has the first three joints; the others are at 0. `bisect` is the
//! number of bisections of a cell at the boundary before it counts as blocked. Times are the best of three.
#![allow(clippy::print_stdout, reason = "a bench prints")]

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use elbowroom_cspace::{GridAxis, RemainingJoints, RobotMapBuilder, RobotMapSettings, RobotMapStats};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Cuboid, Cylinder, Shape, TriMesh};
use elbowroom_robot::Robot;
use elbowroom_spatial::{Pose, Vec3};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = elbowroom_testkit::bench::arguments();
    let own = || elbowroom_testkit::folder::model("kr125");
    let file = args.next().map_or_else(own, PathBuf::from);
    let step: f64 = args.next().map_or(Ok(2.0), |s| s.parse())?;
    let threads: Option<usize> = args.next().map(|s| s.parse()).transpose()?;
    let robot = load(&file, &LoadOptions::default())?.robot;
    let begin = Instant::now();
    let builder = builder(&robot, step)?;
    println!("prepared in {:.1} ms", begin.elapsed().as_secs_f64() * 1e3);
    let chain = &robot.chain;
    let reach: f64 = chain.path(chain.tip()).iter().map(|j| chain.joints()[j.0].origin.translation.length()).sum();
    println!(
        "{:<17} {:>6} {:>9} {:>9} {:>9} {:>6} {:>8} {:>9} {:>10} {:>9}",
        "obstacles", "bisect", "ms", "blocked", "of", "kB", "boxes", "distances", "collisions", "undecided"
    );
    for (name, obstacles) in obstacles(reach) {
        for bisections in [0, 18] {
            let settings = RobotMapSettings { bisections: Some(bisections), threads, ..RobotMapSettings::default() };
            row(name, &obstacles, &builder.clone().with_settings(settings), bisections)?;
        }
    }
    Ok(())
}

fn builder(robot: &Robot, step_deg: f64) -> Result<RobotMapBuilder, Box<dyn Error>> {
    let chain = &robot.chain;
    let joints = chain.active_joints().iter().take(3).map(|id| &chain.joints()[id.0]);
    let axes = joints
        .map(|j| GridAxis::new(&j.name, j.limits.lower, j.limits.upper, step_deg.to_radians()))
        .collect::<Result<Vec<_>, _>>()?;
    let zeros = vec![0.0; chain.dof()];
    Ok(RobotMapBuilder::new(robot, Pose::IDENTITY, &axes, &[0, 1, 2], RemainingJoints::Fixed(&zeros))?)
}

type Placed = Vec<(Shape, Pose)>;

/// Obstacles around a robot of this reach, metres.
fn obstacles(reach: f64) -> [(&'static str, Placed); 4] {
    let at = |x: f64, y: f64, z: f64| Pose::from_translation(Vec3::new(x, y, z) * reach);
    let lump = |radius: f64, at: Pose| (Shape::Mesh(Arc::new(lumpy(51, radius * reach))), at);
    let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.45, 0.35) });
    let column = Shape::Cylinder(Cylinder { half_length: 1.0, radius: 0.12 });
    let around = |i: u32| {
        let (sin, cos) = (0.628 * f64::from(i)).sin_cos();
        lump(0.1, at(0.75 * cos, 0.75 * sin, 0.15 + 0.05 * f64::from(i)))
    };
    [
        ("table", vec![(table, at(0.4, 0.0, 0.15))]),
        ("column", vec![(column, at(0.2, -0.3, 0.3))]),
        ("5,000 triangles", vec![lump(0.12, at(0.55, 0.2, 0.4))]),
        ("50,000 triangles", (0..10).map(around).collect()),
    ]
}

fn row(name: &str, obstacles: &Placed, builder: &RobotMapBuilder, bisections: u32) -> Result<(), Box<dyn Error>> {
    let mut best = f64::INFINITY;
    let mut last = None;
    for _ in 0..3 {
        let begin = Instant::now();
        last = Some(builder.build_with_stats(obstacles)?);
        best = best.min(begin.elapsed().as_secs_f64() * 1e3);
    }
    let (tree, stats) = last.ok_or("three is more than none")?;
    let RobotMapStats { boxes, distance_queries, collision_queries, undecided } = stats;
    let (blocked, cells, kilobytes) = (tree.blocked(), tree.cells(), tree.bytes() / 1000);
    println!(
        "{name:<17} {bisections:>6} {best:>9.1} {blocked:>9} {cells:>9} {kilobytes:>6} {boxes:>8} {distance_queries:>9} \
         {collision_queries:>10} {undecided:>9}"
    );
    Ok(())
}

/// A closed lumpy ball of about 2n(n-1) triangles.
fn lumpy(n: usize, radius: f64) -> TriMesh {
    let mut vertices = vec![Vec3::Z * radius];
    let (rings, around) = (n, n);
    for i in 1..rings {
        let polar = std::f64::consts::PI * i as f64 / rings as f64;
        for j in 0..around {
            let turn = std::f64::consts::TAU * j as f64 / around as f64;
            let r = radius * (1.0 + 0.15 * (5.0 * turn).sin() * (4.0 * polar).sin());
            vertices.push(Vec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos()) * r);
        }
    }
    vertices.push(Vec3::Z * -radius);
    let at = |i: usize, j: usize| (1 + (i - 1) * around + j % around) as u32;
    let last = vertices.len() as u32 - 1;
    let mut triangles = Vec::new();
    for j in 0..around {
        triangles.push([0, at(1, j), at(1, j + 1)]);
        triangles.push([last, at(rings - 1, j + 1), at(rings - 1, j)]);
        for i in 1..rings - 1 {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    TriMesh::new(vertices, triangles).expect("a ball")
}
