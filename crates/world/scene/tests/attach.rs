//! Comparison of an attached object with the same object placed at the same pose.

use crate::common::{Random, RandomGeometry, apart, link, scene_of};

use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};

use elbowroom_scene::{
    Attachment, Checker, CheckerOptions, PairEdit, PairState, Reason, SceneError, SceneState, Selection,
};
use elbowroom_spatial::{Pose, Vec3};

#[test]
fn an_attached_object_answers_as_the_object_at_its_pose() {
    let scene = scene_of(21, |b| {
        b.padding(GeometryId::Object(ObjectId(5)), 0.01);
    });
    let mut r = Random(21);
    let (mut held, mut placed) = (SceneState::new(&scene), SceneState::new(&scene));
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut plain = Checker::new(&scene, CheckerOptions { weights: false, matrix: false, ..CheckerOptions::default() });
    let in_link = Pose::from_translation(Vec3::Z * 0.55);
    let attachment =
        Attachment { robot: RobotId(0), link: LinkId(3), in_link, touch_links: vec![], visiting_links: vec![] };
    held.attach_at(&scene, ObjectId(5), attachment).unwrap();
    let part = Selection::Object(ObjectId(5));
    let mut seen = [0; 2];
    for _ in 0..200 {
        let (q, p) = (r.q(), r.q());
        for state in [&mut held, &mut placed] {
            state.set_q(&scene, RobotId(0), &q).unwrap();
            state.set_q(&scene, RobotId(1), &p).unwrap();
        }
        let hand = placed.pose(&scene, link(0, 3)).unwrap();
        placed.place(&scene, ObjectId(5), hand * in_link).unwrap();
        assert_eq!(
            held.pose(&scene, GeometryId::Object(ObjectId(5))),
            placed.pose(&scene, GeometryId::Object(ObjectId(5)))
        );
        // The answers are equal for another robot and for every other object.
        let forearm = Selection::Link { robot: RobotId(1), link: LinkId(3) };
        for other in [forearm, Selection::Object(ObjectId(0)), Selection::Object(ObjectId(6))] {
            let (x, y) = (checker.between(part, other).distance(&held), plain.between(part, other).distance(&placed));
            let (x, y) = (x.unwrap(), y.unwrap());
            assert!((x.metres - y.metres).abs() < 1e-12 && (x.a, x.b) == (y.a, y.b), "{x:?} {y:?}");
            seen[usize::from(x.metres > 0.0)] += 1;
        }
        // All pairs one by one.
        let geometries: Vec<GeometryId> = scene.geometries().collect();
        let mut nearest = f64::INFINITY;
        for (i, a) in geometries.iter().enumerate() {
            for b in &geometries[i + 1..] {
                let why = held.pair(&scene, *a, *b).map(|p| p.1);
                if matches!(why, Some(Reason::Default | Reason::OutOfReach { .. })) {
                    let margin = if *b == GeometryId::Object(ObjectId(5)) || *a == GeometryId::Object(ObjectId(5)) {
                        0.01
                    } else {
                        0.0
                    };
                    nearest = nearest.min((apart(&scene, &held, *a, *b) - margin).max(0.0));
                }
            }
        }
        let d = checker.distance(&held).unwrap();
        assert!((d.metres - nearest).abs() < 1e-9, "{d:?} {nearest}");
        assert_eq!(checker.collides(&held).is_some(), nearest == 0.0);
    }
    assert!(seen[0] > 5 && seen[1] > 100, "{seen:?}");
}

