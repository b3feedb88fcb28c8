//! The collision point against the solids themselves and against asking link by link.

mod common;

use common::{Random, apart, link, scene_of, solids};
use elbowroom_proximity::project_point;
use elbowroom_scene::{Checker, CollisionPoint, Detail, Member, Options, Scene, SceneState, Selection};

fn random_state(scene: &Scene, r: &mut Random) -> SceneState {
    let mut state = SceneState::new(scene);
    for robot in 0..scene.robots().len() {
        state.set_q(scene, robot, &r.q()).unwrap();
    }
    state
}

/// How far a point is from the surface of the named body, metres.
fn off(scene: &Scene, state: &SceneState, member: Member, body: usize, p: elbowroom_spatial::Vec3) -> f64 {
    let (shape, pose) = &solids(scene, state, member)[body];
    project_point(shape, pose, p).signed_distance.abs()
}

fn check(scene: &Scene, state: &SceneState, c: &CollisionPoint) {
    assert!(off(scene, state, c.link, c.body, c.on_link) < 1e-6, "{c:?}");
    assert!(off(scene, state, c.other, c.other_body, c.on_other) < 1e-6, "{c:?}");
    assert!((c.normal.length() - 1.0).abs() < 1e-9 && (c.other_normal.length() - 1.0).abs() < 1e-9, "{c:?}");
}

#[test]
fn the_link_nearest_to_a_base_is_told_with_its_point() {
    let scene = scene_of(31, |_| {});
    let mut checker = Checker::new(&scene, Options::default());
    let mut r = Random(31);
    let (mut met, mut several) = (0, 0);
    for _ in 0..600 {
        let state = random_state(&scene, &mut r);
        let mut all = Vec::new();
        checker.contacts(&state, |c| all.push((c.a, c.b)));
        let found = checker.collision(&state, Detail::Exact);
        assert_eq!(found.is_some(), !all.is_empty());
        let Some(c) = found else { continue };
        let (pair, swapped) = ((c.link, c.other), (c.other, c.link));
        assert!(all[0] == pair || all[0] == swapped, "{c:?} {all:?}");
        let depth = |m: Member| if let Member::Link { link, .. } = m { link.0 } else { usize::MAX };
        let highest = all.iter().map(|(a, b)| depth(*a).min(depth(*b))).min().unwrap();
        assert_eq!(depth(c.link), highest);
        assert!(c.touching && c.level == Detail::Exact);
        check(&scene, &state, &c);
        several += usize::from(all.len() > 1);
        met += 1;
        // One robot and the objects alone.
        let alone = checker.between(Selection::Robot(1), Selection::Objects).collision(&state, Detail::Exact);
        assert!(alone.is_none_or(|c| matches!(c.link, Member::Link { robot: 1, .. }) && depth(c.other) == usize::MAX));
    }
    assert!(met > 60 && several > 10, "{met} {several}");
}

#[test]
fn boxes_are_on_the_safe_side_and_the_deeper_the_closer() {
    let scene = scene_of(32, |_| {});
    let mut checker = Checker::new(&scene, Options { start: elbowroom_scene::Level::L3, ..Options::default() });
    let mut r = Random(32);
    let levels = [Detail::Boxes(0), Detail::Boxes(1), Detail::Boxes(9), Detail::Exact];
    let mut told = [0; 4];
    for _ in 0..400 {
        let state = random_state(&scene, &mut r);
        let found = levels.map(|detail| checker.collision(&state, detail));
        for (i, c) in found.iter().enumerate() {
            assert!(c.is_some() || found[3].is_none());
            told[i] += usize::from(c.is_some());
            let Some(c) = c else { continue };
            assert_eq!(c.level, levels[i]);
            if i < 3 {
                assert!(off(&scene, &state, c.link, c.body, c.on_link) < 1e-5, "{c:?}");
            }
        }
    }
    assert!(told[0] > told[1] && told[1] >= told[2] && told[2] >= told[3] && told[3] > 30, "{told:?}");
}

#[test]
fn within_a_margin_the_nearest_points_are_told() {
    let scene = scene_of(33, |b| {
        b.padding(link(0, 3), 0.05).padding(link(1, 2), 0.05);
    });
    let mut checker = Checker::new(&scene, Options::default());
    let mut r = Random(33);
    let mut near = 0;
    for _ in 0..400 {
        let state = random_state(&scene, &mut r);
        let found = checker.collision(&state, Detail::Exact);
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
fn what_is_carried_collides_as_its_link_does_and_no_number_is_not_free() {
    let scene = scene_of(34, |_| {});
    let mut state = SceneState::new(&scene);
    state.attach(&scene, 5, 0, elbowroom_kinematics::LinkId(3), &[]).unwrap();
    let mut checker = Checker::new(&scene, Options::default());
    let mut r = Random(34);
    let mut carried = 0;
    for _ in 0..400 {
        state.set_q(&scene, 0, &r.q()).unwrap();
        state.set_q(&scene, 1, &r.q()).unwrap();
        let found = checker.collision(&state, Detail::Exact);
        assert_eq!(found.is_some(), checker.collides(&state).is_some());
        let Some(c) = found else { continue };
        check(&scene, &state, &c);
        carried += usize::from([c.link, c.other].contains(&Member::Object(5)));
    }
    assert!(carried > 5, "{carried}");
    state.set_q(&scene, 0, &[1e300, -1e300, 1e18]).unwrap();
    let _ = checker.collision(&state, Detail::Exact);
}
