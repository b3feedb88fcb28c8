//! All touching triangles compared with a test of every pair of triangles by its separating axes.

use std::collections::HashSet;
use std::sync::Arc;

use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::contact::{for_each_triangle_contact, triangle_surface};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh, Workspace, collides};
use elbowroom_spatial::{Pose, Vec3};

/// A wavy ball: closed, but not convex.
fn lump(r: &mut SplitMix, fine: f64) -> Shape {
    Shape::Mesh(Arc::new(crate::common::lump(0.3, fine, Vec3::splat(1.0), r.between(0.0, 0.4))))
}

/// The largest gap between two triangles over the directions that can separate them, m: negative if they overlap.
fn gap(s: [Vec3; 3], t: [Vec3; 3]) -> f64 {
    let edges = |s: [Vec3; 3]| [s[1] - s[0], s[2] - s[1], s[0] - s[2]];
    let (e, f) = (edges(s), edges(t));
    let (n, m) = (e[0].cross(e[1]), f[0].cross(f[1]));
    let mut axes = vec![n, m];
    axes.extend(e.iter().flat_map(|e| f.map(|f| e.cross(f))));
    axes.extend(e.iter().map(|e| n.cross(*e)));
    axes.extend(f.iter().map(|f| m.cross(*f)));
    let range = |axis: Vec3, s: [Vec3; 3]| {
        let along = s.map(|p| axis.dot(p));
        (along.iter().copied().fold(f64::INFINITY, f64::min), along.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    let along = |axis: Vec3| {
        let ((low, high), (from, to)) = (range(axis, s), range(axis, t));
        (low - to).max(from - high)
    };
    axes.into_iter().filter_map(Vec3::try_normalize).map(along).fold(f64::NEG_INFINITY, f64::max)
}

fn corners(m: &TriMesh, pose: &Pose, triangle: usize) -> [Vec3; 3] {
    m.triangles()[triangle].map(|i| pose.transform_point(m.vertices()[i as usize]))
}

/// Distance of a point from the triangle's plane, and from the outside of its edges, m.
fn off_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let Some(n) = (b - a).cross(c - a).try_normalize() else { return 0.0 };
    let outside = |x: Vec3, y: Vec3| (y - x).cross(n).try_normalize().map_or(0.0, |o| o.dot(p - x));
    [n.dot(p - a).abs(), outside(a, b), outside(b, c), outside(c, a)].into_iter().fold(0.0, f64::max)
}

fn others(r: &mut SplitMix) -> Vec<Shape> {
    vec![
        lump(r, 0.02),
        Shape::Sphere(Sphere { radius: r.between(0.1, 0.4) }),
        Shape::Capsule(Capsule { half_length: r.between(0.1, 0.3), radius: r.between(0.05, 0.2) }),
        Shape::Cylinder(Cylinder { half_length: r.between(0.1, 0.3), radius: r.between(0.05, 0.2) }),
        Shape::Cuboid(Cuboid {
            half_extents: Vec3::new(r.between(0.1, 0.4), r.between(0.1, 0.4), r.between(0.1, 0.4)),
        }),
        r.shape("hull"),
    ]
}

#[test]
fn all_touching_triangles_are_found_and_no_others() {
    let mut r = SplitMix(22);
    let mut workspace = Workspace::new();
    let (mut pairs, mut met) = (0, [0; 6]);
    for round in 0..24 {
        let a = lump(&mut r, 0.02);
        let Shape::Mesh(m) = &a else { unreachable!() };
        for (kind, b) in others(&mut r).into_iter().enumerate() {
            let Some(n) = triangle_surface(&b, 0.01) else { continue };
            let (p, q) = (r.pose(0.1), r.pose(0.35));
            let mut found = HashSet::new();
            for_each_triangle_contact(m, &p, &n, &q, &mut workspace, |c| {
                let [s, t] = [corners(m, &p, c.triangle_a as usize), corners(&n, &q, c.triangle_b as usize)];
                assert!(found.insert((c.triangle_a as usize, c.triangle_b as usize)), "twice: {c:?}");
                // If the triangles cross, both ends are on both triangles; if they touch, one is on each.
                let [on_a, on_b] = c.segment;
                assert!(off_triangle(on_a, s) < 1e-9 && off_triangle(on_b, t) < 1e-9, "{c:?}");
            });
            for x in 0..m.triangles().len() {
                let s = corners(m, &p, x);
                for y in 0..n.triangles().len() {
                    let gap = gap(s, corners(&n, &q, y));
                    let is_found = found.contains(&(x, y));
                    assert!(!(is_found && gap > 1e-9), "round {round}, kind {kind}: {x} and {y} are {gap} m apart");
                    assert!(is_found || gap > -1e-9, "round {round}, kind {kind}: {x} and {y} overlap by {gap} m");
                }
            }
            pairs += found.len();
            met[kind] += usize::from(!found.is_empty());
        }
    }
    assert!(pairs > 1000 && met.iter().all(|n| *n > 5), "{pairs} {met:?}");
}

#[test]
fn triangles_of_round_shapes_lie_within_them() {
    let mut r = SplitMix(23);
    for shape in others(&mut r) {
        let surface = triangle_surface(&shape, 1e-3).unwrap();
        let point = Shape::Sphere(Sphere { radius: 0.0 });
        for v in surface.vertices() {
            assert!(collides(&point, &Pose::from_translation(*v * (1.0 - 1e-12)), &shape, &Pose::IDENTITY), "{v:?}");
        }
    }
    assert!(triangle_surface(&Shape::HalfSpace(HalfSpace), 1e-3).is_none());
}

#[test]
fn a_mesh_inside_another_is_in_contact_without_triangles() {
    let cube = |half: f64| triangle_surface(&Shape::Cuboid(Cuboid { half_extents: Vec3::splat(half) }), 1e-3).unwrap();
    let (inner, outer, mut workspace) = (cube(0.1), cube(0.2), Workspace::new());
    let mut inside = |at: f64| {
        let pose = Pose::from_translation(Vec3::X * at);
        let mut count = 0;
        let inside = for_each_triangle_contact(&inner, &pose, &outer, &Pose::IDENTITY, &mut workspace, |_| count += 1);
        (inside, count > 0)
    };
    assert_eq!([0.0, 0.15, 0.5].map(&mut inside), [(true, false), (false, true), (false, false)]);
}
