//! Mean time of a distance per pair of shapes: `cargo run --release -p elbowroom-proximity --example pair_times`.
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Instant;

use elbowroom_proximity::{Shape, Sphere, TriMesh, collides, separation, separation_within, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};

fn main() {
    println!("{:10} {:10} {:>12} {:>16}", "a", "b", "distance ns", "within 5 cm ns");
    let kinds = ["sphere", "capsule", "cylinder", "box", "hull", "plane"];
    for (i, first) in kinds.iter().enumerate() {
        for second in &kinds[i..] {
            let mut rng = common::Rng(5);
            let cases: Vec<_> =
                (0..1000).map(|_| (rng.shape(first), rng.pose(2.0), rng.shape(second), rng.pose(2.0))).collect();
            let mean = |f: &dyn Fn(&Shape, &Pose, &Shape, &Pose)| {
                let start = Instant::now();
                for _ in 0..100 {
                    cases.iter().for_each(|(a, pa, b, pb)| f(a, pa, b, pb));
                }
                start.elapsed().as_nanos() as f64 / (100 * cases.len()) as f64
            };
            let all = mean(&|a, pa, b, pb| drop(black_box(separation(a, pa, b, pb))));
            let near = mean(&|a, pa, b, pb| drop(black_box(separation_within(a, pa, b, pb, 0.05))));
            println!("{first:10} {second:10} {all:12.0} {near:16.0}");
        }
    }
    let (v, t) = tessellate(&Shape::Sphere(Sphere { radius: 0.5 }), 4.6e-5);
    println!("two bumpy balls of {} triangles", t.len());
    let v: Vec<Vec3> = v.iter().enumerate().map(|(i, p)| *p * (1.0 + 0.02 * (i as f64).sin())).collect();
    let ball = Shape::Mesh(std::sync::Arc::new(TriMesh::new(v, t).expect("a sphere's triangles are valid")));
    let mut rng = common::Rng(1);
    for at in [0.9, 1.1, 2.0] {
        let poses: Vec<Pose> = (0..20).map(|_| Pose::new(rng.pose(1.0).rotation, Vec3::X * at)).collect();
        let start = Instant::now();
        poses.iter().for_each(|p| drop(black_box(collides(&ball, &Pose::IDENTITY, &ball, p))));
        let yes_no = start.elapsed().as_secs_f64() / poses.len() as f64;
        let start = Instant::now();
        poses.iter().for_each(|p| drop(black_box(separation(&ball, &Pose::IDENTITY, &ball, p))));
        let distance = start.elapsed().as_secs_f64() / poses.len() as f64;
        println!("  centres {at} m apart: collides {:.1} us, distance {:.1} us", yes_no * 1e6, distance * 1e6);
    }
}
