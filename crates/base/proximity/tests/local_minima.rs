//! Local minima of the distance of two meshes, compared with all pairs of triangles.

use std::sync::Arc;

use elbowroom_proximity::advanced::{LocalMinimum, NormalConeHierarchy, for_each_local_minimum};
use elbowroom_proximity::{Shape, TriMesh, Workspace, separation};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::Random;

use crate::mesh_pairs::RandomMeshes;

fn minima(
    a: &NormalConeHierarchy,
    a_in_world: &Pose,
    b: &NormalConeHierarchy,
    b_in_world: &Pose,
    margin: f64,
) -> Vec<LocalMinimum> {
    let mut all = Vec::new();
    let workspace = &mut Workspace::new();
    assert!(for_each_local_minimum(a, a_in_world, b, b_in_world, margin, workspace, |pair| all.push(pair)));
    all
}

/// Triangles as shapes of their own, and their corners in the world.
fn triangles(mesh: &TriMesh, in_world: &Pose) -> Vec<(Shape, [Vec3; 3])> {
    let triangle = |t: &[u32; 3]| {
        let corners = t.map(|v| mesh.vertices()[v as usize]);
        let shape = Shape::Mesh(Arc::new(TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap()));
        (shape, corners.map(|p| in_world.transform_point(p)))
    };
    mesh.triangles().iter().map(triangle).collect()
}

/// True if no direction along the surface from `point` leads towards `direction`: the distance grows on all sides. A
/// triangle around the point is the cone of the directions to its corners.
fn is_nearest_of_its_neighbourhood(
    triangles: &[(Shape, [Vec3; 3])],
    mesh_in_world: &Pose,
    point: Vec3,
    direction: Vec3,
) -> bool {
    let at = Shape::Sphere(elbowroom_proximity::Sphere { radius: 0.0 });
    triangles.iter().all(|(shape, corners)| {
        let away = separation(shape, mesh_in_world, &at, &Pose::from_translation(point)).distance;
        away > 1e-12 || corners.iter().all(|&x| (x - point).dot(direction) <= 1e-9)
    })
}

#[test]
fn every_local_minimum_is_found_and_every_distance_is_that_of_its_triangles() {
    let mut random = Random(20);
    let (mut expected, mut listed, mut near) = (0, 0, 0);
    for _ in 0..40 {
        let (a, b) = (Arc::new(random.lump(3)), Arc::new(random.lump(2)));
        let (cones_a, cones_b) = (NormalConeHierarchy::new(a.clone()), NormalConeHierarchy::new(b.clone()));
        let a_in_world = Pose::new(random.rotation(), random.vector());
        let away = random.vector();
        let b_in_world = Pose::new(random.rotation(), a_in_world.translation + away * (0.7 / away.length()));
        let margin = 0.3 * random.unit();
        let found = minima(&cones_a, &a_in_world, &cones_b, &b_in_world, margin);
        let (of_a, of_b) = (triangles(&a, &a_in_world), triangles(&b, &b_in_world));
        for (i, (s, _)) in of_a.iter().enumerate() {
            for (j, (t, _)) in of_b.iter().enumerate() {
                let pair = separation(s, &a_in_world, t, &b_in_world);
                if !(pair.distance > 1e-9 && pair.distance <= margin) {
                    continue;
                }
                near += 1;
                if let Some(same) = found.iter().find(|m| (m.triangle_a, m.triangle_b) == (i as u32, j as u32)) {
                    assert!((same.separation.distance - pair.distance).abs() < 1e-11, "{same:?} {pair:?}");
                }
                let toward_b = (pair.on_b - pair.on_a) / pair.distance;
                if is_nearest_of_its_neighbourhood(&of_a, &a_in_world, pair.on_a, toward_b)
                    && is_nearest_of_its_neighbourhood(&of_b, &b_in_world, pair.on_b, -toward_b)
                {
                    expected += 1;
                    let is_listed = |m: &LocalMinimum| {
                        let apart = m.separation.on_a.distance(pair.on_a).max(m.separation.on_b.distance(pair.on_b));
                        apart < 1e-9
                    };
                    assert!(found.iter().any(is_listed), "triangles {i} and {j}: {pair:?}");
                }
            }
        }
        listed += found.len();
    }
    assert!(expected > 40, "{expected} local minima");
    assert!(listed * 10 < near, "{listed} pairs listed of {near} near ones");
}

#[test]
fn the_distance_itself_and_touching_triangles_are_local_minima() {
    let mut random = Random(21);
    let (mut apart, mut touching) = (0, 0);
    for _ in 0..300 {
        let (a, b) = (Arc::new(random.lump(6)), Arc::new(random.lump(5)));
        let (cones_a, cones_b) = (NormalConeHierarchy::new(a.clone()), NormalConeHierarchy::new(b.clone()));
        let a_in_world = Pose::new(random.rotation(), random.vector());
        let b_in_world = Pose::new(random.rotation(), a_in_world.translation + random.vector() * 0.6);
        let expected = separation(&Shape::Mesh(a), &a_in_world, &Shape::Mesh(b), &b_in_world).distance;
        let found = minima(&cones_a, &a_in_world, &cones_b, &b_in_world, expected + 0.01);
        let least = found.iter().map(|m| m.separation.distance).fold(f64::INFINITY, f64::min);
        if expected > 0.0 {
            apart += 1;
            assert!((least - expected).abs() < 1e-11, "{least} instead of {expected}");
        } else if least < f64::INFINITY {
            touching += 1;
            assert_eq!(least, 0.0);
        }
    }
    assert!(apart > 50 && touching > 30, "{apart} apart, {touching} touching");
}

