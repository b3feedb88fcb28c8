//! Covers of spheres: complete, without pockets, close to the solid; inner spheres inside.

use std::sync::Arc;

use crate::common::{Random, RandomGeometry, mesh};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_proximity::{
    Capsule, ConvexHull, Cuboid, Cylinder, Shape, Sphere, TriMesh, project_point, tessellate::tessellate,
};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::folder;
use elbowroom_validity::{Ball, SphereCover};

/// Number of divisions of a triangle after which a part counts as uncovered; far below the rounding for which covers
/// allow.
const MAX_DEPTH: u32 = 80;
/// Number of compared points on a ball.
const ON_BALL: usize = 48;

fn placed_triangles(shape: &Shape, pose: &Pose) -> Vec<[Vec3; 3]> {
    let (vertices, indices) = tessellate(shape, 2e-4);
    let at = |i: u32| pose.transform_point(vertices[i as usize]);
    indices.iter().map(|&[a, b, c]| [at(a), at(b), at(c)]).collect()
}

/// The balls that a ball touches.
fn near(balls: &[Ball], centre: Vec3, radius: f64) -> Vec<Ball> {
    balls.iter().filter(|b| b.centre.distance(centre) <= b.radius + radius).copied().collect()
}

/// Proves that a triangle lies in the union of balls.
///
/// The triangle is divided until every part has all corners in one ball, which is convex.
fn is_in_union([a, b, c]: [Vec3; 3], balls: &[Ball], depth: u32) -> bool {
    if balls.iter().any(|ball| ball.contains(a) && ball.contains(b) && ball.contains(c)) {
        return true;
    }
    if depth == 0 || balls.is_empty() {
        return false;
    }
    // The longest side first.
    let sides = [(a, b, c), (b, c, a), (c, a, b)];
    let (p, q, r) = sides.into_iter().fold(sides[0], |l, s| if s.0.distance(s.1) > l.0.distance(l.1) { s } else { l });
    let middle = p.lerp(q, 0.5);
    [[p, middle, r], [middle, q, r]].into_iter().all(|part| {
        let centre = (part[0] + part[1] + part[2]) * (1.0 / 3.0);
        let radius = part.iter().map(|v| v.distance(centre)).fold(0.0, f64::max);
        is_in_union(part, &near(balls, centre, radius), depth - 1)
    })
}

fn assert_surface_is_covered(name: &str, triangles: &[[Vec3; 3]], cover: &SphereCover) {
    for &t in triangles {
        let centre = (t[0] + t[1] + t[2]) * (1.0 / 3.0);
        let radius = t.iter().map(|v| v.distance(centre)).fold(0.0, f64::max);
        assert!(is_in_union(t, &near(&cover.outer, centre, radius), MAX_DEPTH), "{name}: {t:?} is not in the union");
    }
}

/// Divides a cube until every part lies in one ball or outside all shapes. Of the smallest parts only the centre is
/// tested.
fn solid_is_in_union(shapes: &[(Shape, Pose)], balls: &[Ball], centre: Vec3, half: f64, depth: u32) -> bool {
    let corner = Vec3::splat(half).length();
    if balls.iter().any(|b| ((b.centre - centre).abs() + Vec3::splat(half)).length() <= b.radius) {
        return true;
    }
    let gap = shapes.iter().map(|(s, p)| project_point(s, p, centre).signed_distance).fold(f64::INFINITY, f64::min);
    if gap > corner {
        return true;
    }
    if depth == 0 {
        return gap > 1e-9 || balls.iter().any(|b| b.contains(centre));
    }
    let near = near(balls, centre, corner);
    (0..8).all(|i| {
        let side = |axis: i32| if i >> axis & 1 == 1 { 0.5 * half } else { -0.5 * half };
        solid_is_in_union(shapes, &near, centre + Vec3::new(side(0), side(1), side(2)), 0.5 * half, depth - 1)
    })
}

/// Points spread over a ball's surface.
fn on_ball(ball: &Ball) -> impl Iterator<Item = Vec3> + '_ {
    (0..ON_BALL).map(|i| {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / ON_BALL as f64;
        let (sin, cos) = (2.399_963 * i as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        ball.centre + Vec3::new(across * cos, across * sin, z) * ball.radius
    })
}

