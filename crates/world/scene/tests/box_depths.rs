//! Depths of the box trees: boxes that enclose, answers that only improve, parts inside meshes.

use std::sync::Arc;

use elbowroom_proximity::{Cuboid, Shape, Sphere, TriMesh, tessellate::tessellate};
use elbowroom_robot::{GeometryId, ObjectId};
use elbowroom_scene::{Checker, CheckerOptions, Level, Object, Scene, SceneState, Selection};
use elbowroom_spatial::{Obb, Pose, Vec3};
use proptest::prelude::*;

use crate::common::{Random, RandomGeometry, random_state, scene_of};

fn depths() -> impl Iterator<Item = Level> {
    (0..=Level::MAX_DEPTH).map(Level::boxes)
}

fn checkers(scene: &Scene) -> Vec<Checker<'_>> {
    depths().map(|level| Checker::new(scene, CheckerOptions { level, ..CheckerOptions::default() })).collect()
}

#[test]
fn deeper_answers_are_never_worse_and_never_beyond_the_exact_answer() {
    let scene = scene_of(21, |_| {});
    let (mut exact, mut by_depth) = (Checker::new(&scene, CheckerOptions::default()), checkers(&scene));
    let mut r = Random(22);
    let (mut better, mut free) = ([0; Level::MAX_DEPTH as usize], [0; Level::MAX_DEPTH as usize + 1]);
    for _ in 0..250 {
        let state = random_state(&scene, &mut r);
        let tolerance = r.between(0.0, 0.1);
        let (truth, apart) = (exact.distance(&state).unwrap(), exact.collides(&state).is_none());
        let near = exact.within(&state, tolerance).is_some();
        let (mut last, mut was_free, mut was_far) = (0.0, false, false);
        for (depth, checker) in by_depth.iter_mut().enumerate() {
            let level = checker.options().level;
            let found = checker.distance(&state).unwrap();
            assert!(found.metres >= last, "{level}: {} after {last}", found.metres);
            assert!(found.metres <= truth.metres + 1e-12 && found.lower_bound <= found.metres, "{level} {found:?}");
            let is_free = checker.collides(&state).is_none();
            let is_far = checker.within(&state, tolerance).is_none();
            assert!((is_free || !was_free) && (apart || !is_free), "{level} {is_free} {was_free} {apart}");
            assert!((is_far || !was_far) && !(near && is_far), "{level} {is_far} {was_far} {near}");
            if depth > 0 {
                better[depth - 1] += u32::from(found.metres > last + 1e-6);
            }
            free[depth] += u32::from(is_free);
            (last, was_free, was_far) = (found.metres, is_free, is_far);
        }
    }
    assert!(better[..3].iter().all(|n| *n > 10), "{better:?}");
    assert!(free[0] < free[2] && free[2] < free[Level::MAX_DEPTH as usize], "{free:?}");
}

#[test]
fn every_level_of_the_objects_is_found_by_its_name_and_counts_as_l2() {
    let scene = scene_of(23, |_| {});
    let state = SceneState::new(&scene);
    let level = Level::boxes(2);
    let mut checker = Checker::new(&scene, CheckerOptions { level, ..CheckerOptions::default() });
    let found = checker.distance(&state).unwrap();
    assert_eq!((found.level, checker.last_level()), (level, level));
    let stats = checker.stats();
    assert!(stats.pairs_tested.l2 > 0 && stats.answered.get(level) == 1 && stats.answered.get(Level::L2) == 1);
}

/// A scene of two objects, compared at every depth and exactly: distances from depth 0 on, then the exact distance.
fn distances(a: Shape, b: Shape, b_in_world: Pose) -> Vec<f64> {
    let mut builder = Scene::builder();
    builder.object(Object { name: "a".into(), shape: a, in_world: Pose::IDENTITY });
    builder.object(Object { name: "b".into(), shape: b, in_world: b_in_world });
    let scene = builder.build().unwrap();
    let state = SceneState::new(&scene);
    let [a, b] = [ObjectId(0), ObjectId(1)].map(Selection::Object);
    let levels = depths().chain([Level::L3]);
    let distance = |level| {
        let mut checker = Checker::new(&scene, CheckerOptions { level, ..CheckerOptions::default() });
        let metres = checker.between(a, b).distance(&state).unwrap().metres;
        let collides = checker.between(a, b).collides(&state).is_some();
        assert!(collides || metres > 0.0, "{level}: free, but at distance {metres}");
        assert!(!collides || metres < 1e-9, "{level}: in contact, but at distance {metres}");
        metres
    };
    levels.map(distance).collect()
}

fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Shape {
    Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
}

fn ball(radius: f64, chord_m: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    tessellate(&Shape::Sphere(Sphere { radius }), chord_m)
}

