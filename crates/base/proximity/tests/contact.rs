//! Contact points compared with all pairs of triangles and with the surfaces.

use std::sync::Arc;

use crate::common::{CONVEX, RandomGeometry, SplitMix};
use elbowroom_proximity::advanced::{MeshFeatures, for_each_contact};
use elbowroom_proximity::contact::{ContactPoint, ContactSettings, Detail, contact_point};
use elbowroom_proximity::{
    Cuboid, HalfSpace, Shape, ShapeKind, TriMesh, Workspace, collides, penetration, project_point, separation,
    tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// A wavy ball, tessellated to a tolerance: closed and oriented outward, but not convex.
fn lump(r: &mut SplitMix, fine: f64) -> Shape {
    let (stretch, wave) =
        (Vec3::new(r.between(0.5, 1.5), r.between(0.5, 1.5), r.between(0.5, 1.5)), r.between(0.0, 0.4));
    Shape::Mesh(Arc::new(crate::common::lump(0.3, fine, stretch, wave)))
}

fn placed(shape: &Shape, in_world: &Pose, triangle: u32) -> [Vec3; 3] {
    let Shape::Mesh(m) = shape else { panic!("no mesh") };
    m.triangles()[triangle as usize].map(|i| in_world.transform_point(m.vertices()[i as usize]))
}

/// The point in which the segment from `p` to `q` intersects the triangle, if any (Möller and Trumbore).
fn pierced(p: Vec3, q: Vec3, [a, b, c]: [Vec3; 3]) -> Option<Vec3> {
    let (d, e1, e2, from) = (q - p, b - a, c - a, p - a);
    let det = e1.dot(d.cross(e2));
    let (u, v, t) = (from.dot(d.cross(e2)) / det, d.dot(from.cross(e1)) / det, e2.dot(from.cross(e1)) / det);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)).then(|| p + d * t)
}

/// Length of the segment in which two triangles cross.
fn crossing(s: [Vec3; 3], t: [Vec3; 3]) -> f64 {
    let mut points = Vec::new();
    for k in 0..3 {
        points.extend(pierced(s[k], s[(k + 1) % 3], t));
        points.extend(pierced(t[k], t[(k + 1) % 3], s));
    }
    let pairs = points.iter().flat_map(|p| points.iter().map(move |q| p.distance(*q)));
    pairs.fold(0.0, f64::max)
}

fn on_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> bool {
    let n = (b - a).cross(c - a).try_normalize().unwrap();
    let above = |x: Vec3, y: Vec3| n.cross(y - x).try_normalize().unwrap().dot(p - x);
    n.dot(p - a).abs() < 1e-10 && [above(a, b), above(b, c), above(c, a)].iter().all(|h| *h > -1e-10)
}

fn contact(a: &Shape, p: &Pose, b: &Shape, q: &Pose) -> Option<ContactPoint> {
    contact_point(a, p, b, q, ContactSettings::default(), &mut Workspace::new())
}

fn within(limit: f64) -> ContactSettings {
    ContactSettings { limit, ..ContactSettings::default() }
}

#[test]
fn two_meshes_touch_at_the_longest_crossing() {
    let mut r = SplitMix(1);
    let (mut met, mut apart, mut inside) = (0, 0, 0);
    for _ in 0..100 {
        let (a, b) = (lump(&mut r, 0.01), lump(&mut r, 0.02));
        let (mut p, q) = (r.pose(0.2), r.pose(0.5));
        let Shape::Mesh(m) = &a else { unreachable!() };
        let a = if r.below(10) == 0 {
            // The shape is ten times as large, and around the other one.
            p = q;
            let large = m.vertices().iter().map(|v| *v * 10.0).collect();
            Shape::Mesh(Arc::new(TriMesh::new(large, m.triangles().to_vec()).unwrap()))
        } else {
            a
        };
        let found = contact(&a, &p, &b, &q);
        assert_eq!(found.is_some(), collides(&a, &p, &b, &q));
        let Some(c) = found else {
            apart += 1;
            continue;
        };
        let (Shape::Mesh(m), Shape::Mesh(n)) = (&a, &b) else { unreachable!() };
        let (mut longest, mut any) = (0.0_f64, false);
        for_each_contact(m, &p, n, &q, &mut Workspace::new(), |pair| {
            if let MeshFeatures::Triangles(x, y) = pair {
                any = true;
                longest = longest.max(crossing(placed(&a, &p, x), placed(&b, &q, y)));
            }
        });
        if !any {
            inside += 1;
            let on = |s: &Shape, pose: &Pose, x: Vec3| project_point(s, pose, x).signed_distance.abs() < 1e-12;
            assert!(on(&a, &p, c.on_a) && on(&b, &q, c.on_b) && c.on_a.distance(c.on_b) > 0.1, "{c:?}");
            continue;
        }
        met += 1;
        let (s, t) = (placed(&a, &p, c.triangle_a.unwrap()), placed(&b, &q, c.triangle_b.unwrap()));
        assert!((crossing(s, t) - longest).abs() < 1e-8, "{c:?} {longest}");
        assert!(c.on_a == c.on_b && on_triangle(c.on_a, s) && on_triangle(c.on_a, t) && c.touching, "{c:?}");
        for (normal, [x, y, z], shape, pose) in [(c.normal_a, s, &a, &p), (c.normal_b, t, &b, &q)] {
            assert!(normal.dot(y - x).abs() < 1e-9 && normal.dot(z - x).abs() < 1e-9);
            let beside = |h: f64| project_point(shape, pose, c.on_a + normal * h).signed_distance;
            assert!(beside(1e-6) > 0.0 && beside(-1e-6) < 0.0, "outward");
        }
    }
    assert!(met > 30 && apart > 15 && inside > 0, "{met} {apart} {inside}");
}

