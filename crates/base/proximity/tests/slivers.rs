//! Nearly degenerate triangles, meshes far from their own origin, tiny meshes: every answer compared with distances
//! in exact arithmetic, and with every other answer.

use std::sync::Arc;

use crate::common::exact::{
    Point, Square, Triangle, placed, placed_triangle, point_triangle, segment_triangle, triangles,
};
use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::advanced::{
    colliding_triangles, for_each_contact, is_farther_than, mesh_separation, mesh_separation_with, triangles_within,
};
use elbowroom_proximity::{
    Capsule, ConvexHull, Cuboid, DistanceSettings, Shape, Sphere, TriMesh, Workspace, collides, separation,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};

fn mesh(corners: &[[Vec3; 3]]) -> TriMesh {
    let faces = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh::new(corners.as_flattened().to_vec(), faces).unwrap()
}

/// A triangle of this height over an edge about 1 m long; the corner projects anywhere onto that edge, or near an end.
fn sliver(rng: &mut SplitMix, height: f64) -> [Vec3; 3] {
    let (from, along) = (rng.vec(0.5), rng.vec(1.0));
    let across = along.cross(rng.vec(1.0)).try_normalize().unwrap_or(Vec3::X);
    let at = if rng.below(3) == 0 { 1e-9 } else { rng.unit() };
    let mut t = [from, from + along, from + along * at + across * height];
    t.rotate_left(rng.below(3));
    t
}

/// A triangle that the sliver passes through near its middle, or nearly so.
fn across(rng: &mut SplitMix, sliver: &[Vec3; 3], height: f64, slender: bool) -> [Vec3; 3] {
    let share = [rng.unit(), rng.unit(), rng.unit()];
    let sum: f64 = share.iter().sum();
    let inner = sliver[0] * (share[0] / sum) + sliver[1] * (share[1] / sum) + sliver[2] * (share[2] / sum);
    let miss = [0.0, height, 10.0 * height, 0.1][rng.below(4)];
    let through = inner + rng.vec(miss);
    let direction = rng.vec(1.0);
    let (ahead, behind) = (rng.between(0.1, 1.0), rng.between(0.1, 1.0));
    let third = if slender { rng.vec(1.0) * height } else { rng.vec(1.0) };
    [through + direction * ahead, through - direction * behind, through + third]
}

/// Compares every answer about two meshes in the world with the exact square of their distance; returns the
/// distance.
fn agree(a: &TriMesh, pa: &Pose, b: &TriMesh, pb: &Pose, exact: &Square, error: f64) -> f64 {
    let workspace = &mut Workspace::new();
    let near = mesh_separation(a, pa, b, pb, workspace);
    let what = || format!("{a:?}\nat {pa:?}\n{b:?}\nat {pb:?}\n{near:?}\n{exact:?}");
    assert!(exact.root_cmp(near.lower_bound).is_ge(), "the lower bound is above the distance: {}", what());
    assert!(exact.root_cmp(near.distance + error).is_le(), "the distance is too short: {}", what());
    assert!(near.distance == 0.0 || exact.root_cmp((near.distance - error).max(0.0)).is_ge(), "too long: {}", what());
    let hit = near.distance == 0.0;
    assert!(hit || !exact.is_zero(), "contact is denied: {}", what());
    assert_eq!(near.lower_bound == 0.0, hit, "{}", what());
    assert_eq!(colliding_triangles(a, pa, b, pb, workspace).is_some(), hit, "collision: {}", what());
    let mut count = 0;
    for_each_contact(a, pa, b, pb, workspace, |_| count += 1);
    assert_eq!(count > 0, hit, "contacts: {}", what());
    let lower = near.lower_bound;
    for tolerance in [0.0, 0.5 * lower, lower * (1.0 - 1e-9), lower * (1.0 + 1e-9), near.distance * 1.5 + 1e-9] {
        let close = near.lower_bound <= tolerance;
        assert_eq!(
            triangles_within(a, pa, b, pb, tolerance, workspace).is_some(),
            close,
            "within {tolerance:e}: {}",
            what()
        );
        assert_eq!(
            is_farther_than(a, pa, b, pb, tolerance, workspace),
            !close,
            "farther than {tolerance:e}: {}",
            what()
        );
        let settings = DistanceSettings { limit: tolerance, ..DistanceSettings::default() };
        let found = mesh_separation_with(a, pa, b, pb, settings, workspace);
        assert_eq!(found.is_some(), close, "at {tolerance:e}: {}", what());
    }
    near.distance
}