/// The boxes of a deep level leave the inside of a mesh empty, but the solid is not.
#[test]
fn what_is_inside_a_closed_mesh_is_in_contact_at_every_depth() {
    let (vertices, triangles) = ball(1.0, 0.002);
    let shell = || mesh(vertices.clone(), triangles.clone());
    let (small, faces) = ball(0.05, 0.005);
    let here = Pose::from_translation(Vec3::new(0.1, -0.2, 0.15));
    for inner in [
        Shape::Sphere(Sphere { radius: 0.05 }),
        Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.04) }),
        mesh(small.clone(), faces.clone()),
    ] {
        assert!(distances(shell(), inner.clone(), here).iter().all(|d| *d == 0.0));
        assert!(distances(inner, shell(), here.inverse()).iter().all(|d| *d == 0.0));
    }
    // Of two parts one is inside and one far away.
    let count = small.len() as u32;
    let both = small.iter().copied().chain(small.iter().map(|p| *p + Vec3::X * 3.0)).collect();
    let of_both = faces.iter().flat_map(|t| [*t, t.map(|i| i + count)]).collect();
    assert!(distances(mesh(both, of_both), shell(), here.inverse()).iter().all(|d| *d == 0.0));
    // An open shell has no inside: deep boxes prove the ball free, as the exact level does.
    let open =
        distances(mesh(vertices.clone(), triangles[20..].to_vec()), Shape::Sphere(Sphere { radius: 0.05 }), here);
    assert!(open[0] == 0.0 && open[8] > 0.3 && open.windows(2).all(|d| d[0] <= d[1]), "{open:?}");
}

#[test]
fn degenerate_meshes_have_boxes_and_conservative_answers() {
    let there = Pose::from_xyz_rpy([0.7, 0.9, 1.4], [0.3, 0.2, -0.7]);
    let corners = || vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let far = |p: Vec3| p * 1e9;
    for (name, vertices, triangles) in [
        ("one triangle", corners(), vec![[0, 1, 2]]),
        ("one triangle many times", corners(), vec![[0, 1, 2]; 200]),
        ("a line", corners(), vec![[0, 1, 1]; 9]),
        ("a point", corners(), vec![[3, 3, 3]; 7]),
        ("points and a triangle", corners(), vec![[0, 0, 0], [1, 1, 1], [0, 1, 2], [2, 2, 2]]),
        ("a fan", corners(), vec![[0, 1, 2], [0, 2, 3], [0, 3, 1]]),
        ("huge", corners().into_iter().map(far).collect(), vec![[0, 1, 2], [0, 2, 3]]),
        ("tiny", corners().into_iter().map(|p| p * 1e-12).collect(), vec![[0, 1, 2], [0, 2, 3]]),
    ] {
        let shape = mesh(vertices, triangles);
        for other in [shape.clone(), Shape::Sphere(Sphere { radius: 0.2 }), mesh(corners(), vec![[0, 1, 2], [0, 2, 3]])]
        {
            let all = distances(shape.clone(), other, there);
            assert!(all.windows(2).all(|d| d[0] <= d[1] + 1e-9 * d[1].abs()), "{name}: {all:?}");
        }
    }
}

fn boxes_of(shape: Shape) -> Vec<Vec<Obb>> {
    let mut builder = Scene::builder();
    builder.object(Object { name: "a".into(), shape, in_world: Pose::IDENTITY });
    let scene = builder.build().unwrap();
    (0..=Level::MAX_DEPTH).map(|depth| scene.boxes(GeometryId::Object(ObjectId(0)), depth)).collect()
}

#[test]
fn a_primitive_has_one_box_and_a_plane_none() {
    let mut r = Random(3);
    for kind in 0..5 {
        let all = boxes_of(r.shape(kind, 0.2));
        assert!(all.iter().all(|boxes| boxes.len() == 1 && boxes[0] == all[0][0]), "{kind}");
    }
    assert!(boxes_of(Shape::HalfSpace(elbowroom_proximity::HalfSpace)).iter().all(Vec::is_empty));
    // Beyond the deepest level nothing changes.
    let (vertices, triangles) = ball(0.3, 0.002);
    let mut builder = Scene::builder();
    builder.object(Object { name: "a".into(), shape: mesh(vertices, triangles), in_world: Pose::IDENTITY });
    let scene = builder.build().unwrap();
    let at = |depth| scene.boxes(GeometryId::Object(ObjectId(0)), depth);
    assert_eq!(at(255), at(Level::MAX_DEPTH));
    assert_eq!([0, 1, 2, 3].map(|depth| at(depth).len()), [1, 2, 4, 8]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Arbitrary triangles: a box of every depth contains all three corners.
    #[test]
    fn every_triangle_is_inside_a_box_of_every_depth(
        corners in prop::collection::vec((-4..4_i8, -4..4_i8, -4..4_i8), 3..30),
        faces in prop::collection::vec((0..30_usize, 0..30_usize, 0..30_usize), 1..80),
        scale in prop::sample::select(vec![1e-9, 0.01, 1.0, 1e7]),
    ) {
        let vertices: Vec<Vec3> = corners
            .iter()
            .map(|c| Vec3::new(f64::from(c.0), f64::from(c.1), f64::from(c.2)) * scale + Vec3::splat(0.3 * scale))
            .collect();
        let n = vertices.len();
        let triangles: Vec<[u32; 3]> = faces.iter().map(|f| [f.0 % n, f.1 % n, f.2 % n].map(|i| i as u32)).collect();
        let all = boxes_of(mesh(vertices.clone(), triangles.clone()));
        for (depth, boxes) in all.iter().enumerate() {
            prop_assert!(boxes.len() <= 1 << depth && boxes.len() <= triangles.len().max(1));
            for t in &triangles {
                let corners = t.map(|i| vertices[i as usize]);
                prop_assert!(boxes.iter().any(|b| corners.iter().all(|p| b.contains(*p))), "depth {depth}, {t:?}");
            }
        }
        prop_assert!(all.windows(2).all(|pair| pair[0].len() <= pair[1].len()));
    }
}