#[test]
fn a_box_or_hull_touches_as_its_triangles_do() {
    let mut r = SplitMix(2);
    let mut met = 0;
    for k in 0..200 {
        let a = lump(&mut r, 0.02);
        let kind = if k % 2 == 0 { "hull" } else { "box" };
        let half_extents = Vec3::new(r.between(0.1, 0.5), r.between(0.1, 0.5), r.between(0.1, 0.5));
        let b = if k % 2 == 0 { Shape::Hull(Arc::new(r.hull())) } else { Shape::Cuboid(Cuboid { half_extents }) };
        let (v, t) = tessellate(&b, 0.01);
        let same = Shape::Mesh(Arc::new(TriMesh::new(v, t).unwrap()));
        let (p, q) = (r.pose(0.3), r.pose(0.7));
        let (flat, mesh) = (contact(&a, &p, &b, &q), contact(&a, &p, &same, &q));
        assert_eq!(flat.is_some(), mesh.is_some(), "{kind}");
        let (Some(flat), Some(mesh)) = (flat, mesh) else { continue };
        let swapped = contact(&b, &q, &a, &p).unwrap();
        assert!(
            swapped.on_b == flat.on_a && swapped.normal_a == flat.normal_b && swapped.triangle_b == flat.triangle_a
        );
        let on = |c: &ContactPoint| project_point(&b, &q, c.on_a).signed_distance.abs();
        if flat.on_a == flat.on_b {
            met += 1;
            assert!(on(&flat) < 1e-12 && on(&mesh) < 1e-10, "{flat:?}");
            let (x, y) = (placed(&a, &p, flat.triangle_a.unwrap()), placed(&a, &p, mesh.triangle_a.unwrap()));
            assert!(on_triangle(flat.on_a, x) && on_triangle(mesh.on_a, y));
            let below = project_point(&b, &q, flat.on_b - flat.normal_b * 1e-7);
            assert!((below.outward - flat.normal_b).length() < 1e-6 || below.signed_distance > -2e-8, "{flat:?}");
        }
        if kind == "hull" && flat.on_a.distance(mesh.on_a) < 1e-9 {
            assert!((flat.normal_b - mesh.normal_b).length() < 1e-9 && flat.triangle_a == mesh.triangle_a);
        }
    }
    assert!(met > 60, "{met}");
}

#[test]
fn smooth_shapes_touch_at_the_deepest_point_of_the_mesh() {
    let mut r = SplitMix(3);
    let mut met = [0; 4];
    for k in 0..400 {
        let a = lump(&mut r, 0.02);
        let kind = k % 4;
        let b = if kind == 3 { Shape::HalfSpace(HalfSpace) } else { r.shape(CONVEX[kind]) };
        let (p, q) = (r.pose(0.3), r.pose(0.6));
        let found = contact(&a, &p, &b, &q);
        assert_eq!(found.is_some(), collides(&a, &p, &b, &q));
        let Some(c) = found else { continue };
        let Shape::Mesh(m) = &a else { unreachable!() };
        let depth = |x: Vec3| project_point(&b, &q, x).signed_distance;
        if m.contains(p.inverse_transform_point(c.on_b)) && depth(c.on_a) > 1e-9 {
            continue; // wholly inside
        }
        met[kind] += 1;
        assert!(on_triangle(c.on_a, placed(&a, &p, c.triangle_a.unwrap())), "{c:?}");
        assert!(depth(c.on_b).abs() < 1e-9 && depth(c.on_a) < 1e-9, "{} {b:?} {c:?}", depth(c.on_a));
        // All corners and centroids of triangles are at most as deep.
        if kind != 2 {
            let deepest = (0..m.triangles().len() as u32)
                .flat_map(|t| {
                    let [x, y, z] = placed(&a, &p, t);
                    [x, y, z, (x + y + z) / 3.0].map(depth)
                })
                .fold(f64::INFINITY, f64::min);
            assert!(depth(c.on_a) <= deepest + 1e-9, "{b:?} {} {deepest}", depth(c.on_a));
        }
    }
    assert!(met.iter().all(|n| *n > 15), "{met:?}");
}

