//! Point projection, penetration, fits, hulls, meshes: compared with sampling, and checked for invariants.

use std::sync::Arc;

use crate::common::{CONVEX, RandomGeometry, SplitMix, cases};
use elbowroom_proximity::{
    ConvexHull, HullError, MeshError, Shape, TriMesh, collides, fit, penetration, project_point, separation,
    tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};

#[test]
fn projected_points_lie_on_the_surface_along_the_normal() {
    let mut rng = SplitMix(22);
    for kind in ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"] {
        for _ in 0..cases(4_000) / 2 {
            let (s, pose, p) = (rng.shape(kind), rng.pose(1.0), rng.vec(1.5));
            let found = project_point(&s, &pose, p);
            let back = found.on_surface + found.outward * found.signed_distance;
            assert!((back - p).length() < 1e-12, "{kind}: {found:?}");
            assert!((found.outward.length() - 1.0).abs() < 1e-12);
            assert!(project_point(&s, &pose, found.on_surface).signed_distance.abs() < 1e-12, "{kind}: {found:?}");
            let as_point = Shape::Sphere(elbowroom_proximity::Sphere { radius: 0.0 });
            let distance = separation(&as_point, &Pose::from_translation(p), &s, &pose).distance;
            assert!((distance - found.signed_distance.max(0.0)).abs() < 1e-13, "{kind}: {distance} {found:?}");
        }
    }
}

#[test]
fn moving_by_the_penetration_depth_separates_and_by_less_does_not() {
    let mut rng = SplitMix(23);
    for first in CONVEX.into_iter().chain(["mesh"]) {
        for second in CONVEX.into_iter().chain(["mesh", "plane"]) {
            for _ in 0..12 {
                let (a, b, pa, pb) = (rng.shape(first), rng.shape(second), rng.pose(0.5), rng.pose(0.5));
                let Some(overlap) = penetration(&a, &pa, &b, &pb) else {
                    assert!(!collides(&a, &pa, &b, &pb));
                    continue;
                };
                let moved = |k: f64| Pose::new(pa.rotation, pa.translation + overlap.direction * k);
                assert!((overlap.direction.length() - 1.0).abs() < 1e-9, "{first} {second} {overlap:?}");
                assert!(
                    !collides(&a, &moved(overlap.depth + 1e-7), &b, &pb),
                    "{first} {second} {overlap:?}\n{a:?}{pa:?}\n{b:?}{pb:?}"
                );
                if overlap.depth > 1e-6 && first != "mesh" && second != "mesh" {
                    assert!(
                        collides(&a, &moved(overlap.depth * 0.9), &b, &pb),
                        "{first} {second}: too far, {overlap:?}"
                    );
                }
            }
        }
    }
}

/// Overlap along a direction of the world: every shorter translation along it leaves the shapes overlapping.
fn overlap_along(a: &Shape, pa: &Pose, b: &Shape, pb: &Pose, d: Vec3) -> f64 {
    let low = pa.transform_point(a.support(pa.inverse_transform_vector(-d)));
    let high = pb.transform_point(b.support(pb.inverse_transform_vector(d)));
    (high - low).dot(d)
}

#[test]
fn penetration_of_primitives_is_the_least() {
    let mut rng = SplitMix(28);
    let kinds = ["sphere", "capsule", "cylinder", "box"];
    for (first, second) in kinds.iter().flat_map(|a| kinds.map(|b| (*a, b))) {
        let mut overlapping = 0;
        while overlapping < cases(300) {
            let (a, b, pa, pb) = (rng.shape(first), rng.shape(second), rng.pose(0.5), rng.pose(0.5));
            let Some(overlap) = penetration(&a, &pa, &b, &pb) else { continue };
            overlapping += 1;
            let what = || format!("{overlap:?}\n{a:?} {pa:?}\n{b:?} {pb:?}");
            assert!(overlap.depth >= 0.0 && (overlap.direction.length() - 1.0).abs() < 1e-12, "{}", what());
            let along = overlap_along(&a, &pa, &b, &pb, overlap.direction);
            assert!(along <= overlap.depth + 1e-13, "{along} does not separate: {}", what());
            // Brute force: random directions, and directions near the answer.
            for k in 0..300 {
                let near = if k % 2 == 0 { 10_f64.powf(rng.between(-6.0, 0.0)) } else { 100.0 };
                let Some(d) = (overlap.direction + rng.vec(near)).try_normalize() else { continue };
                let other = overlap_along(&a, &pa, &b, &pb, d);
                assert!(overlap.depth <= other + 1e-9, "{first} {second}: {other} along {d:?} is shorter: {}", what());
            }
        }
    }
}

