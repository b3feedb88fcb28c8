//! Witness points of parallel faces and edges change continuously under tiny tilts.

use std::sync::Arc;

use crate::common::SplitMix;
use elbowroom_proximity::advanced::{mesh_separation, mesh_separation_with};
use elbowroom_proximity::{
    Capsule, ConvexHull, Cuboid, Cylinder, DistanceSettings, Separation, Shape, TriMesh, WarmStart, WitnessPoints,
    Workspace, project_point, separation, tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};

const KINDS: [&str; 3] = ["box", "hull", "mesh"];

fn plate(kind: &str, half: Vec3) -> Shape {
    let plate = Shape::Cuboid(Cuboid { half_extents: half });
    let (v, t) = tessellate(&plate, 1.0);
    match kind {
        "box" => plate,
        "hull" => Shape::Hull(Arc::new(ConvexHull::from_points(&v).unwrap())),
        _ => Shape::Mesh(Arc::new(TriMesh::new(v, t).unwrap())),
    }
}

/// Steps of the witness points over small tilts, metres; the bounds of every answer are checked as well.
fn steps(a: &Shape, b: &Shape, b_in_a: impl Fn(&mut SplitMix) -> Pose, a_in_world: &Pose, size: f64) -> Vec<f64> {
    let mut rng = SplitMix(16);
    let mut last: Option<Separation> = None;
    let mut found = Vec::new();
    for _ in 0..400 {
        let there = *a_in_world * b_in_a(&mut rng);
        let s = separation(a, a_in_world, b, &there);
        let apart = s.on_a.distance(s.on_b);
        assert!(
            s.lower_bound <= s.distance && s.distance <= apart + 1e-12 && apart <= s.distance + 3e-8 * size,
            "{s:?}"
        );
        for (shape, pose, p) in [(a, a_in_world, s.on_a), (b, &there, s.on_b)] {
            let off = project_point(shape, pose, p).signed_distance.abs();
            assert!(off <= 1e-12, "a witness point is {off:e} m from its surface: {s:?}");
        }
        if let Some(last) = last {
            found.push(s.on_a.distance(last.on_a).max(s.on_b.distance(last.on_b)));
        }
        last = Some(s);
    }
    found
}

fn tilted(rng: &mut SplitMix, most: f64, at: Vec3) -> Pose {
    Pose::new(Rotation::from_rpy(rng.between(-most, most), rng.between(-most, most), 0.0), at)
}

#[test]
fn parallel_plates_have_continuous_points() {
    let worlds = [Pose::IDENTITY, Pose::new(Rotation::from_rpy(0.3, -0.5, 1.1), Vec3::new(1.0, 2.0, -0.7))];
    for first in KINDS {
        for second in KINDS {
            let (a, b) = (plate(first, Vec3::new(0.4, 0.3, 0.01)), plate(second, Vec3::new(0.35, 0.3, 0.02)));
            for gap in [1e-6, 1e-3, 0.1] {
                for world in &worlds {
                    let at = Vec3::new(0.12, -0.07, 0.03 + gap);
                    let found = steps(&a, &b, |rng| tilted(rng, 1e-9, at), world, 1.0);
                    let worst = found.iter().copied().fold(0.0, f64::max);
                    assert!(worst < 5e-3, "{first} {second}, {gap} m: a step of {worst} m");
                }
            }
        }
    }
}