#[test]
fn contact_points_of_simple_shapes_are_as_far_apart_as_they_overlap() {
    let mut r = SplitMix(4);
    let mut met = 0;
    // These include pairs of cylinders that are hard for the penetration search.
    for _ in 0..2000 {
        let (x, y) = (CONVEX[r.below(4)], if r.below(6) == 0 { "plane" } else { CONVEX[r.below(5)] });
        let (a, b, p, q) = (r.shape(x), r.shape(y), r.pose(0.6), r.pose(0.6));
        let found = contact(&a, &p, &b, &q);
        assert_eq!(found.is_some(), collides(&a, &p, &b, &q), "{x} {y}");
        let (Some(c), Some(out)) = (found, penetration(&a, &p, &b, &q)) else { continue };
        let thin = |s: &Shape| s.volume() < 1e-6;
        if thin(&a) || thin(&b) {
            continue;
        }
        met += 1;
        let on = |s: &Shape, pose: &Pose, x: Vec3| project_point(s, pose, x).signed_distance.abs();
        assert!(on(&a, &p, c.on_a) < 1e-8 && on(&b, &q, c.on_b) < 1e-8, "{x} {y} {c:?}");
        let tolerance = if x == "hull" || y == "hull" { 2e-3 } else { 1e-6 };
        assert!((c.on_a.distance(c.on_b) - out.depth).abs() < tolerance, "{x} {y} {out:?} {c:?}");
        for (s, pose, at, normal) in [(&a, &p, c.on_a, c.normal_a), (&b, &q, c.on_b, c.normal_b)] {
            let above = project_point(s, pose, at + normal * 1e-5).signed_distance;
            assert!((normal.length() - 1.0).abs() < 1e-12 && above > 5e-6, "{x} {y} {above} {c:?}");
        }
    }
    assert!(met > 300, "{met}");
}

#[test]
fn within_a_limit_the_nearest_points_are_returned() {
    let mut r = SplitMix(5);
    let (mut found_apart, mut workspace) = (0, Workspace::new());
    for k in 0..300 {
        let a = lump(&mut r, 0.02);
        let b = if k % 2 == 0 { lump(&mut r, 0.02) } else { r.shape(CONVEX[k % 5]) };
        let (p, q) = (r.pose(0.3), r.pose(1.2));
        let exact = separation(&a, &p, &b, &q);
        let found = contact_point(&a, &p, &b, &q, within(0.3), &mut workspace);
        if (exact.distance - 0.3).abs() > 1e-9 {
            assert_eq!(found.is_some(), exact.distance < 0.3);
        }
        let Some(c) = found.filter(|c| !c.touching) else { continue };
        found_apart += 1;
        assert!((c.on_a.distance(c.on_b) - exact.distance).abs() < 1e-9 && c.triangle_a.is_some());
        assert!(c.normal_a.dot(c.on_b - c.on_a) > -1e-9 && c.normal_b.dot(c.on_a - c.on_b) > -1e-9, "{c:?}");
        let nan = contact_point(&a, &p, &b, &q, within(f64::NAN), &mut workspace).unwrap();
        assert!(nan.on_a.distance(c.on_a) < 1e-9);
    }
    assert!(found_apart > 50, "{found_apart}");
}

#[test]
fn contacts_are_the_same_when_moved_or_swapped() {
    let mut r = SplitMix(6);
    let (mut met, mut moved, mut turned) = (0, 0, 0);
    for k in 0..200 {
        let a = lump(&mut r, 0.02);
        let b = if k % 2 == 0 { lump(&mut r, 0.02) } else { r.shape(CONVEX[k % 5]) };
        let (p, q, away) = (r.pose(0.3), r.pose(0.4), r.pose(3.0));
        let Some(c) = contact(&a, &p, &b, &q) else { continue };
        let swapped = contact(&b, &q, &a, &p).unwrap();
        let there = contact(&a, &(away * p), &b, &(away * q)).unwrap();
        met += 1;
        assert!(swapped.on_b.distance(c.on_a) < 1e-9, "{c:?} {swapped:?}");
        assert!(swapped.triangle_b == c.triangle_a && (swapped.normal_b - c.normal_a).length() < 1e-9);
        let same = there.on_a.distance(away.transform_point(c.on_a)) < 1e-9;
        // The deepest point in a cylinder is approximate; one point may be a corner of several triangles.
        moved += usize::from(!same && b.kind() != ShapeKind::Cylinder);
        if same && there.triangle_a == c.triangle_a {
            turned += 1;
            assert!((there.normal_a - away.transform_vector(c.normal_a)).length() < 1e-9);
        }
    }
    assert!(met > 60 && moved == 0 && turned + 8 > met, "{met} {moved} {turned}");
}

