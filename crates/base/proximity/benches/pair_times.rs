//! Time of a distance per pair of shapes: `cargo bench -p elbowroom-proximity --bench pair_times`.
//!
//! "hit" are pairs closer than 10 cm that do not touch, "overlap" pairs that touch, "rejected" pairs proven to be
//! farther apart than 10 cm. The result is the smallest mean of ten rounds, to exclude the load of other processes.
#![allow(clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Instant;

use common::RandomGeometry;
use elbowroom_proximity::{
    Shape, Sphere, TriMesh, collides, penetration, separation, separation_within, tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Vec3};

type Case = (Shape, Pose, Shape, Pose);

const CASES: usize = 100;
const LIMIT: f64 = 0.1;

fn gather(first: &str, second: &str, wanted: impl Fn(Option<f64>) -> bool) -> Vec<Case> {
    let mut rng = common::SplitMix(5);
    let mut found = Vec::with_capacity(CASES);
    for _ in 0..20_000 {
        let case = (rng.shape(first), rng.pose(1.5), rng.shape(second), rng.pose(1.5));
        let (a, pa, b, pb) = &case;
        if wanted(separation_within(a, pa, b, pb, LIMIT).map(|s| s.distance)) {
            found.push(case);
            if found.len() == CASES {
                break;
            }
        }
    }
    found
}

/// Nanoseconds per case; NaN without cases.
fn time<T>(cases: &[Case], query: impl Fn(&Shape, &Pose, &Shape, &Pose) -> T) -> f64 {
    if cases.is_empty() {
        return f64::NAN;
    }
    let round = || {
        let start = Instant::now();
        for _ in 0..20 {
            for (a, pa, b, pb) in cases {
                black_box(query(a, pa, b, pb));
            }
        }
        start.elapsed().as_nanos() as f64 / (20 * cases.len()) as f64
    };
    (0..10).map(|_| round()).fold(f64::INFINITY, f64::min)
}

fn main() {
    let head = ["hit ns", "overlap ns", "rejected ns", "penetration ns"];
    println!("| {:8} | {:8} | {:>11} | {:>11} | {:>11} | {:>14} |", "a", "b", head[0], head[1], head[2], head[3]);
    println!("| --- | --- | --: | --: | --: | --: |");
    let kinds = ["sphere", "capsule", "cylinder", "box", "hull", "plane"];
    for (i, first) in kinds.iter().enumerate() {
        for second in &kinds[i..] {
            let near = |a: &Shape, pa: &Pose, b: &Shape, pb: &Pose| separation_within(a, pa, b, pb, LIMIT);
            let overlapping = gather(first, second, |d| d == Some(0.0));
            let columns = [
                time(&gather(first, second, |d| d.is_some_and(|d| d > 0.0)), near),
                time(&overlapping, near),
                time(&gather(first, second, |d| d.is_none()), near),
                // The penetration of hulls builds hulls, so it is not for a control tick.
                if *first == "hull" || *second == "hull" {
                    f64::NAN
                } else {
                    time(&overlapping[..overlapping.len().min(10)], penetration)
                },
            ];
            let [hit, overlap, rejected, penetration_ns] = columns.map(|ns| format!("{ns:.0}"));
            println!("| {first:8} | {second:8} | {hit:>11} | {overlap:>11} | {rejected:>11} | {penetration_ns:>14} |");
        }
    }
    meshes();
}

fn bumpy_ball(chord_error: f64) -> Shape {
    let (v, t) = tessellate(&Shape::Sphere(Sphere { radius: 0.5 }), chord_error);
    let v: Vec<Vec3> = v.iter().enumerate().map(|(i, p)| *p * (1.0 + 0.02 * (i as f64).sin())).collect();
    Shape::Mesh(std::sync::Arc::new(TriMesh::new(v, t).expect("a sphere's triangles are valid")))
}

fn meshes() {
    let (large, small) = (bumpy_ball(4.6e-5), bumpy_ball(1e-3));
    let mut rng = common::SplitMix(1);
    let triangles = |s: &Shape| if let Shape::Mesh(m) = s { m.triangles().len() } else { 0 };
    println!("two bumpy balls of {} triangles", triangles(&large));
    for at in [0.0, 0.9, 1.1, 2.0] {
        let case = || (large.clone(), Pose::IDENTITY, large.clone(), Pose::new(rng.pose(1.0).rotation, Vec3::X * at));
        let cases: Vec<Case> = std::iter::repeat_with(case).take(3).collect();
        let (yes_no, distance) = (time(&cases[..2], collides) / 1e3, time(&cases[..2], separation) / 1e3);
        println!("  centres {at} m apart: collides {yes_no:.1} us, distance {distance:.1} us");
    }
    println!("a bumpy ball of {} triangles, 10 cm away", triangles(&small));
    for kind in ["sphere", "capsule", "cylinder", "box", "hull"] {
        let cases: Vec<Case> = std::iter::repeat_with(|| {
            (rng.shape(kind), rng.pose(1.5), small.clone(), Pose::new(rng.pose(1.0).rotation, Vec3::ZERO))
        })
        .filter(|(a, pa, b, pb)| separation_within(a, pa, b, pb, LIMIT).is_some_and(|s| s.distance > 0.0))
        .take(20)
        .collect();
        println!("  {kind:8}: distance {:.1} us", time(&cases, separation) / 1e3);
    }
}