fn gap(shapes: &[(Shape, Pose)], p: Vec3) -> f64 {
    shapes.iter().map(|(s, pose)| project_point(s, pose, p).signed_distance).fold(f64::INFINITY, f64::min)
}

/// Largest distance of a point of the balls from closed shapes. Inner balls must lie in one of the shapes.
fn largest_protrusion(shapes: &[(Shape, Pose)], cover: &SphereCover) -> f64 {
    let protrusion = cover.outer.iter().flat_map(on_ball).map(|p| gap(shapes, p)).fold(0.0, f64::max);
    for ball in &cover.inner {
        let depth = shapes.iter().map(|(s, pose)| -project_point(s, pose, ball.centre).signed_distance);
        assert!(ball.radius > 0.0 && depth.fold(0.0, f64::max) >= ball.radius - 1e-12, "{ball:?} is not inside");
    }
    protrusion
}

fn assert_complete(name: &str, shapes: &[(Shape, Pose)], slack: f64, is_closed: bool) {
    let refs: Vec<(&Shape, Pose)> = shapes.iter().map(|(s, p)| (s, *p)).collect();
    let cover = SphereCover::new(&refs, slack).unwrap();
    for (shape, pose) in shapes {
        assert_surface_is_covered(name, &placed_triangles(shape, pose), &cover);
    }
    if !is_closed {
        assert!(cover.inner.is_empty(), "{name}: an open surface has no inside");
        return;
    }
    assert!(!cover.inner.is_empty(), "{name}");
    let protrusion = largest_protrusion(shapes, &cover);
    assert!(protrusion <= slack + 1e-7, "{name}: protrudes by {protrusion}, more than {slack}");
    let bounds = shapes.iter().map(|(s, p)| s.aabb(p)).reduce(|a, b| a.union(&b)).unwrap();
    let half = 0.5 * bounds.extent().x.max(bounds.extent().y).max(bounds.extent().z) + 1e-3;
    assert!(solid_is_in_union(shapes, &cover.outer, bounds.center(), half, 7), "{name}: a pocket");
}

#[test]
fn primitives_are_covered() {
    let mut random = Random(1);
    for (i, shape) in [
        Shape::Sphere(Sphere { radius: 0.05 }),
        Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.07, 0.04, 0.02) }),
        Shape::Capsule(Capsule { half_length: 0.06, radius: 0.03 }),
        Shape::Cylinder(Cylinder { half_length: 0.05, radius: 0.04 }),
        Shape::Cylinder(Cylinder { half_length: 0.006, radius: 0.05 }),
    ]
    .into_iter()
    .enumerate()
    {
        assert_complete(&format!("shape {i}"), &[(shape.clone(), Pose::IDENTITY)], 0.004, true);
        assert_complete(&format!("shape {i}, turned"), &[(shape, random.pose(0.3))], 0.005, true);
    }
}

#[test]
fn the_proofs_notice_a_missing_ball() {
    let block = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.07, 0.04, 0.02) });
    let shapes = [(block.clone(), Pose::IDENTITY)];
    let cover = SphereCover::new(&[(&block, Pose::IDENTITY)], 0.004).unwrap();
    let is_proven = |balls: &[Ball]| {
        let triangles = placed_triangles(&block, &Pose::IDENTITY);
        let surface = triangles.iter().all(|&t| is_in_union(t, balls, MAX_DEPTH));
        (surface, solid_is_in_union(&shapes, balls, Vec3::ZERO, 0.071, 7))
    };
    assert_eq!(is_proven(&cover.outer), (true, true));
    let is_noticed = |&missing: &usize| {
        let mut balls = cover.outer.clone();
        balls.remove(missing);
        is_proven(&balls) != (true, true)
    };
    let noticed = (0..cover.outer.len()).filter(is_noticed).count();
    // A few spheres lie in the union of others, because a cover counts whole voxels.
    assert!(noticed * 4 > cover.outer.len() * 3, "{noticed} of {}", cover.outer.len());
}

#[test]
fn hulls_and_closed_meshes_are_covered() {
    let mut random = Random(2);
    for i in 0..8 {
        let points: Vec<Vec3> = (0..6 + 2 * i).map(|_| random.vec3(0.06)).collect();
        let hull = Shape::Hull(Arc::new(ConvexHull::from_points(&points).unwrap()));
        let pose = random.pose(0.2);
        assert_complete(&format!("hull {i}"), &[(hull.clone(), pose)], 0.004, true);
        assert_complete(&format!("mesh {i}"), &[(mesh(&hull, 0), pose)], 0.004, true);
    }
}