/// Cylinders and capsules on their ends, parallel to faces and parallel to each other.
#[test]
fn cylinders_and_capsules_have_continuous_points() {
    let lying = Rotation::from_rpy(0.0, std::f64::consts::FRAC_PI_2, 0.4);
    let pillar = Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.25 });
    let rod = Shape::Capsule(Capsule { half_length: 0.3, radius: 0.05 });
    // Orientation on a plane, and the height of the centre.
    let placements = [(&pillar, Rotation::IDENTITY, 0.3), (&pillar, lying, 0.25), (&rod, lying, 0.05)];
    for kind in KINDS {
        let floor = plate(kind, Vec3::new(0.9, 0.8, 0.1));
        for (shape, turn, height) in placements {
            let at = |rng: &mut SplitMix| {
                tilted(rng, 1e-9, Vec3::new(0.1, 0.05, 0.1 + height + 0.02)) * Pose::new(turn, Vec3::ZERO)
            };
            let worst = steps(&floor, shape, at, &Pose::IDENTITY, 1.5).into_iter().fold(0.0, f64::max);
            assert!(worst < 5e-3, "{shape:?} over {kind}: a step of {worst} m");
        }
    }
    for (first, below) in [(&pillar, 0.25), (&rod, 0.05)] {
        for (second, above) in [(&pillar, 0.25), (&rod, 0.05)] {
            let world = Pose::new(lying, Vec3::ZERO);
            let up = world.inverse_transform_vector(Vec3::Z * (below + above + 0.02));
            let at = |rng: &mut SplitMix| tilted(rng, 1e-9, up + Vec3::Z * 0.1);
            let worst = steps(first, second, at, &world, 1.0).into_iter().fold(0.0, f64::max);
            assert!(worst < 5e-3, "{first:?} along {second:?}: a step of {worst} m");
        }
    }
    let standing = |rng: &mut SplitMix| tilted(rng, 1e-9, Vec3::new(0.1, 0.0, 0.65));
    let worst = steps(&pillar, &pillar, standing, &Pose::IDENTITY, 1.0).into_iter().fold(0.0, f64::max);
    assert!(worst < 5e-3, "one on the other: a step of {worst} m");
}

/// For parallel faces, the points are in the centre of the patch in which they overlap.
#[test]
fn the_points_are_in_the_middle_of_the_patch() {
    for kind in KINDS {
        let a = plate(kind, Vec3::new(0.4, 0.3, 0.01));
        let there = Pose::from_translation(Vec3::new(0.2, 0.1, 0.05));
        let s = separation(&a, &Pose::IDENTITY, &a, &there);
        assert!(s.on_a.distance(Vec3::new(0.1, 0.05, 0.01)) < 1e-6, "{kind}: {s:?}");
        assert!(s.on_b.distance(Vec3::new(0.1, 0.05, 0.04)) < 1e-6, "{kind}: {s:?}");
    }
}

/// Two parallel edges, and an edge over a face.
#[test]
fn parallel_edges_have_continuous_points() {
    let quarter = std::f64::consts::FRAC_PI_4;
    for kind in KINDS {
        let (a, b) = (plate(kind, Vec3::new(0.4, 0.1, 0.1)), plate(kind, Vec3::new(0.3, 0.1, 0.1)));
        let roll = Pose::new(Rotation::from_rpy(quarter, 0.0, 0.0), Vec3::ZERO);
        for (world, height) in [(roll, 0.2 * 2.0_f64.sqrt()), (Pose::IDENTITY, 0.1 + 0.1 * 2.0_f64.sqrt())] {
            let at =
                world.inverse() * Pose::new(Rotation::from_rpy(quarter, 0.0, 0.0), Vec3::new(0.1, 0.0, height + 0.05));
            let tilt = |rng: &mut SplitMix| {
                Pose::new(
                    at.rotation * Rotation::from_rpy(0.0, rng.between(-1e-9, 1e-9), rng.between(-1e-9, 1e-9)),
                    at.translation,
                )
            };
            let worst = steps(&a, &b, tilt, &world, 1.0).into_iter().fold(0.0, f64::max);
            assert!(worst < 5e-3, "{kind}: a step of {worst} m");
        }
    }
}

/// For four feet of a table over a floor, always the same foot is chosen.
#[test]
fn of_several_tied_features_always_the_same_is_chosen() {
    let mut corners = Vec::new();
    for (x, y) in [(-0.4, -0.3), (0.4, -0.3), (0.4, 0.3), (-0.4, 0.3)] {
        let foot = Vec3::new(x, y, 0.0);
        corners.extend([foot, foot + Vec3::new(0.05, 0.0, 0.5), foot + Vec3::new(0.0, 0.05, 0.5)]);
    }
    let faces = (0..4).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let table = Shape::Mesh(Arc::new(TriMesh::new(corners, faces).unwrap()));
    let floor = plate("mesh", Vec3::new(1.0, 1.0, 0.1));
    let found = steps(&floor, &table, |rng| tilted(rng, 1e-9, Vec3::new(0.05, 0.02, 0.12)), &Pose::IDENTITY, 2.5);
    let jumps = found.iter().filter(|step| **step > 5e-3).count();
    assert_eq!(jumps, 0);
}

