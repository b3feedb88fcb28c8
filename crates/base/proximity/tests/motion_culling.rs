//! Motion-based face culling on closed meshes that are not convex.
//!
//! The times of impact are the same with the kept faces of both meshes as with all faces. Also prints the fractions
//! of faces and time saved. `ELBOWROOM_LONG=1`, `--release` runs 100,000 motions; `-- --nocapture` shows the
//! figures.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::ccd::{CcdOptions, ConstantTwist, RigidMotion, TimeOfImpact, time_of_impact};
use elbowroom_proximity::motion_culling::{FaceCulling, KeptFaces, RelativeTwist};
use elbowroom_proximity::{Shape, TriMesh, separation};
use elbowroom_spatial::{Pose, Rotation, Vec3};

fn motions() -> usize {
    elbowroom_testkit::extent::amount(600, 100_000)
}

/// A wavy ball.
fn lump(r: &mut SplitMix) -> TriMesh {
    let (stretch, wave) =
        (Vec3::new(r.between(0.5, 1.5), r.between(0.5, 1.5), r.between(0.5, 1.5)), r.between(0.2, 0.6));
    crate::common::lump(0.2, 0.004, stretch, wave)
}

/// A motion towards the other mesh, with some rotation.
fn step(r: &mut SplitMix, from: Vec3, to: Vec3) -> ConstantTwist {
    let start = Pose::new(Rotation::from_rotation_vector(r.vec(3.0)), from);
    let travel = (to - from) * r.between(0.2, 1.5) + r.vec(0.2);
    match r.below(3) {
        0 => ConstantTwist::linear(start, travel),
        1 => ConstantTwist { rotation: r.vec(0.5), ..ConstantTwist::linear(start, travel) },
        _ => ConstantTwist::screw(start, r.vec(1.0), r.vec(0.6), r.between(-0.5, 0.5)),
    }
}

fn kept(mesh: &TriMesh, faces: &KeptFaces) -> Option<Shape> {
    let triangles: Vec<_> = faces.iter().map(|t| mesh.triangles()[t]).collect();
    TriMesh::new(mesh.vertices().to_vec(), triangles).ok().map(|m| Shape::Mesh(Arc::new(m)))
}

#[test]
fn the_kept_faces_of_both_meet_when_all_do() {
    let mut r = SplitMix(21);
    let options = CcdOptions { tolerance: 1e-7, max_steps: 100_000, ..CcdOptions::default() };
    let lumps: Vec<TriMesh> = (0..24).map(|_| lump(&mut r)).collect();
    let culling: Vec<FaceCulling> = lumps.iter().map(FaceCulling::of).collect();
    let shapes: Vec<Shape> = lumps.iter().map(|m| Shape::Mesh(Arc::new(m.clone()))).collect();
    let (mut tested, mut hits, mut grazes) = (0, 0, 0);
    let (mut faces, mut all, mut pairs, mut all_pairs) = (0, 0, 0.0, 0.0);
    let (mut whole_time, mut part_time) = (Duration::ZERO, Duration::ZERO);
    for _ in 0..motions() {
        let (i, j) = (r.below(lumps.len()), r.below(lumps.len()));
        let (a, b) = (r.vec(0.5), r.vec(0.5));
        let (pa, pb) = (step(&mut r, a, b), step(&mut r, b, a));
        if separation(&shapes[i], &pa.pose(0.0), &shapes[j], &pb.pose(0.0)).distance < 1e-3 {
            continue;
        }
        tested += 1;
        let of_a = culling[i].kept_faces(&RelativeTwist::between(&pa, &pb, 0.0, 1.0));
        let of_b = culling[j].kept_faces(&RelativeTwist::between(&pb, &pa, 0.0, 1.0));
        let (m, n) = (lumps[i].triangles().len(), lumps[j].triangles().len());
        (faces, all) = (faces + of_a.count() + of_b.count(), all + m + n);
        pairs += of_a.count() as f64 * of_b.count() as f64;
        all_pairs += m as f64 * n as f64;
        let timed = |x: &Shape, y: &Shape, spent: &mut Duration| -> Option<TimeOfImpact> {
            let started = Instant::now();
            let found = time_of_impact(x, &pa, y, &pb, &options);
            *spent += started.elapsed();
            found
        };
        let whole = timed(&shapes[i], &shapes[j], &mut whole_time);
        let part = match (kept(&lumps[i], &of_a), kept(&lumps[j], &of_b)) {
            (Some(x), Some(y)) => timed(&x, &y, &mut part_time),
            _ => None,
        };
        match (whole, part) {
            (Some(_), Some(part)) => {
                let clear = separation(&shapes[i], &pa.pose(part.time), &shapes[j], &pb.pose(part.time)).distance;
                assert!(clear > 0.0 && part.certain, "{part:?} {pa:?} {pb:?}");
                hits += 1;
            }
            (None, None) => {}
            // A pass within the tolerance may be reported or not.
            (Some(graze), None) => {
                let after = graze.time + 1e-6;
                assert!(
                    after > 1.0 || separation(&shapes[i], &pa.pose(after), &shapes[j], &pb.pose(after)).distance > 0.0
                );
                grazes += 1;
            }
            (None, Some(_)) => panic!("kept faces touch, all do not: {pa:?} {pb:?}"),
        }
    }
    println!(
        "{tested} motions, {hits} contacts, {grazes} grazes; kept {:.1} % of the faces, {:.1} % of the pairs of faces; \
         time of impact {:.1} µs with all, {:.1} µs with the kept",
        100.0 * faces as f64 / all as f64,
        100.0 * pairs / all_pairs,
        whole_time.as_secs_f64() * 1e6 / f64::from(tested),
        part_time.as_secs_f64() * 1e6 / f64::from(tested)
    );
    assert!(hits > tested / 5 && hits < tested && grazes * 1000 <= tested, "{tested} {hits} {grazes}");
    assert!(pairs < 0.8 * all_pairs);
}