#[test]
fn crossing_slivers_are_never_apart() {
    let mut rng = SplitMix(14);
    let (mut hit, mut free) = (0, 0);
    for height in [1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6, 1e-3] {
        for case in 0..160 {
            let s = sliver(&mut rng, height);
            let t = across(&mut rng, &s, height, case % 2 == 0);
            let (pa, pb) =
                if case % 3 == 0 { (rng.pose(1.0), rng.pose(1.0)) } else { (Pose::IDENTITY, Pose::IDENTITY) };
            // The second pose preserves the crossing, up to rounding.
            let t = t.map(|p| pb.inverse_transform_point(pa.transform_point(p)));
            let exact = triangles(&placed_triangle(s, &pa), &placed_triangle(t, &pb));
            let d = agree(&mesh(&[s]), &pa, &mesh(&[t]), &pb, &exact, 2e-11);
            hit += usize::from(d == 0.0);
            free += usize::from(d > 0.0);
        }
    }
    assert!(hit > 400 && free > 300, "{hit} touch, {free} do not: too few of one kind");
}

/// Spheres and capsules near slivers.
#[test]
fn round_shapes_near_slivers_have_right_bounds() {
    let mut rng = SplitMix(15);
    for height in [1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6] {
        for _ in 0..300 {
            let s = sliver(&mut rng, height);
            let [p, q, _] = across(&mut rng, &s, height, false);
            let shape = Shape::Mesh(Arc::new(mesh(&[s])));
            let t: Triangle = placed_triangle(s, &Pose::IDENTITY);
            let at = Pose::from_translation(p);
            check(&Shape::Sphere(Sphere { radius: 0.0 }), &at, &shape, &point_triangle(&in_world(p), &t));
            let middle = (p + q) * 0.5;
            let z = (q - p).try_normalize().unwrap();
            let x = z.cross(if z.x.abs() < 0.6 { Vec3::X } else { Vec3::Y }).try_normalize().unwrap();
            let along = Pose::new(Rotation::from_columns(x, z.cross(x), z).unwrap(), middle);
            let half_length = 0.5 * q.distance(p);
            let ends = [-half_length, half_length].map(|h| placed(Vec3::Z * h, &along));
            let square = segment_triangle(&ends[0], &ends[1], &t);
            check(&Shape::Capsule(Capsule { half_length, radius: 0.0 }), &along, &shape, &square);
        }
    }
}

fn in_world(p: Vec3) -> Point {
    placed(p, &Pose::IDENTITY)
}

fn check(a: &Shape, pa: &Pose, b: &Shape, square: &Square) {
    let found = separation(a, pa, b, &Pose::IDENTITY);
    let what = || format!("{a:?} at {pa:?}\n{b:?}\n{found:?}\n{square:?}");
    assert!(square.root_cmp(found.lower_bound).is_ge(), "the lower bound is above the distance: {}", what());
    assert!(square.root_cmp(found.distance + 1e-13).is_le(), "too short: {}", what());
    assert!(
        found.distance == 0.0 || square.root_cmp((found.distance - 1e-13).max(0.0)).is_ge(),
        "too long: {}",
        what()
    );
    assert_eq!(collides(a, pa, b, &Pose::IDENTITY), found.distance == 0.0, "{}", what());
}

/// Boxes and hulls near slivers: the bounds are on the right side of the exact distance.
#[test]
fn flat_shapes_near_slivers_have_right_bounds() {
    let mut rng = SplitMix(19);
    for height in [1e-13, 1e-11, 1e-9, 1e-8, 1e-6] {
        for case in 0..12 {
            let s = sliver(&mut rng, height);
            let half = rng.between(0.01, 0.2);
            let corners = cube(Vec3::ZERO, half);
            let shape = if case % 2 == 0 {
                Shape::Cuboid(Cuboid { half_extents: Vec3::splat(half) })
            } else {
                Shape::Hull(Arc::new(ConvexHull::from_points(corners.as_flattened()).unwrap()))
            };
            // A corner or an edge of the shape is at the sliver.
            let touch = Vec3::new(half, half, half * [1.0, 0.3][case % 2]);
            let rotation = rng.pose(1.0).rotation;
            let pose = Pose::new(rotation, (s[0] + s[1] + s[2]) / 3.0 - rotation * touch + rng.vec(height));
            let exact = least(&corners, &pose, &[s], &Pose::IDENTITY);
            let found = separation(&shape, &pose, &Shape::Mesh(Arc::new(mesh(&[s]))), &Pose::IDENTITY);
            let what = || format!("{shape:?} at {pose:?}\n{s:?}\n{found:?}\n{exact:?}");
            assert!(exact.root_cmp(found.lower_bound).is_ge(), "the lower bound is above the distance: {}", what());
            assert!(exact.root_cmp(found.distance + 1e-12).is_le() || exact.root_cmp(1e-12).is_le(), "{}", what());
        }
    }
}

