//! How long the map of a real robot takes: its own meshes, a mesh obstacle of 5,000 triangles, a cell of 50,000.
//!
//! `cargo run --release -p elbowroom-cspace --example robot_map -- ROBOT.urdf [STEP_DEG] [THREADS]`
#![allow(clippy::print_stdout, reason = "it is what the example is for")]

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use elbowroom_cspace::{Axis, FillCounts, Others, RobotFiller};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_spatial::{Pose, Vec3};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let file = args.next().ok_or("give a URDF")?;
    let step: f64 = args.next().map_or(Ok(2.0), |s| s.parse())?;
    let threads: Option<usize> = args.next().map(|s| s.parse()).transpose()?;
    let robot = load(std::path::Path::new(&file), &LoadOptions::default())?.robot;
    let chain = &robot.chain;
    let axes = (0..3)
        .map(|i| {
            let joint = &chain.joints()[chain.active_joints()[i].0];
            Axis::new(&joint.name, joint.limits.lower, joint.limits.upper, step.to_radians())
        })
        .collect::<Result<Vec<_>, _>>()?;
    let zeros = vec![0.0; chain.dof()];
    let begin = Instant::now();
    let filler = RobotFiller::new(&robot, Pose::IDENTITY, &axes, &[0, 1, 2], Others::Held(&zeros))?;
    println!("prepared in {:.1} ms", begin.elapsed().as_secs_f64() * 1e3);
    let filler = match threads {
        Some(threads) => filler.with_threads(threads),
        None => filler,
    };
    let reach =
        robot.chain.path(chain.tip()).iter().map(|j| chain.joints()[j.0].origin.translation.length()).sum::<f64>();
    let lump = |n: usize, radius: f64, at: Vec3| (Shape::Mesh(Arc::new(lumpy(n, radius))), Pose::from_translation(at));
    let table = (
        Shape::Cuboid(elbowroom_proximity::Cuboid { half_extents: Vec3::new(0.3, 0.45, 0.35) }),
        Pose::from_translation(Vec3::new(0.4, 0.0, 0.15) * reach),
    );
    let column = (
        Shape::Cylinder(elbowroom_proximity::Cylinder { half_length: 1.0, radius: 0.12 }),
        Pose::from_translation(Vec3::new(0.2, -0.3, 0.3) * reach),
    );
    let thing = lump(51, 0.12 * reach, Vec3::new(0.55, 0.2, 0.4) * reach);
    let cell: Vec<_> = (0..10)
        .map(|i| {
            let angle = f64::from(i) * 0.628;
            let at = Vec3::new(angle.cos() * 0.75, angle.sin() * 0.75, 0.15 + 0.05 * f64::from(i)) * reach;
            lump(51, 0.1 * reach, at)
        })
        .collect();
    for (name, obstacles) in
        [("table", vec![table]), ("column", vec![column]), ("5,000 triangles", vec![thing]), ("50,000 triangles", cell)]
    {
        for looks in [0, 18] {
            let filler = filler.clone().with_looks(looks);
            let begin = Instant::now();
            let (blocks, counts) = filler.fill_counted(&obstacles)?;
            let ms = begin.elapsed().as_secs_f64() * 1e3;
            let FillCounts { boxes, looks: asked, tried, unsure } = counts;
            println!(
                "{name}, looks {looks}: {ms:.1} ms, {} of {} cells blocked, {} kB; {boxes} boxes, {asked} looks, {tried} tried, {unsure} unsure",
                blocks.blocked(),
                blocks.cells(),
                blocks.bytes() / 1000
            );
        }
    }
    Ok(())
}

/// A closed lumpy ball of 2n(n-1) triangles or so.
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
