//! Cost of a mesh as a function of its number of triangles: time and memory to build it, time per query.
//!
//! `cargo bench -p elbowroom-proximity --bench scaling -- [--json]` prints one row per size, from 1,000 to 2,000,000
//! triangles, for two bumpy balls of 1 m, apart by 1 % and overlapping by 1 %.

#![allow(clippy::print_stdout, reason = "a bench prints")]

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

use elbowroom_proximity::advanced::{colliding_triangles, mesh_separation, triangles_within};
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// A closed wavy ball of about 2 · rings · sectors triangles.
fn ball(triangles: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let rings = ((triangles as f64 / 4.0).sqrt().round() as usize).max(3);
    let sectors = 2 * rings;
    let mut vertices = vec![Vec3::Z * 0.5];
    for ring in 1..rings {
        let polar = PI * ring as f64 / rings as f64;
        for sector in 0..sectors {
            let around = TAU * sector as f64 / sectors as f64;
            let radius = 0.5 * (1.0 + 0.05 * (7.0 * polar).sin() * (5.0 * around).cos());
            vertices.push(Vec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos()) * radius);
        }
    }
    vertices.push(Vec3::Z * -0.5);
    let at = |ring: usize, sector: usize| (1 + (ring - 1) * sectors + sector % sectors) as u32;
    let last = vertices.len() as u32 - 1;
    let mut faces = Vec::new();
    for s in 0..sectors {
        faces.push([0, at(1, s), at(1, s + 1)]);
        for r in 1..rings - 1 {
            faces.push([at(r, s), at(r + 1, s), at(r + 1, s + 1)]);
            faces.push([at(r, s), at(r + 1, s + 1), at(r, s + 1)]);
        }
        faces.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
    }
    (vertices, faces)
}

/// Median microseconds of `query` over rotated poses with this distance of the centres.
fn time(apart: f64, mut query: impl FnMut(&Pose)) -> f64 {
    let pose = |i: usize| {
        let turn = i as f64;
        let direction = Vec3::new(turn.sin(), (turn * 1.7).cos(), (turn * 0.6).sin() + 0.1);
        Pose {
            rotation: Rotation::from_rpy(turn, turn * 0.7, turn * 1.3),
            translation: direction * (apart / direction.length()),
        }
    };
    let poses: Vec<Pose> = (0..200).map(pose).collect();
    poses.iter().for_each(&mut query);
    let mut each: Vec<f64> = poses
        .iter()
        .map(|p| {
            let start = Instant::now();
            query(p);
            start.elapsed().as_secs_f64() * 1e6
        })
        .collect();
    each.sort_by(f64::total_cmp);
    each[each.len() / 2]
}

fn main() {
    let json = elbowroom_testkit::bench::arguments().any(|a| a == "--json");
    if !json {
        println!("triangles  build ms  tree B/tri  collide near µs  collide touch µs  within 5 % µs  distance µs");
    }
    for size in [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 2_000_000] {
        let (vertices, faces) = ball(size);
        let builds: Vec<f64> = (0..if size < 200_000 { 5 } else { 3 })
            .map(|_| {
                let (v, f) = (vertices.clone(), faces.clone());
                let start = Instant::now();
                black_box(TriMesh::new(v, f).expect("a closed ball"));
                start.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        let build = builds.iter().copied().fold(f64::INFINITY, f64::min);
        let mesh = TriMesh::new(vertices, faces).expect("a closed ball");
        let mut s = Workspace::new();
        let here = Pose::IDENTITY;
        let near = time(1.06, |p| {
            black_box(colliding_triangles(&mesh, &here, &mesh, p, &mut s));
        });
        let touch = time(0.97, |p| {
            black_box(colliding_triangles(&mesh, &here, &mesh, p, &mut s));
        });
        let tolerance = time(1.06, |p| {
            black_box(triangles_within(&mesh, &here, &mesh, p, 0.05, &mut s));
        });
        let far = time(1.06, |p| {
            black_box(mesh_separation(&mesh, &here, &mesh, p, &mut s));
        });
        let triangles = mesh.triangles().len();
        let bytes = mesh.bvh_bytes() as f64 / triangles as f64;
        if json {
            println!(
                "{{\"triangles\":{triangles},\"build_ms\":{build:.3},\"tree_bytes_per_triangle\":{bytes:.1},\"collide_near_us\":{near:.3},\"collide_touch_us\":{touch:.3},\"within_us\":{tolerance:.3},\"distance_us\":{far:.3}}}"
            );
        } else {
            println!(
                "{triangles:9}  {build:8.2}  {bytes:10.1}  {near:15.2}  {touch:16.2}  {tolerance:13.2}  {far:11.2}"
            );
        }
    }
}