fn check_encloses(fit: &fit::Fit, points: &[Vec3]) {
    for &p in points {
        assert!(project_point(&fit.shape, &fit.in_frame, p).signed_distance <= 0.0, "{p:?} is outside {fit:?}");
    }
}

#[test]
fn fits_enclose_every_point_and_are_tight() {
    let mut rng = SplitMix(24);
    for case in 0..40 {
        let stretch = Vec3::new(1.0, rng.between(0.1, 1.0), rng.between(0.05, 0.5));
        let pose = rng.pose(2.0);
        let points: Vec<Vec3> = (0..300).map(|_| pose.transform_point(rng.vec(0.3).scale(stretch))).collect();
        let hull = ConvexHull::from_points(&points).unwrap();
        let fits = [fit::capsule(&points), fit::cuboid(&points), fit::sphere(&points), fit::tightest(&points)];
        let fits = fits.map(Option::unwrap);
        for fit in &fits {
            check_encloses(fit, &points);
        }
        let ratio = fits.each_ref().map(|f| f.volume / hull.volume());
        println!("cloud {case}: capsule {:.2}, box {:.2}, sphere {:.2} times the hull", ratio[0], ratio[1], ratio[2]);
        assert!(ratio[1] < 1.6, "a cloud filled evenly from a box is {} times looser", ratio[1]);
        assert!(fits[3].volume <= fits[0].volume.min(fits[1].volume));
    }
    for few in [&[Vec3::X][..], &[Vec3::X, Vec3::Y], &[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)]] {
        [fit::capsule(few), fit::cuboid(few), fit::sphere(few), fit::tightest(few)]
            .iter()
            .flatten()
            .for_each(|f| check_encloses(f, few));
        assert!(fit::tightest(few).is_some());
    }
    assert!(fit::tightest(&[]).is_none() && fit::sphere(&[Vec3::splat(f64::NAN)]).is_none());
}

#[test]
fn hulls_contain_their_points_and_refuse_flat_input() {
    let mut rng = SplitMix(25);
    for _ in 0..200 {
        let n = 4 + rng.below(200);
        let grid = rng.below(2) == 0; // many coplanar, collinear and equal points
        let points: Vec<Vec3> = (0..n)
            .map(|_| rng.vec(2.0))
            .map(|p| if grid { Vec3::new(p.x.round(), p.y.round(), p.z.round()) } else { p })
            .collect();
        let Ok(hull) = ConvexHull::from_points(&points) else {
            assert!(grid && n < 12, "refused {n} points");
            continue;
        };
        let shape = Shape::Hull(Arc::new(hull.clone()));
        for &p in &points {
            assert!(project_point(&shape, &Pose::IDENTITY, p).signed_distance < 1e-11);
        }
        let report = *TriMesh::new(hull.vertices().to_vec(), hull.triangles().to_vec()).unwrap().report();
        assert!(report.closed && !report.inside_out && (report.volume - hull.volume()).abs() < 1e-12);
    }
    let line: Vec<Vec3> = (0..9).map(|i| Vec3::new(1.0, 2.0, 3.0) * f64::from(i)).collect();
    let flat: Vec<Vec3> = (0..9).map(|i| Vec3::new(f64::from(i), f64::from(i * i), 1.0)).collect();
    assert_eq!(ConvexHull::from_points(&[Vec3::X; 9]), Err(HullError::Point));
    assert_eq!(ConvexHull::from_points(&line), Err(HullError::Line));
    assert_eq!(ConvexHull::from_points(&flat), Err(HullError::Flat));
    assert_eq!(ConvexHull::from_points(&flat[..3]), Err(HullError::TooFew(3)));
    assert_eq!(ConvexHull::from_points(&[Vec3::splat(f64::NAN); 5]), Err(HullError::NotFinite(0)));
}

fn ball_mesh(radius: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    tessellate(&Shape::Sphere(elbowroom_proximity::Sphere { radius }), radius * 2e-2)
}