#[test]
fn unions_of_shapes_are_covered() {
    let mut random = Random(3);
    for i in 0..4 {
        let shapes: Vec<(Shape, Pose)> = (0..3)
            .map(|k| {
                let half_extents = Vec3::new(0.05, 0.03, 0.02);
                let shape = [
                    Shape::Cuboid(Cuboid { half_extents }),
                    Shape::Cylinder(Cylinder { half_length: 0.04, radius: 0.02 }),
                    mesh(&Shape::Cuboid(Cuboid { half_extents }), 0),
                ];
                (shape[k].clone(), random.pose(0.04))
            })
            .collect();
        assert_complete(&format!("union {i}"), &shapes, 0.005, true);
    }
}

#[test]
fn open_meshes_and_soups_are_covered() {
    let mut random = Random(4);
    let tube = Shape::Cylinder(Cylinder { half_length: 0.05, radius: 0.03 });
    for missing in [1, 7, 30] {
        assert_complete(&format!("open by {missing}"), &[(mesh(&tube, missing), random.pose(0.2))], 0.005, false);
    }
    for i in 0..4 {
        // Unordered triangles, some without area.
        let mut vertices: Vec<Vec3> = (0..60).map(|_| random.vec3(0.05)).collect();
        vertices[1] = vertices[0];
        vertices[5] = vertices[3].lerp(vertices[4], 0.3);
        let triangles: Vec<[u32; 3]> = (0..20).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let Ok(soup) = TriMesh::new(vertices, triangles) else { continue };
        assert_complete(&format!("soup {i}"), &[(Shape::Mesh(Arc::new(soup)), Pose::IDENTITY)], 0.005, false);
    }
}

#[test]
fn a_mesh_inside_out_has_no_inner_balls_outside() {
    let block = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.05, 0.04, 0.03) });
    let (vertices, mut triangles) = tessellate(&block, 1e-3);
    for triangle in &mut triangles {
        triangle.swap(1, 2);
    }
    let Ok(turned) = TriMesh::new(vertices, triangles) else { return };
    let turned = Shape::Mesh(Arc::new(turned));
    let cover = SphereCover::new(&[(&turned, Pose::IDENTITY)], 0.005).unwrap();
    let block = [(block, Pose::IDENTITY)];
    assert!(largest_protrusion(&block, &cover) <= 0.005 + 1e-7);
    assert!(solid_is_in_union(&block, &cover.outer, Vec3::ZERO, 0.051, 6));
}

/// `ELBOWROOM_VALIDITY_COVERS=all` proves the covers of all robots of the data. Use the release profile.
#[test]
fn links_of_real_robots_are_covered() {
    let is_wanted = |path: &std::path::Path| match std::env::var_os("ELBOWROOM_VALIDITY_COVERS") {
        Some(_) => true,
        None => ["panda", "ur5e"].iter().any(|name| path.ends_with(format!("{name}.urdf"))),
    };
    for path in folder::robots(&["urdf"]).into_iter().filter(|path| is_wanted(path)) {
        let robot = load(&path, &LoadOptions::default()).unwrap().robot;
        for link in robot.links_with_colliders() {
            let shapes: Vec<_> = robot.colliders[link.0].iter().map(|c| (&c.shape, c.in_link)).collect();
            let cover = SphereCover::new(&shapes, 0.005).unwrap();
            let label = format!("{}, {}", path.display(), robot.chain.links()[link.0]);
            for (shape, pose) in &shapes {
                assert_surface_is_covered(&label, &placed_triangles(shape, pose), &cover);
            }
            let is_closed = |shape: &Shape| !matches!(shape, Shape::Mesh(mesh) if !mesh.report().closed);
            if shapes.iter().all(|(shape, _)| is_closed(shape)) {
                let owned: Vec<(Shape, Pose)> = shapes.iter().map(|(shape, pose)| ((*shape).clone(), *pose)).collect();
                let protrusion = largest_protrusion(&owned, &cover);
                // Gaps narrower than a voxel are closed.
                assert!(protrusion <= 2.0 * 0.005, "{label}: protrudes by {protrusion}");
                println!("{label}: {} outer spheres, protrusion {:.2} mm", cover.outer.len(), protrusion * 1e3);
            }
        }
    }
}
