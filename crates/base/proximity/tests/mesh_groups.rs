//! Groups of meshes give the same answers as all pairs of meshes one by one, on every instruction set.

use std::sync::Arc;

use crate::common::{RandomGeometry, SplitMix};
use elbowroom_proximity::advanced::{GroupWorkspace, MeshGroup, colliding_triangles};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, Shape, Sphere, TriMesh, Workspace, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};
use fearless_simd::Level as SimdLevel;

fn triangulated(shape: &Shape, missing: usize) -> Arc<TriMesh> {
    let (vertices, mut triangles) = tessellate(shape, 2e-3);
    triangles.truncate(triangles.len() - missing);
    Arc::new(TriMesh::new(vertices, triangles).unwrap())
}

/// A random mesh. Most are closed, some open, some large enough to contain others, some far from their origin.
fn mesh(random: &mut SplitMix) -> Arc<TriMesh> {
    let mut size = || random.between(0.03, 0.2);
    let (x, y, z) = (size(), size(), size());
    let missing = if random.below(5) == 0 { 3 } else { 0 };
    match random.below(6) {
        0 => triangulated(&Shape::Sphere(Sphere { radius: 2.0 * x }), missing),
        1 => triangulated(&Shape::Capsule(Capsule { half_length: x, radius: 0.5 * y }), missing),
        2 => triangulated(&Shape::Cylinder(Cylinder { half_length: x, radius: y }), missing),
        3 => triangulated(&Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) }), missing),
        4 => {
            let far = random.vec(3.0);
            let hull = random.hull();
            let points: Vec<Vec3> = hull.vertices().iter().map(|p| *p * 0.2 + far).collect();
            let hull = elbowroom_proximity::ConvexHull::from_points(&points).unwrap();
            triangulated(&Shape::Hull(Arc::new(hull)), 0)
        }
        // A shell is the surface of a ball, with a smaller one in it.
        _ => {
            let (mut vertices, mut triangles) = tessellate(&Shape::Sphere(Sphere { radius: x + 0.1 }), 2e-3);
            let (inner, cavity) = tessellate(&Shape::Sphere(Sphere { radius: x }), 2e-3);
            let first = vertices.len() as u32;
            vertices.extend(inner);
            triangles.extend(cavity.into_iter().map(|[a, b, c]| [a + first, c + first, b + first]));
            Arc::new(TriMesh::new(vertices, triangles).unwrap())
        }
    }
}

/// Poses that bring the middles of the meshes near a point.
fn poses(random: &mut SplitMix, meshes: &[Arc<TriMesh>], around: Vec3, spread: f64) -> Vec<Pose> {
    let near = |mesh: &Arc<TriMesh>| {
        let pose = random.pose(spread);
        Pose::new(pose.rotation, around + pose.translation - pose.rotation * mesh.aabb().center())
    };
    meshes.iter().map(near).collect()
}

fn naive(one: &[Arc<TriMesh>], poses: &[Pose], other: &[Arc<TriMesh>], other_poses: &[Pose]) -> bool {
    let mut workspace = Workspace::new();
    one.iter().zip(poses).any(|(a, at)| {
        other.iter().zip(other_poses).any(|(b, there)| colliding_triangles(a, at, b, there, &mut workspace).is_some())
    })
}

fn simd_levels() -> Vec<SimdLevel> {
    let best = SimdLevel::new();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_sse2().map(SimdLevel::Sse2));
        levels.extend(best.as_sse4_2().map(SimdLevel::Sse4_2));
        levels.extend(best.as_avx2().map(SimdLevel::Avx2));
    }
    levels
}

#[test]
fn groups_collide_where_a_pair_does() {
    let mut random = SplitMix(4);
    let mut workspaces: Vec<_> = simd_levels().into_iter().map(GroupWorkspace::with_simd_level).collect();
    let (mut hits, mut asked) = (0, 0);
    for round in 0..30 {
        // One group in ten has more meshes than lanes.
        let counts = if round % 10 == 0 { [3, 19] } else { [1 + random.below(6), 1 + random.below(6)] };
        let [one, other] = counts.map(|n| (0..n).map(|_| mesh(&mut random)).collect::<Vec<_>>());
        let groups = [MeshGroup::new(one.clone()), MeshGroup::new(other.clone())];
        let spread = [0.3, 1.0, 3.0][round % 3] * (counts[0] * counts[1]) as f64 / 10.0;
        for _ in 0..60 {
            let far = [0.0, 10.0, 1e5, 1e7][random.below(4)];
            let around = random.vec(far);
            let [a, b] = [&one, &other].map(|meshes| poses(&mut random, meshes, around, spread.min(2.0)));
            let expected = naive(&one, &a, &other, &b);
            for workspace in &mut workspaces {
                assert_eq!(groups[0].collides(&a, &groups[1], &b, workspace), expected, "{a:?} {b:?}");
                assert_eq!(groups[1].collides(&b, &groups[0], &a, workspace), expected, "{a:?} {b:?}");
            }
            hits += usize::from(expected);
            asked += 1;
        }
    }
    assert!(hits * 5 > asked && hits * 5 < 4 * asked, "{hits} of {asked}");
}