#[test]
fn meshes_report_and_refuse() {
    let (v, t) = ball_mesh(1.0);
    let good = *TriMesh::new(v.clone(), t.clone()).unwrap().report();
    assert!(good.closed && !good.inside_out && good.degenerate == 0 && good.duplicate == 0);
    let flipped = t.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    assert!(TriMesh::new(v.clone(), flipped).unwrap().report().inside_out);
    assert!(!TriMesh::new(v.clone(), t[1..].to_vec()).unwrap().report().closed);
    let twice = t.iter().chain(&t[..1]).copied().chain([[0, 0, 1]]).collect();
    let report = *TriMesh::new(v.clone(), twice).unwrap().report();
    assert_eq!((report.duplicate, report.degenerate), (1, 1));
    // The triangles are as in an STL file: each has its own vertices.
    let soup: Vec<Vec3> = t.iter().flatten().map(|&i| v[i as usize]).collect();
    let faces = (0..t.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    assert!(TriMesh::new(soup, faces).unwrap().report().closed);
    assert_eq!(TriMesh::new(v.clone(), vec![]).unwrap_err(), MeshError::Empty);
    assert_eq!(TriMesh::new(vec![Vec3::splat(f64::NAN)], t).unwrap_err(), MeshError::NotFinite { vertex: 0 });
}

#[test]
fn meshes_of_hulls_have_the_distances_of_the_hulls() {
    let mut rng = SplitMix(26);
    for _ in 0..cases(600) / 2 {
        let solid = rng.shape("hull");
        let (v, t) = tessellate(&solid, 0.01);
        let mesh = Shape::Mesh(Arc::new(TriMesh::new(v, t).unwrap()));
        let (pose, at) = (rng.pose(1.2), rng.pose(1.2));
        for kind in ["sphere", "capsule", "cylinder", "box", "hull", "mesh", "plane"] {
            let other = rng.shape(kind);
            let (m, h) = (separation(&mesh, &pose, &other, &at), separation(&solid, &pose, &other, &at));
            assert!((m.distance - h.distance).abs() < 1e-10, "{kind}: {m:?} {h:?}");
            assert!(
                m.lower_bound <= h.distance + 1e-12 && collides(&mesh, &pose, &other, &at) == (m.distance <= 1e-13)
            );
        }
    }
}

#[test]
fn a_solid_inside_a_closed_mesh_collides_and_in_its_cavity_is_free() {
    let (mut v, mut t) = ball_mesh(1.0);
    let outer = Shape::Mesh(Arc::new(TriMesh::new(v.clone(), t.clone()).unwrap()));
    let (inner_v, inner_t) = ball_mesh(0.5);
    let small =
        Shape::Mesh(Arc::new(TriMesh::new(inner_v.iter().map(|&p| p * 0.2).collect(), inner_t.clone()).unwrap()));
    let first = v.len() as u32;
    v.extend(inner_v);
    t.extend(inner_t.iter().map(|[a, b, c]| [a + first, c + first, b + first]));
    let shell = Shape::Mesh(Arc::new(TriMesh::new(v, t).unwrap()));
    let mut rng = SplitMix(27);
    for _ in 0..50 {
        let pose = Pose::new(Rotation::from_rotation_vector(rng.vec(3.0)), rng.vec(0.05));
        for other in [&small, &Shape::Sphere(elbowroom_proximity::Sphere { radius: 0.1 })] {
            assert_eq!(separation(other, &pose, &outer, &Pose::IDENTITY).distance, 0.0);
            assert_eq!(separation(&outer, &Pose::IDENTITY, other, &pose).distance, 0.0);
            assert!(separation(other, &pose, &shell, &Pose::IDENTITY).distance > 0.2);
        }
        assert!(project_point(&outer, &pose, pose.translation).signed_distance < -0.9);
    }
}

#[test]
fn vertices_of_a_hull_are_on_its_surface() {
    let capsule = Shape::Capsule(elbowroom_proximity::Capsule { half_length: 0.2, radius: 0.1 });
    for chord in [0.02, 0.004, 0.001] {
        let (vertices, _) = elbowroom_proximity::tessellate::tessellate(&capsule, chord);
        let hull = Arc::new(ConvexHull::from_points(&vertices).unwrap());
        let ball = Shape::Sphere(elbowroom_proximity::Sphere { radius: 1e-6 });
        for &v in hull.vertices() {
            let s = separation(&ball, &Pose::from_translation(v), &Shape::Hull(hull.clone()), &Pose::IDENTITY);
            assert!(s.distance == 0.0 && s.lower_bound == 0.0, "{v:?}: {s:?}");
            let p = project_point(&Shape::Hull(hull.clone()), &Pose::IDENTITY, v);
            assert!(p.signed_distance.abs() < 1e-12, "{v:?}: {p:?}");
        }
    }
}