/// Points at a distance from slivers: an inaccurate normal must not lose the projection onto the line.
#[test]
fn points_far_from_slivers_have_right_distances() {
    let mut rng = SplitMix(16);
    for height in [1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8] {
        for _ in 0..400 {
            let s = sliver(&mut rng, height);
            // The point is over the sliver's middle, however inaccurate that direction is.
            let n = (s[1] - s[0]).cross(s[2] - s[0]).try_normalize().unwrap_or(Vec3::Z);
            let p = (s[0] + s[1] + s[2]) / 3.0 + n * rng.between(-1.0, 1.0) + rng.vec(1.0) * (3.0 * height);
            let t = placed_triangle(s, &Pose::IDENTITY);
            let ball = Shape::Sphere(Sphere { radius: 0.0 });
            check(
                &ball,
                &Pose::from_translation(p),
                &Shape::Mesh(Arc::new(mesh(&[s]))),
                &point_triangle(&in_world(p), &t),
            );
        }
    }
}

/// A cube of two metres whose own coordinates are far from 0.
fn cube(center: Vec3, half: f64) -> Vec<[Vec3; 3]> {
    let (v, t) =
        elbowroom_proximity::tessellate::tessellate(&Shape::Cuboid(Cuboid { half_extents: Vec3::splat(half) }), half);
    t.iter().map(|f| f.map(|i| v[i as usize] + center)).collect()
}

fn least(a: &[[Vec3; 3]], pa: &Pose, b: &[[Vec3; 3]], pb: &Pose) -> Square {
    let of_b: Vec<Triangle> = b.iter().map(|t| placed_triangle(*t, pb)).collect();
    let mut best: Option<Square> = None;
    for s in a {
        let s = placed_triangle(*s, pa);
        for t in &of_b {
            let found = triangles(&s, t);
            best = Some(match best {
                Some(b) if b.root_less(&found) => b,
                _ => found,
            });
        }
    }
    best.unwrap()
}

#[test]
fn meshes_far_from_their_origin_have_one_answer() {
    let mut rng = SplitMix(17);
    let mut differ = 0;
    for case in 0..24 {
        let far = [1e3, 1e5, 1e6, 1e7][case % 4];
        let (ca, cb) = (rng.vec(far), rng.vec(far));
        let (a, b) = (cube(ca, 1.0), cube(cb, 1.0));
        // The cubes are corner towards corner, so that the bounding spheres have the same gap as the corners.
        let direction = Vec3::splat(1.0 / 3.0_f64.sqrt());
        let gap = [0.0, 1e-16, 1e-12, 1e-10, 1e-9, -1e-10][case % 6] * far;
        let pb = Pose::from_translation(ca - cb + direction * (2.0 * 3.0_f64.sqrt() + gap));
        let exact = least(&a, &Pose::IDENTITY, &b, &pb);
        let d = agree(&mesh(&a), &Pose::IDENTITY, &mesh(&b), &pb, &exact, 1e-12 * far + 1e-11);
        differ += usize::from(d > 0.0);
    }
    assert!(differ > 3 && differ < 21, "{differ} of 24 apart show too little");
}

#[test]
fn meshes_of_hardly_any_size_have_one_answer() {
    let mut rng = SplitMix(18);
    for size in [1e-30, 1e-21, 1e-20, 1e-19, 1e-18, 1e-17, 1e-15] {
        for _ in 0..3 {
            let (a, b) = (cube(Vec3::ZERO, size), cube(Vec3::ZERO, size));
            let pb = Pose::from_translation(rng.vec(1.0) * (10.0 * size));
            let exact = least(&a, &Pose::IDENTITY, &b, &pb);
            agree(&mesh(&a), &Pose::IDENTITY, &mesh(&b), &pb, &exact, 1e-17);
        }
    }
}
