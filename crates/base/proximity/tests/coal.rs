//! Distances of convex shapes compared with Coal: every pair of kinds, near, far and overlapping, degenerate sizes among them.
//!
//! Needs a Python with `pin`, given by `ELBOWROOM_PYTHON` (default `python3`); without it the test prints a message and passes.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::{CONVEX, RandomGeometry, SplitMix};
use elbowroom_proximity::{Shape, separation};
use elbowroom_spatial::Pose;
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::python::with_modules;

/// A shape and its pose as the script reads them.
fn words(shape: &Shape, pose: &Pose) -> String {
    let mut text = match shape {
        Shape::Sphere(s) => format!("sphere {}", s.radius),
        Shape::Capsule(c) => format!("capsule {} {}", c.half_length, c.radius),
        Shape::Cylinder(c) => format!("cylinder {} {}", c.half_length, c.radius),
        Shape::Cuboid(c) => format!("box {} {} {}", c.half_extents.x, c.half_extents.y, c.half_extents.z),
        Shape::Hull(h) => h.vertices().iter().fold("hull".to_owned(), |mut text, v| {
            let _ = write!(text, " {} {} {}", v.x, v.y, v.z);
            text
        }),
        _ => unreachable!("not compared"),
    };
    let origin = pose.translation;
    for (row, at) in pose.rotation.rows().iter().zip([origin.x, origin.y, origin.z]) {
        let _ = write!(text, " {} {} {} {at}", row[0], row[1], row[2]);
    }
    text
}

/// Coal's distances, a pair of shapes per line.
fn coal(python: &str, pairs: &str) -> Vec<f64> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/coal_distances.py");
    let mut process = Command::new(python).arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = process.stdin.take().unwrap();
    let output = std::thread::scope(|scope| {
        scope.spawn(move || input.write_all(pairs.as_bytes()).unwrap());
        process.wait_with_output().unwrap()
    });
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap().lines().map(|line| line.parse().unwrap()).collect()
}

#[test]
fn distances_agree_with_coal() {
    let Some(python) = with_modules("coal, numpy", "`pin`, which has Coal,") else { return };
    let mut rng = SplitMix(21);
    let (mut pairs, mut ours) = (String::new(), Vec::new());
    for (first, second) in CONVEX.into_iter().flat_map(|a| CONVEX.map(|b| (a, b))) {
        for _ in 0..amount(500, 20_000) {
            let (a, b, pa, pb) = (rng.shape(first), rng.shape(second), rng.pose(1.0), rng.pose(1.0));
            let _ = writeln!(pairs, "{}\t{}", words(&a, &pa), words(&b, &pb));
            ours.push(separation(&a, &pa, &b, &pb).distance);
        }
    }
    let theirs = coal(&python, &pairs);
    assert_eq!(theirs.len(), ours.len());
    let apart = ours.iter().filter(|&&distance| distance > 0.0).count();
    assert!(apart * 10 > ours.len() && apart * 10 < 9 * ours.len(), "{apart} of {} are apart", ours.len());
    for ((ours, theirs), pair) in ours.iter().zip(theirs).zip(pairs.lines()) {
        assert!((ours - theirs.max(0.0)).abs() < 1e-5, "{ours}, by Coal {theirs}: {pair}");
    }
}