#[test]
fn meshes_that_nearly_touch() {
    let mut random = SplitMix(5);
    let ball = triangulated(&Shape::Sphere(Sphere { radius: 0.1 }), 0);
    let rod = triangulated(&Shape::Cylinder(Cylinder { half_length: 0.4, radius: 0.03 }), 0);
    let groups = [MeshGroup::new(vec![ball.clone(), rod.clone()]), MeshGroup::new(vec![rod.clone(), ball.clone()])];
    let mut workspace = GroupWorkspace::new();
    for _ in 0..2000 {
        let [a, b] = [random.pose(0.2), random.pose(0.2)];
        // The ball's vertices are on the sphere, and its faces within 2 mm of it.
        let gap = random.between(-6e-3, 3e-3);
        let away = random.vec(1.0).try_normalize().unwrap_or(Vec3::X);
        let touching = Pose::new(b.rotation, a.translation + away * (0.2 + gap));
        let aside = Pose::from_translation(Vec3::X * 50.0);
        let (one, other) = ([a, aside], [Pose::from_translation(Vec3::Y * 50.0), touching]);
        let expected = naive(&[ball.clone(), rod.clone()], &one, &[rod.clone(), ball.clone()], &other);
        assert_eq!(groups[0].collides(&one, &groups[1], &other, &mut workspace), expected);
        assert!(!expected || gap < 0.0);
    }
}

/// A mesh inside another one touches it; a mesh in the cavity of a shell does not.
#[test]
fn meshes_in_others() {
    let shape = |radius: f64| tessellate(&Shape::Sphere(Sphere { radius }), 1e-3);
    let (mut vertices, mut triangles) = shape(0.5);
    let solid = Arc::new(TriMesh::new(vertices.clone(), triangles.clone()).unwrap());
    let (inner, cavity) = shape(0.4);
    let first = vertices.len() as u32;
    vertices.extend(inner);
    triangles.extend(cavity.into_iter().map(|[a, b, c]| [a + first, c + first, b + first]));
    let shell = Arc::new(TriMesh::new(vertices, triangles).unwrap());
    let small = Arc::new(TriMesh::new(shape(0.1).0, shape(0.1).1).unwrap());
    let mut workspace = GroupWorkspace::new();
    let mut ask = |around: &Arc<TriMesh>, x: f64| {
        let groups = [around, &small].map(|mesh| MeshGroup::new(vec![mesh.clone()]));
        groups[0].collides(&[Pose::IDENTITY], &groups[1], &[Pose::from_translation(Vec3::X * x)], &mut workspace)
    };
    assert!(ask(&solid, 0.0) && ask(&solid, 0.3) && ask(&solid, 0.55) && !ask(&solid, 0.61));
    assert!(!ask(&shell, 0.0) && !ask(&shell, 0.29) && ask(&shell, 0.45) && !ask(&shell, 0.61));
}

#[test]
fn unknown_counts_as_contact() {
    let group = MeshGroup::new(vec![triangulated(&Shape::Sphere(Sphere { radius: 0.1 }), 0)]);
    let mut workspace = GroupWorkspace::new();
    let here = [Pose::IDENTITY];
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let lost = [Pose::from_translation(Vec3::Y * x)];
        assert!(group.collides(&here, &group, &lost, &mut workspace), "{x}");
        assert!(group.collides(&lost, &group, &here, &mut workspace), "{x}");
    }
    assert!(group.collides(&here, &group, &[], &mut workspace), "a pose is missing");
    let away = [Pose::from_translation(Vec3::Y * 1e9)];
    assert!(!group.collides(&here, &group, &away, &mut workspace));
    let nothing = MeshGroup::new(Vec::new());
    assert!(!group.collides(&here, &nothing, &[], &mut workspace));
    assert!(!nothing.collides(&[], &group, &here, &mut workspace));
}
