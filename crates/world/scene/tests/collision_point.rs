//! Comparison of the collision point with the shapes themselves and with queries link by link.

use crate::common::{Random, RandomGeometry, apart, link, random_state, scene_of, shapes};

use elbowroom_proximity::project_point;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};

use elbowroom_scene::{Checker, CheckerOptions, CollisionPoint, Detail, Scene, SceneState, Selection};

/// Distance (m) of a point from the surface of a collider.
fn distance_to_surface(
    scene: &Scene,
    state: &SceneState,
    id: GeometryId,
    collider: usize,
    p: elbowroom_spatial::Vec3,
) -> f64 {
    let (shape, pose) = &shapes(scene, state, id)[collider];
    project_point(shape, pose, p).signed_distance.abs()
}

fn check(scene: &Scene, state: &SceneState, c: &CollisionPoint) {
    assert!(distance_to_surface(scene, state, c.link, c.collider, c.on_link) < 1e-6, "{c:?}");
    assert!(distance_to_surface(scene, state, c.other, c.other_collider, c.on_other) < 1e-6, "{c:?}");
    assert!((c.normal.length() - 1.0).abs() < 1e-9 && (c.other_normal.length() - 1.0).abs() < 1e-9, "{c:?}");
}

#[test]
fn the_link_nearest_to_a_base_is_reported_with_its_point() {
    let scene = scene_of(31, |_| {});
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(31);
    let (mut met, mut several) = (0, 0);
    for _ in 0..600 {
        let state = random_state(&scene, &mut r);
        let mut all = Vec::new();
        checker.contacts(&state, |c| all.push((c.a, c.b)));
        let found = checker.collision_point(&state, Detail::Exact);
        assert_eq!(found.is_some(), !all.is_empty());
        let Some(c) = found else { continue };
        let (pair, swapped) = ((c.link, c.other), (c.other, c.link));
        assert!(all[0] == pair || all[0] == swapped, "{c:?} {all:?}");
        let depth = |m: GeometryId| if let GeometryId::Link { link, .. } = m { link.0 } else { usize::MAX };
        let highest = all.iter().map(|(a, b)| depth(*a).min(depth(*b))).min().unwrap();
        assert_eq!(depth(c.link), highest);
        assert!(c.touching && c.detail == Detail::Exact);
        check(&scene, &state, &c);
        several += usize::from(all.len() > 1);
        met += 1;
        // Only one robot and the objects.
        let alone =
            checker.between(Selection::Robot(RobotId(1)), Selection::Objects).collision_point(&state, Detail::Exact);
        assert!(alone.is_none_or(
            |c| matches!(c.link, GeometryId::Link { robot: RobotId(1), .. }) && depth(c.other) == usize::MAX
        ));
    }
    assert!(met > 60 && several > 10, "{met} {several}");
}

#[test]
fn boxes_are_conservative_and_deeper_ones_are_tighter() {
    let scene = scene_of(32, |_| {});
    let mut checker =
        Checker::new(&scene, CheckerOptions { start: elbowroom_scene::Level::L3, ..CheckerOptions::default() });
    let mut r = Random(32);
    let details = [Detail::Boxes(0), Detail::Boxes(1), Detail::Boxes(9), Detail::Exact];
    let mut reported = [0; 4];
    for _ in 0..400 {
        let state = random_state(&scene, &mut r);
        let found = details.map(|detail| checker.collision_point(&state, detail));
        for (i, c) in found.iter().enumerate() {
            assert!(c.is_some() || found[3].is_none());
            reported[i] += usize::from(c.is_some());
            let Some(c) = c else { continue };
            assert_eq!(c.detail, details[i]);
            if i < 3 {
                assert!(distance_to_surface(&scene, &state, c.link, c.collider, c.on_link) < 1e-5, "{c:?}");
            }
        }
    }
    assert!(
        reported[0] > reported[1] && reported[1] >= reported[2] && reported[2] >= reported[3] && reported[3] > 30,
        "{reported:?}"
    );
}

#[test]
fn within_a_margin_the_witness_points_are_reported() {
    let scene = scene_of(33, |b| {
        b.padding(link(0, 3), 0.05).padding(link(1, 2), 0.05);
    });
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(33);
    let mut near = 0;
    for _ in 0..400 {
        let state = random_state(&scene, &mut r);
        let found = checker.collision_point(&state, Detail::Exact);
        assert_eq!(found.is_some(), checker.collides(&state).is_some());
        let Some(c) = found.filter(|c| !c.touching) else { continue };
        near += 1;
        check(&scene, &state, &c);
        let gap = apart(&scene, &state, c.link, c.other);
        assert!(gap <= 0.1 && c.on_link.distance(c.on_other) >= gap - 1e-9, "{c:?} {gap}");
    }
    assert!(near > 20, "{near}");
}

#[test]
fn attached_objects_collide_as_their_link_and_nan_is_not_free() {
    let scene = scene_of(34, |_| {});
    let mut state = SceneState::new(&scene);
    state.attach(&scene, ObjectId(5), RobotId(0), elbowroom_kinematics::LinkId(3), &[]).unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(34);
    let mut carried = 0;
    for _ in 0..400 {
        state.set_q(&scene, RobotId(0), &r.q()).unwrap();
        state.set_q(&scene, RobotId(1), &r.q()).unwrap();
        let found = checker.collision_point(&state, Detail::Exact);
        assert_eq!(found.is_some(), checker.collides(&state).is_some());
        let Some(c) = found else { continue };
        check(&scene, &state, &c);
        carried += usize::from([c.link, c.other].contains(&GeometryId::Object(ObjectId(5))));
    }
    assert!(carried > 5, "{carried}");
    state.set_q(&scene, RobotId(0), &[1e300, -1e300, 1e18]).unwrap();
    let _ = checker.collision_point(&state, Detail::Exact);
}

#[test]
fn work_with_meshes_is_that_of_the_query_itself() {
    let scene = scene_of(32, |_| {});
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(33);
    let mut beside_solids = 0;
    for _ in 0..100 {
        let state = random_state(&scene, &mut r);
        // The work of an earlier query must not be counted again.
        let mut by_boxes = |before: fn(&mut Checker<'_>, &SceneState)| {
            before(&mut checker, &state);
            beside_solids += checker.stats().triangles_beside_solids;
            checker.reset_stats();
            checker.collision_point(&state, Detail::Boxes(0));
            let stats = checker.stats();
            checker.reset_stats();
            (stats.mesh_boxes, stats.mesh_triangles, stats.triangles_beside_solids)
        };
        let after_distance = by_boxes(|checker, state| {
            checker.distance(state);
        });
        let after_collides = by_boxes(|checker, state| {
            checker.collides(state);
        });
        assert_eq!(after_distance, after_collides);
    }
    assert!(beside_solids > 0);
}