#[test]
fn open_and_inverted_surfaces_leave_no_direction_out() {
    // A sheet seen from its back, and a cube inside out: their normals say nothing about where the free side is.
    let sheet = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    cube(Vec3::splat(0.5), 1.0, false, &mut vertices, &mut triangles);
    let cube = TriMesh::new(vertices, triangles).unwrap();
    assert!(cube.report().closed && cube.report().inside_out);
    let (sheet, cube) = (NormalConeHierarchy::new(Arc::new(sheet)), NormalConeHierarchy::new(Arc::new(cube)));
    for side in [-1.0, 1.0] {
        let there = Pose::from_translation(Vec3::new(0.1, 0.1, 0.05 * side));
        assert!(!minima(&sheet, &Pose::IDENTITY, &sheet, &there, 0.1).is_empty());
    }
    let above = Pose::from_translation(Vec3::new(0.1, 0.1, 1.05));
    assert!(!minima(&cube, &Pose::IDENTITY, &cube, &above, 0.1).is_empty());
}

/// A cube of edge 1 about a point, with triangles that face outwards or inwards.
fn cube(center: Vec3, edge: f64, outward: bool, vertices: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>) {
    let first = vertices.len() as u32;
    let corner = |i: u32| Vec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - Vec3::splat(0.5);
    vertices.extend((0..8).map(|i| center + corner(i) * edge));
    let inward = [
        [0, 1, 2],
        [1, 3, 2],
        [4, 6, 5],
        [5, 6, 7],
        [0, 4, 1],
        [1, 4, 5],
        [2, 3, 6],
        [3, 7, 6],
        [0, 2, 4],
        [2, 6, 4],
        [1, 5, 3],
        [3, 5, 7],
    ];
    triangles.extend(inward.map(|[a, b, c]: [u32; 3]| if outward { [a, c, b] } else { [a, b, c] }.map(|v| v + first)));
}

#[test]
fn a_part_that_is_inside_out_beside_one_that_is_not_hides_nothing() {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    cube(Vec3::ZERO, 1.0, true, &mut vertices, &mut triangles);
    cube(Vec3::X * 1.5, 0.5, false, &mut vertices, &mut triangles);
    let pair = TriMesh::new(vertices, triangles).unwrap();
    assert!(pair.report().closed && !pair.report().inside_out, "the larger part decides");
    let pair = NormalConeHierarchy::new(Arc::new(pair));
    let mut single = (Vec::new(), Vec::new());
    cube(Vec3::ZERO, 0.2, true, &mut single.0, &mut single.1);
    let single = NormalConeHierarchy::new(Arc::new(TriMesh::new(single.0, single.1).unwrap()));
    let above = Pose::from_translation(Vec3::new(1.5, 0.03, 0.36));
    for found in
        [minima(&pair, &Pose::IDENTITY, &single, &above, 0.05), minima(&single, &above, &pair, &Pose::IDENTITY, 0.05)]
    {
        assert!(found.iter().any(|m| (m.separation.distance - 0.01).abs() < 1e-12), "{found:?}");
    }
}

#[test]
fn seams_that_were_closed_hide_nothing() {
    let mut random = Random(23);
    for _ in 0..20 {
        let lump = random.lump(4);
        // Every triangle has corners of its own, a little off.
        let vertices: Vec<Vec3> = lump
            .triangles()
            .iter()
            .flatten()
            .map(|&v| lump.vertices()[v as usize] + Vec3::from(random.within(2e-8)))
            .collect();
        let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let torn = Arc::new(TriMesh::new(vertices, triangles).unwrap());
        let (cones, other) = (NormalConeHierarchy::new(torn.clone()), Arc::new(random.lump(3)));
        let there = Pose::new(random.rotation(), random.vector() * 0.7);
        let shapes = (Shape::Mesh(torn), Shape::Mesh(other.clone()));
        let expected = separation(&shapes.0, &Pose::IDENTITY, &shapes.1, &there).distance;
        if expected > 0.0 {
            let found = minima(&cones, &Pose::IDENTITY, &NormalConeHierarchy::new(other), &there, expected + 0.01);
            let least = found.iter().map(|m| m.separation.distance).fold(f64::INFINITY, f64::min);
            assert!((least - expected).abs() < 1e-11, "{least} instead of {expected}");
        }
    }
}

#[test]
fn a_pose_that_is_not_a_number_is_not_an_answer() {
    let cube = NormalConeHierarchy::new(Arc::new(Random(1).lump(2)));
    let nowhere = Pose::from_translation(Vec3::X * f64::NAN);
    let workspace = &mut Workspace::new();
    assert!(!for_each_local_minimum(&cube, &Pose::IDENTITY, &cube, &nowhere, 0.1, workspace, |_| ()));
}
