//! Closed meshes whose faces have their own corners with small offsets, as in files of single precision.

use std::sync::Arc;

use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::advanced::{colliding_triangles, mesh_separation};
use elbowroom_proximity::{
    Shape, Sphere, TriMesh, Workspace, collides, project_point, separation, tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Vec3};

/// Triangles with their own corners, each offset by up to `off`.
fn soup(rng: &mut SplitMix, shape: &Shape, off: f64) -> TriMesh {
    let (v, t) = tessellate(shape, 0.01);
    let corners: Vec<Vec3> = t.iter().flatten().map(|&i| v[i as usize] + rng.vec(off)).collect();
    let faces = (0..t.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh::new(corners, faces).unwrap()
}

/// Volume of the triangles with shared corners.
fn volume_of(shape: &Shape) -> f64 {
    let (v, t) = tessellate(shape, 0.01);
    TriMesh::new(v, t).unwrap().report().volume
}

#[test]
fn shapes_inside_a_mesh_with_hairline_seams_collide() {
    let mut rng = SplitMix(15);
    for case in 0..120 {
        let kind = ["box", "cylinder", "hull", "capsule"][case % 4];
        let hull = rng.shape(kind);
        if hull.volume() < 1e-4 {
            continue;
        }
        let outer = soup(&mut rng, &hull, [1e-12, 1e-9, 3e-8][case % 3]);
        let report = outer.report();
        assert!(report.closed && report.welded > 0, "case {case}, {kind}: {report:?}");
        assert!((report.volume - volume_of(&hull)).abs() < 1e-6 * (1.0 + report.volume), "{report:?}");
        let around = rng.pose(1.0);
        let small = soup(&mut rng, &Shape::Sphere(Sphere { radius: 1e-3 }), 1e-12);
        let corners = outer.vertices();
        let inner = corners.iter().fold(Vec3::ZERO, |sum, p| sum + *p) / corners.len() as f64;
        let middle = around * Pose::from_translation(inner);
        let workspace = &mut Workspace::new();
        assert!(
            colliding_triangles(&outer, &around, &small, &middle, workspace).is_some(),
            "case {case}: a mesh inside is free"
        );
        assert_eq!(mesh_separation(&outer, &around, &small, &middle, workspace).distance, 0.0, "case {case}");
        let (ball, solid) = (Shape::Sphere(Sphere { radius: 1e-3 }), Shape::Mesh(Arc::new(outer)));
        assert!(collides(&ball, &middle, &solid, &around), "case {case}: a ball inside is free");
        assert!(project_point(&solid, &around, middle.translation).signed_distance < 0.0, "case {case}");
        let beside = Pose::from_translation(around.translation + Vec3::X * 5.0);
        assert!(separation(&ball, &beside, &solid, &around).distance > 1.0, "case {case}: outside is free");
    }
}

#[test]
fn point_containment_matches_the_mesh_without_seams() {
    let mut rng = SplitMix(150);
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

/// Distances are measured to the triangles as given, not to the welded triangles.
#[test]
fn distances_are_to_the_triangles_as_given() {
    let mut rng = SplitMix(151);
    let outer = soup(&mut rng, &Shape::Cuboid(elbowroom_proximity::Cuboid { half_extents: Vec3::splat(0.5) }), 4e-7);
    assert!(outer.report().closed);
    let corner = outer.vertices()[0];
    let ball = Shape::Sphere(Sphere { radius: 0.0 });
    let solid = Shape::Mesh(Arc::new(outer));
    let at = separation(&ball, &Pose::from_translation(corner), &solid, &Pose::IDENTITY);
    assert!(at.distance < 1e-15, "{at:?}");
}

#[test]
fn holes_stay_open_and_clean_meshes_are_unchanged() {
    let (v, t) = tessellate(&Shape::Sphere(Sphere { radius: 1.0 }), 0.01);
    let clean = TriMesh::new(v.clone(), t.clone()).unwrap();
    assert!(clean.report().closed && clean.report().welded == 0 && clean.report().weld_tolerance == 0.0);
    let holed = TriMesh::new(v, t[1..].to_vec()).unwrap();
    assert!(!holed.report().closed && holed.report().welded == 0 && !holed.contains(Vec3::ZERO));
}

/// A seam and a hole in one component: the hole leaves it open.
#[test]
fn a_seam_does_not_close_a_hole() {
    let mut rng = SplitMix(152);
    let outer = soup(&mut rng, &Shape::Sphere(Sphere { radius: 1.0 }), 1e-9);
    let holed = TriMesh::new(outer.vertices().to_vec(), outer.triangles()[1..].to_vec()).unwrap();
    assert!(!holed.report().closed && holed.report().welded > 0 && !holed.has_interior());
    let [a, b, c] = holed.triangles()[0].map(|i| holed.welded_vertices()[i as usize]);
    assert!(a != b && b != c && c != a);
}