#[test]
fn degenerate_meshes_and_nan_have_an_answer() {
    let mesh = |v: Vec<Vec3>, t: Vec<[u32; 3]>| Shape::Mesh(Arc::new(TriMesh::new(v, t).unwrap()));
    let point = mesh(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]);
    let line = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2]]);
    let flat = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2], [0, 1, 2], [2, 1, 0]]);
    let all =
        [point, line, flat, Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) }), Shape::HalfSpace(HalfSpace)];
    let mut r = SplitMix(7);
    for a in &all {
        for b in &all {
            for k in 0..40 {
                let (p, mut q) = (r.pose(0.4), r.pose(0.4));
                if k == 0 {
                    q = p;
                }
                let found = contact(a, &p, b, &q);
                assert_eq!(found.is_some(), collides(a, &p, b, &q), "{a:?} {b:?}");
                if let Some(c) = found {
                    assert!(c.on_a.is_finite() && c.on_b.is_finite() && c.touching);
                    assert!([c.normal_a, c.normal_b].iter().all(|n| (n.length() - 1.0).abs() < 1e-9), "{c:?}");
                }
                for bad in [f64::NAN, f64::INFINITY, 1e200] {
                    let lost = Pose::new(Rotation::IDENTITY, Vec3::new(0.0, bad, 0.0));
                    assert!(contact(a, &p, b, &lost).is_some_and(|c| c.touching), "unknown is not free");
                }
            }
        }
    }
}

#[test]
fn every_level_of_detail_is_conservative() {
    let mut r = SplitMix(8);
    let mut workspace = Workspace::new();
    let simd_levels = [Detail::Boxes(0), Detail::Boxes(1), Detail::Boxes(2), Detail::Boxes(9), Detail::Exact];
    let (mut contacts, kinds) = ([0; 5], ["sphere", "capsule", "cylinder", "box", "hull", "plane"]);
    for k in 0..200 {
        let a = lump(&mut r, 0.003);
        let b = if k % 2 == 0 { lump(&mut r, 0.003) } else { r.shape(kinds[k / 2 % 6]) };
        let (p, q, limit) = (r.pose(0.3), r.pose(0.8), if k % 3 == 0 { 0.05 } else { 0.0 });
        let exact = contact_point(&a, &p, &b, &q, within(limit), &mut workspace);
        for (detail, contacts) in simd_levels.iter().zip(&mut contacts) {
            let settings = ContactSettings { limit, detail: *detail };
            let found = contact_point(&a, &p, &b, &q, settings, &mut workspace);
            let swapped = contact_point(&b, &q, &a, &p, settings, &mut workspace);
            assert!(found.is_some() || exact.is_none(), "{detail:?} {b:?}");
            assert!(swapped.is_some() || exact.is_none(), "{detail:?} {b:?}");
            *contacts += usize::from(found.is_some());
            if let Some(c) = found {
                assert!((c.normal_a.length() - 1.0).abs() < 1e-6 && (c.normal_b.length() - 1.0).abs() < 1e-6);
                assert!(*detail == Detail::Exact || project_point(&a, &p, c.on_a).signed_distance.abs() < 1e-6);
            }
        }
    }
    assert!(contacts.windows(2).all(|c| c[0] >= c[1]), "{contacts:?}");
    assert!(contacts[0] > contacts[1] && contacts[1] > contacts[2], "{contacts:?}");
}

#[test]
fn every_instruction_set_gives_the_same_point_of_two_meshes() {
    use fearless_simd::Level as SimdLevel;
    let mut simd_levels = vec![SimdLevel::new()];
    #[cfg(target_arch = "x86_64")]
    {
        simd_levels.extend(simd_levels[0].as_sse2().map(SimdLevel::Sse2));
        simd_levels.extend(simd_levels[0].as_sse4_2().map(SimdLevel::Sse4_2));
        simd_levels.extend(simd_levels[0].as_avx2().map(SimdLevel::Avx2));
    }
    let mut r = SplitMix(9);
    let mut met = 0;
    for _ in 0..60 {
        let (a, b) = (lump(&mut r, 0.01), lump(&mut r, 0.01));
        let (p, q) = (r.pose(0.2), r.pose(0.4));
        let found = simd_levels.iter().map(|simd_level| {
            let mut workspace = Workspace::with_simd_level(*simd_level);
            contact_point(&a, &p, &b, &q, within(0.1), &mut workspace)
        });
        let found: Vec<_> = found.collect();
        met += usize::from(found[0].is_some_and(|c| c.touching));
        assert!(found.windows(2).all(|w| w[0] == w[1]), "{found:?}");
    }
    assert!(met > 20, "{met}");
}
