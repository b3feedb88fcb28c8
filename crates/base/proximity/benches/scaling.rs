//! Cost of a mesh as a function of its number of triangles: time and memory to build it, time and allocations per query.
//!
//! `cargo bench -p elbowroom-proximity --bench scaling` prints one row per size, from 1,000 to 10,000,000 triangles, for
//! two bumpy balls of 1 m, apart by 1 % and overlapping by 1 %.

use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

use elbowroom_proximity::advanced::{colliding_triangles, mesh_separation, triangles_within};
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::bench::{GrowthTable, Stopwatch, quantile};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

const SIZES: [usize; 9] = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000];
/// Centres of balls apart by 1 %, and overlapping by 1 %, m.
const NEAR_M: f64 = 1.06;
const TOUCH_M: f64 = 0.97;

/// Times and memory of one size, and allocations of its queries.
struct Measured {
    triangles: f64,
    build_ms: f64,
    tree_bytes: f64,
    mesh_bytes: f64,
    /// Collide near, collide touching, within, distance.
    query_us: [f64; 4],
    allocations: usize,
}

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
    quantile(&mut each, 0.5)
}

/// Builds a mesh several times, and measures the least time (ms) and the memory that it holds in all (bytes).
fn build(size: usize) -> (TriMesh, f64, f64) {
    let (vertices, faces) = ball(size);
    let mut least_ms = f64::INFINITY;
    for _ in 0..if size < 200_000 { 5 } else { 2 } {
        let (v, f) = (vertices.clone(), faces.clone());
        let watch = Stopwatch::start();
        black_box(TriMesh::new(v, f).expect("a closed ball"));
        least_ms = least_ms.min(watch.seconds() * 1e3);
    }
    let given = std::mem::size_of_val(&vertices[..]) + std::mem::size_of_val(&faces[..]);
    let counter = AllocationCounter::start();
    let mesh = TriMesh::new(vertices, faces).expect("a closed ball");
    let held = counter.held_bytes() as f64 + given as f64;
    (mesh, least_ms, held)
}

fn measure(size: usize) -> Measured {
    let (mesh, build_ms, held) = build(size);
    let mut s = Workspace::new();
    let here = Pose::IDENTITY;
    let mut query = |apart: f64, kind: usize| {
        time(apart, |p| match kind {
            0 | 1 => _ = black_box(colliding_triangles(&mesh, &here, &mesh, p, &mut s)),
            2 => _ = black_box(triangles_within(&mesh, &here, &mesh, p, 0.05, &mut s)),
            _ => _ = black_box(mesh_separation(&mesh, &here, &mesh, p, &mut s)),
        })
    };
    let mut all = || [query(NEAR_M, 0), query(TOUCH_M, 1), query(NEAR_M, 2), query(NEAR_M, 3)];
    let query_us = all();
    let counter = AllocationCounter::start();
    all();
    // `time` allocates the list of poses and the list of times.
    let allocations = counter.allocations() - 4 * 2;
    let triangles = mesh.triangles().len() as f64;
    let tree_bytes = mesh.bvh_bytes() as f64 / triangles;
    Measured { triangles, build_ms, tree_bytes, mesh_bytes: held / triangles, query_us, allocations }
}

fn main() {
    let columns = [
        "triangles",
        "build ms",
        "collide near µs",
        "collide touching µs",
        "within 5 % µs",
        "distance µs",
        "tree B/triangle",
        "mesh B/triangle",
        "allocations of 800 queries",
    ];
    let table = GrowthTable::start("triangles", &columns);
    for size in SIZES {
        let m = measure(size);
        let [near, touch, within, distance] = m.query_us;
        let memory = [m.tree_bytes, m.mesh_bytes, m.allocations as f64];
        table.row(&[&[m.triangles, m.build_ms, near, touch, within, distance][..], &memory].concat());
    }
}