/// Subdivided faces: the answer does not depend on the warm start.
#[test]
fn subdivided_faces_have_one_answer() {
    let mut rng = SplitMix(161);
    let cut = |n: u32| {
        let at = |i: u32, j: u32| Vec3::new(f64::from(i) / f64::from(n) - 0.5, f64::from(j) / f64::from(n) - 0.5, 0.0);
        let corners = (0..=n).flat_map(|i| (0..=n).map(move |j| at(i, j))).collect();
        let v = |i, j| i * (n + 1) + j;
        let quads = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let faces =
            quads.flat_map(|(i, j)| [[v(i, j), v(i + 1, j), v(i + 1, j + 1)], [v(i, j), v(i + 1, j + 1), v(i, j + 1)]]);
        TriMesh::new(corners, faces.collect()).unwrap()
    };
    let (a, b) = (cut(17), cut(12));
    let (mut warm_start, mut last) = (WarmStart::default(), None::<Vec3>);
    let (mut cold, mut warm) = (Workspace::new(), Workspace::new());
    for _ in 0..60 {
        let there = tilted(&mut rng, 1e-9, Vec3::new(0.21, 0.13, 0.02));
        let fresh = mesh_separation(&a, &Pose::IDENTITY, &b, &there, &mut cold);
        let settings = DistanceSettings { warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
        let again = mesh_separation_with(&a, &Pose::IDENTITY, &b, &there, settings, &mut warm).unwrap();
        assert_eq!((fresh, cold.closest_features()), (again, warm.closest_features()));
        assert!(last.is_none_or(|p| p.distance(fresh.on_a) < 5e-3), "{fresh:?}");
        last = Some(fresh.on_a);
    }
}

/// Without continuous witness points the distance is the same.
#[test]
fn any_witness_points_have_the_same_distance() {
    let mut rng = SplitMix(162);
    let mut workspace = Workspace::new();
    for (first, second) in KINDS.iter().flat_map(|a| KINDS.map(|b| (*a, b))) {
        let (a, b) = (plate(first, Vec3::new(0.4, 0.3, 0.01)), plate(second, Vec3::new(0.35, 0.3, 0.02)));
        for _ in 0..20 {
            let there = tilted(&mut rng, 1e-9, Vec3::new(0.12, -0.07, 0.05));
            let mut with = |witness_points| {
                let settings = DistanceSettings { witness_points, ..DistanceSettings::default() };
                workspace.separation(&a, &Pose::IDENTITY, &b, &there, settings).unwrap()
            };
            let (continuous, any) = (with(WitnessPoints::Continuous), with(WitnessPoints::Any));
            assert_eq!((continuous.distance, continuous.lower_bound), (any.distance, any.lower_bound));
            assert!((any.on_a.distance(any.on_b) - any.distance).abs() < 1e-12, "{first} {second}: {any:?}");
        }
    }
}

#[test]
fn triangles_beside_solids_are_counted() {
    let mut workspace = Workspace::new();
    let mesh = plate("mesh", Vec3::new(0.4, 0.3, 0.01));
    let mut measured = |above: &Shape, limit: f64, witness_points: WitnessPoints| {
        let there = Pose::from_translation(Vec3::Z * 0.1);
        let settings = DistanceSettings { limit, witness_points, ..Default::default() };
        workspace.separation(above, &there, &mesh, &Pose::IDENTITY, settings);
        workspace.stats().triangles_beside_solids
    };
    let (any, continuous, far) = (WitnessPoints::Any, WitnessPoints::Continuous, f64::INFINITY);
    let ball = Shape::Sphere(elbowroom_proximity::Sphere { radius: 0.02 });
    let of_ball = measured(&ball, far, any);
    assert!((1..=12).contains(&of_ball), "a plate has twelve triangles: {of_ball}");
    assert_eq!(measured(&ball, 0.01, any), 0, "beyond the limit nothing is measured");
    let parallel = plate("box", Vec3::new(0.4, 0.3, 0.02));
    let [first, both] = [any, continuous].map(|points| measured(&parallel, far, points));
    assert!(0 < first && first < both, "parallel faces are compared once more for their points: {first} {both}");
    assert_eq!(measured(&plate("mesh", Vec3::splat(0.02)), far, any), 0, "of two meshes");
    let table = Pose::from_translation(Vec3::Z * -0.1);
    workspace.within(&mesh, &Pose::IDENTITY, &Shape::HalfSpace(elbowroom_proximity::HalfSpace), &table, 1.0);
    assert!((1..=12).contains(&workspace.stats().triangles_beside_solids));
}