#[test]
fn pairs_of_attached_objects_have_their_reasons() {
    let scene = scene_of(22, |b| {
        b.edit(link(0, 1), GeometryId::Object(ObjectId(0)), PairEdit::Skip("behind a curtain".into()));
    });
    let part = GeometryId::Object(ObjectId(0));
    let mut state = SceneState::new(&scene);
    assert_eq!(state.pair(&scene, part, GeometryId::Object(ObjectId(1))), None);
    assert_eq!(state.pair(&scene, part, link(0, 0)), Some((PairState::Skipped, Reason::NoJointBetween)));
    state.attach(&scene, ObjectId(0), RobotId(0), LinkId(3), &[LinkId(2)]).unwrap();
    let of = |state: &SceneState, m| state.pair(&scene, part, m);
    assert_eq!(of(&state, link(0, 3)), Some((PairState::Skipped, Reason::Attached("meshes/forearm".into()))));
    assert_eq!(of(&state, link(0, 2)), Some((PairState::Skipped, Reason::MayTouch("meshes/upper_arm".into()))));
    assert_eq!(of(&state, link(0, 1)), Some((PairState::Skipped, Reason::ByHand("behind a curtain".into()))));
    for tested in [link(0, 0), link(1, 0), link(1, 3), GeometryId::Object(ObjectId(1)), GeometryId::Object(ObjectId(6))]
    {
        assert_eq!(of(&state, tested), Some((PairState::Tested, Reason::Default)), "{tested:?}");
    }
    // Two tools on one flange form no pair.
    state.attach(&scene, ObjectId(1), RobotId(0), LinkId(3), &[]).unwrap();
    assert!(matches!(of(&state, GeometryId::Object(ObjectId(1))), Some((PairState::Skipped, Reason::Attached(_)))));
    // An object attached to a base is as stationary as the objects around it.
    state.detach(&scene, ObjectId(1)).unwrap();
    state.attach(&scene, ObjectId(1), RobotId(1), LinkId(0), &[]).unwrap();
    let pair = state.pair(&scene, GeometryId::Object(ObjectId(1)), GeometryId::Object(ObjectId(2)));
    assert_eq!(pair, Some((PairState::Skipped, Reason::NoJointBetween)));
}

#[test]
fn links_of_another_robot_may_touch_an_object_while_they_visit() {
    let scene = scene_of(22, |_| {});
    let (object, part) = (ObjectId(0), GeometryId::Object(ObjectId(0)));
    let mut state = SceneState::new(&scene);
    let held = Attachment {
        robot: RobotId(0),
        link: LinkId(3),
        in_link: Pose::IDENTITY,
        touch_links: vec![],
        visiting_links: vec![(RobotId(1), LinkId(3))],
    };
    state.attach_at(&scene, object, held.clone()).unwrap();
    let of = |state: &SceneState, m| state.pair(&scene, part, m).unwrap().0;
    assert_eq!([link(1, 3), link(1, 2), link(0, 2)].map(|m| of(&state, m)), {
        use PairState::{Skipped, Tested};
        [Skipped, Tested, Tested]
    });
    // The visitor does not count in queries either: without it, the pair is found.
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let visitor = Selection::Link { robot: RobotId(1), link: LinkId(3) };
    assert!(checker.between(part.into(), visitor).is_empty(&state));
    state.detach(&scene, object).unwrap();
    state.attach_at(&scene, object, Attachment { visiting_links: vec![], ..held.clone() }).unwrap();
    assert!(!checker.between(part.into(), visitor).is_empty(&state));
    state.detach(&scene, object).unwrap();
    let unknown = Attachment { visiting_links: vec![(RobotId(1), LinkId(99))], ..held };
    assert!(matches!(state.attach_at(&scene, object, unknown), Err(SceneError::NoSuchLink { index: 99, .. })));
}

#[test]
fn a_detached_object_keeps_its_pose_and_errors_are_reported() {
    let scene = scene_of(23, |_| {});
    let mut state = SceneState::new(&scene);
    state.attach(&scene, ObjectId(2), RobotId(1), LinkId(3), &[]).unwrap();
    let again = state.attach(&scene, ObjectId(2), RobotId(0), LinkId(3), &[]).unwrap_err().to_string();
    assert!(again.contains("`thing 2` is attached to `mixed/forearm`; detach it first"), "{again}");
    assert!(state.place(&scene, ObjectId(2), Pose::IDENTITY).is_err());
    state.set_q(&scene, RobotId(1), &[0.7, 0.6, 0.5]).unwrap();
    let there = state.pose(&scene, GeometryId::Object(ObjectId(2))).unwrap();
    state.detach(&scene, ObjectId(2)).unwrap();
    assert!(state.detach(&scene, ObjectId(2)).is_err());
    state.set_q(&scene, RobotId(1), &[0.0; 3]).unwrap();
    assert_eq!(state.pose(&scene, GeometryId::Object(ObjectId(2))), Some(there));
    assert!(state.attach(&scene, ObjectId(99), RobotId(0), LinkId(0), &[]).is_err());
    assert!(state.attach(&scene, ObjectId(0), RobotId(9), LinkId(0), &[]).is_err());
    assert!(state.attach(&scene, ObjectId(0), RobotId(0), LinkId(0), &[LinkId(44)]).is_err());
    // The pose at which the object was detached counts, not its pose in the scene.
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let d = checker.between(Selection::Object(ObjectId(2)), Selection::Robots).distance(&state).unwrap();
    assert!((apart(&scene, &state, d.a, d.b) - d.metres).abs() < 1e-9);
}
