//! Closed meshes whose faces have corners of their own, a hair off: as files in single precision are.

mod common;

use std::sync::Arc;

use common::Rng;
use elbowroom_proximity::mesh::{Scratch, collide, distance};
use elbowroom_proximity::{Shape, Sphere, TriMesh, collides, project_point, separation, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};

/// Triangles with corners of their own, each off by up to `off`.
fn soup(rng: &mut Rng, shape: &Shape, off: f64) -> TriMesh {
    let (v, t) = tessellate(shape, 0.01);
    let corners: Vec<Vec3> = t.iter().flatten().map(|&i| v[i as usize] + rng.vec(off)).collect();
    let faces = (0..t.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh::new(corners, faces).unwrap()
}

/// Volume of the triangles before they were taken apart.
fn drawn(shape: &Shape) -> f64 {
    let (v, t) = tessellate(shape, 0.01);
    TriMesh::new(v, t).unwrap().report().volume
}

#[test]
fn what_is_inside_of_hairline_seams_collides() {
    let mut rng = Rng(15);
    for case in 0..120 {
        let kind = ["box", "cylinder", "hull", "capsule"][case % 4];
        let hull = rng.shape(kind);
        if hull.volume() < 1e-4 {
            continue;
        }
        let room = soup(&mut rng, &hull, [1e-12, 1e-9, 3e-8][case % 3]);
        let report = room.report();
        assert!(report.closed && report.welded > 0, "case {case}, {kind}: {report:?}");
        assert!((report.volume - drawn(&hull)).abs() < 1e-6 * (1.0 + report.volume), "{report:?}");
        let around = rng.pose(1.0);
        let small = soup(&mut rng, &Shape::Sphere(Sphere { radius: 1e-3 }), 1e-12);
        let corners = room.vertices();
        let inner = corners.iter().fold(Vec3::ZERO, |sum, p| sum + *p) / corners.len() as f64;
        let middle = around * Pose::from_translation(inner);
        let scratch = &mut Scratch::new();
        assert!(collide(&room, &around, &small, &middle, scratch).is_some(), "case {case}: a mesh inside is free");
        assert_eq!(distance(&room, &around, &small, &middle, scratch).distance, 0.0, "case {case}");
        let (ball, solid) = (Shape::Sphere(Sphere { radius: 1e-3 }), Shape::Mesh(Arc::new(room)));
        assert!(collides(&ball, &middle, &solid, &around), "case {case}: a ball inside is free");
        assert!(project_point(&solid, &around, middle.translation).signed_distance < 0.0, "case {case}");
        let beside = Pose::from_translation(around.translation + Vec3::X * 5.0);
        assert!(separation(&ball, &beside, &solid, &around).distance > 1.0, "case {case}: outside is free");
    }
}

#[test]
fn points_are_inside_as_of_the_mesh_without_seams() {
    let mut rng = Rng(150);
    for _ in 0..20 {
        let hull = rng.shape("hull");
        let (v, t) = tessellate(&hull, 0.01);
        let (whole, seamed) = (TriMesh::new(v, t).unwrap(), soup(&mut rng, &hull, 1e-8));
        let solid = Shape::Mesh(Arc::new(whole.clone()));
        for _ in 0..300 {
            let p = rng.vec(1.0);
            if project_point(&solid, &Pose::IDENTITY, p).signed_distance.abs() > 1e-7 {
                assert_eq!(seamed.contains(p), whole.contains(p), "{p:?}");
            }
        }
    }
}

/// The surface that is measured is the one that was given.
#[test]
fn distances_are_to_the_triangles_as_given() {
    let mut rng = Rng(151);
    let room = soup(&mut rng, &Shape::Cuboid(elbowroom_proximity::Cuboid { half_extents: Vec3::splat(0.5) }), 4e-7);
    assert!(room.report().closed);
    let corner = room.vertices()[0];
    let ball = Shape::Sphere(Sphere { radius: 0.0 });
    let solid = Shape::Mesh(Arc::new(room));
    let at = separation(&ball, &Pose::from_translation(corner), &solid, &Pose::IDENTITY);
    assert!(at.distance < 1e-15, "{at:?}");
}

#[test]
fn holes_stay_open_and_clean_meshes_are_left_alone() {
    let (v, t) = tessellate(&Shape::Sphere(Sphere { radius: 1.0 }), 0.01);
    let clean = TriMesh::new(v.clone(), t.clone()).unwrap();
    assert!(clean.report().closed && clean.report().welded == 0 && clean.report().weld_tolerance == 0.0);
    let holed = TriMesh::new(v, t[1..].to_vec()).unwrap();
    assert!(!holed.report().closed && holed.report().welded == 0 && !holed.contains(Vec3::ZERO));
}

/// A seam and a hole in one part: the hole leaves it open.
#[test]
fn a_seam_does_not_close_a_hole() {
    let mut rng = Rng(152);
    let room = soup(&mut rng, &Shape::Sphere(Sphere { radius: 1.0 }), 1e-9);
    let holed = TriMesh::new(room.vertices().to_vec(), room.triangles()[1..].to_vec()).unwrap();
    assert!(!holed.report().closed && holed.report().welded > 0 && !holed.has_inside());
    let [a, b, c] = holed.triangles()[0].map(|i| holed.joined()[i as usize]);
    assert!(a != b && b != c && c != a);
}
