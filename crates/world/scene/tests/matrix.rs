//! The allowed collision matrix: complete, proven, saved and loaded.

use crate::common;
use std::collections::HashSet;

use crate::common::{Random, RandomGeometry, apart, link, scene_of};

use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId, collision_pairs};

use elbowroom_scene::{
    AllowedCollisionMatrix, Checker, CheckerOptions, Object, PairEdit, PairState, Reason, Scene, SceneState,
};
use elbowroom_spatial::{Pose, Vec3};

/// Two arms so far apart that some links never meet.
fn wide() -> Scene {
    let mut b = Scene::builder();
    b.robot("left", common::mesh_arm(), Pose::IDENTITY);
    b.robot("right", elbowroom_robot::example::arm().unwrap(), Pose::from_translation(Vec3::X * 1.7));
    for (name, x) in [("near", 0.5), ("far", -2.5)] {
        let shape = Random(3).shape(5, 0.1);
        b.object(Object { name: name.into(), shape, in_world: Pose::from_translation(Vec3::new(x, 0.3, 0.5)) });
    }
    b.build().unwrap()
}

#[test]
fn every_pair_has_an_entry_and_the_pair_rules_apply() {
    let mut arm = elbowroom_robot::example::arm().unwrap();
    arm.disabled_pairs.push((LinkId(3), LinkId(1), "Never".into()));
    let mut b = Scene::builder();
    b.robot("a", arm.clone(), Pose::IDENTITY);
    b.robot("b", arm.clone(), Pose::from_translation(Vec3::X));
    b.object(Object { name: "thing".into(), shape: Random(1).shape(3, 0.1), in_world: Pose::IDENTITY });
    b.prove_out_of_reach(false);
    let scene = b.build().unwrap();
    let entries = scene.allowed_collision_matrix().entries();
    assert_eq!(entries.len(), 8 * 7 / 2 + 8);
    assert!(entries.iter().all(|e| e.a < e.b && scene.allowed_collision_matrix().get(e.b, e.a) == Some(e)));
    let robots: Vec<&Robot> = scene.robots().iter().map(|r| &r.robot).collect();
    let by_rule: HashSet<_> = collision_pairs(&robots, 1).into_iter().collect();
    for e in entries {
        assert_eq!(by_rule.contains(&(e.a, e.b)), e.state == PairState::Tested, "{e:?}");
    }
    let why = |a, b| scene.allowed_collision_matrix().get(a, b).unwrap().reason.clone();
    assert_eq!(why(link(0, 1), link(0, 3)), Reason::Srdf("Never".into()));
    assert_eq!(why(link(0, 1), link(0, 2)), Reason::Adjacent);
    assert_eq!(why(link(0, 0), link(1, 0)), Reason::NoJointBetween);
    assert_eq!(why(link(0, 0), GeometryId::Object(ObjectId(0))), Reason::NoJointBetween);
    // Distal links first.
    let weight = |a, b| scene.allowed_collision_matrix().get(a, b).unwrap().weight;
    assert!(weight(link(0, 3), link(1, 3)) > weight(link(0, 3), link(1, 2)));
    assert!(weight(link(0, 3), GeometryId::Object(ObjectId(0))) > weight(link(0, 1), GeometryId::Object(ObjectId(0))));
}

#[test]
fn pairs_out_of_reach_are_never_nearer_than_proven() {
    let scene = wide();
    let proven: Vec<_> = scene
        .allowed_collision_matrix()
        .entries()
        .iter()
        .filter_map(|e| if let Reason::OutOfReach { least_m } = e.reason { Some((e.a, e.b, least_m)) } else { None })
        .collect();
    let joints = |m: GeometryId| if let GeometryId::Link { link, .. } = m { link.0 } else { 0 };
    assert!(proven.len() > 5, "{}", scene.allowed_collision_matrix().to_text(&scene));
    assert!(proven.iter().any(|p| joints(p.0) + joints(p.1) > 3), "balls");
    let mut r = Random(31);
    for _ in 0..3000 {
        let mut state = SceneState::new(&scene);
        state.set_q(&scene, RobotId(0), &r.q()).unwrap();
        state.set_q(&scene, RobotId(1), &r.q()).unwrap();
        for (a, b, least) in &proven {
            assert!(apart(&scene, &state, *a, *b) >= *least, "{a:?} {b:?} {least}");
        }
    }
}

#[test]
fn proofs_are_not_used_where_they_do_not_hold() {
    // The forearm reaches down to the base only beyond these limits.
    let mut arm = elbowroom_robot::example::arm().unwrap();
    let mut joints = arm.chain.joints().to_vec();
    joints[1].limits = elbowroom_kinematics::Limits::symmetric(0.5);
    joints[2].limits = elbowroom_kinematics::Limits::symmetric(0.3);
    arm.chain = elbowroom_kinematics::Chain::new("arm", arm.chain.links().to_vec(), joints).unwrap();
    let mut b = Scene::builder();
    b.robot("arm", arm, Pose::IDENTITY);
    b.object(Object {
        name: "post".into(),
        shape: Random(1).shape(0, 0.1),
        in_world: Pose::from_translation(Vec3::Y * 3.0),
    });
    let scene = b.build().unwrap();
    let reason = |a, b| scene.allowed_collision_matrix().get(a, b).unwrap().reason.clone();
    assert!(matches!(reason(link(0, 3), link(0, 0)), Reason::OutOfReach { .. }));
    assert!(matches!(reason(link(0, 3), GeometryId::Object(ObjectId(0))), Reason::OutOfReach { .. }));
    let mut state = SceneState::new(&scene);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    assert!(checker.collides(&state).is_none());
    assert!(checker.stats().pairs_skipped > 0);
    let mut r = Random(9);
    let only_base_link = |state: &SceneState| {
        let touches = |a, b| apart(&scene, state, a, b) == 0.0;
        touches(link(0, 0), link(0, 3)) && !touches(link(0, 0), link(0, 2)) && !touches(link(0, 1), link(0, 3))
    };
    while !only_base_link(&state) {
        state.set_q(&scene, RobotId(0), &[0.0, r.between(-3.0, 3.0), r.between(-3.0, 3.0)]).unwrap();
    }
    let c = checker.collides(&state).expect("beyond the limits it touches");
    assert_eq!((c.a, c.b), (link(0, 0), link(0, 3)));
    // The current pose of a moved object counts.
    state.set_q(&scene, RobotId(0), &[0.0; 3]).unwrap();
    assert!(checker.collides(&state).is_none());
    let hand = state.pose(&scene, link(0, 3)).unwrap();
    state.place(&scene, ObjectId(0), hand).unwrap();
    assert_eq!(checker.collides(&state).map(|c| c.b), Some(GeometryId::Object(ObjectId(0))));
}

#[test]
fn text_round_trips_and_errors_are_explained() {
    let scene = scene_of(41, |b| {
        b.padding(link(0, 3), 0.01)
            .edit(link(0, 2), GeometryId::Object(ObjectId(1)), PairEdit::Skip("a \"guard\" is\nbetween".into()))
            .edit(link(0, 2), link(1, 3), PairEdit::Margin(0.03))
            .edit(link(1, 3), link(0, 3), PairEdit::Weight(99.5))
            .edit(
                GeometryId::Object(ObjectId(1)),
                GeometryId::Object(ObjectId(0)),
                PairEdit::Skip("it stands there".into()),
            );
    });
    let mut matrix = scene.allowed_collision_matrix().sampled(&scene, 200);
    let text = matrix.to_text(&scene);
    assert_eq!(AllowedCollisionMatrix::from_text(&scene, &text).unwrap(), matrix);
    assert_eq!(matrix.to_text(&scene), text);
    assert!(matrix.accept_suggestions() > 0);
    let accepted = matrix.to_text(&scene);
    assert_eq!(AllowedCollisionMatrix::from_text(&scene, &accepted).unwrap(), matrix);
    let changed = scene.clone().with_allowed_collision_matrix(matrix.clone()).unwrap();
    assert_eq!(changed.allowed_collision_matrix(), &matrix);
    // Another build gives the same text.
    let again = scene_of(41, |b| _ = b.padding(link(0, 3), 0.01));
    assert_eq!(
        scene_of(41, |b| _ = b.padding(link(0, 3), 0.01)).allowed_collision_matrix().to_text(&again),
        again.allowed_collision_matrix().to_text(&again)
    );

    let error = |text: &str| AllowedCollisionMatrix::from_text(&scene, text).unwrap_err().to_string();
    let row = |a: &str, b: &str, rest: &str| format!("version = 1\npairs = [{{ a = \"{a}\", b = \"{b}\", {rest} }}]");
    let fine = "margin_m = 0.0, weight = 1.0";
    let unknown =
        error(&row("mesh/forearm", "mixed/forearm", &format!("state = \"tested\", reason = \"default\", {fine}")));
    assert!(unknown.contains("`mesh/forearm`") && unknown.contains("did you mean meshes/forearm"), "{unknown}");
    let untrue =
        error(&row("meshes/forearm", "mixed/forearm", &format!("state = \"skipped\", reason = \"adjacent\", {fine}")));
    assert!(untrue.contains("the model has") && untrue.contains("by_hand"), "{untrue}");
    let bad = error(&row(
        "meshes/forearm",
        "mixed/forearm",
        "state = \"tested\", reason = \"default\", margin_m = -1.0, weight = 1.0",
    ));
    assert!(bad.contains("margin_m is -1"), "{bad}");
    let objects = error(&row("thing 0", "thing 1", &format!("state = \"tested\", reason = \"default\", {fine}")));
    assert!(objects.contains("no pair of the matrix"), "{objects}");
    assert!(error("version = 2").contains("version 2"));
    assert!(error("pairs = 7").contains("cannot be read"));
    let other = wide();
    assert!(scene.clone().with_allowed_collision_matrix(other.allowed_collision_matrix().clone()).is_err());
}

#[test]
fn edits_count_and_samples_only_suggest() {
    let plain = scene_of(42, |_| {});
    let mut r = Random(42);
    let mut checker = Checker::new(&plain, CheckerOptions::default());
    let (state, contact) = loop {
        let mut state = SceneState::new(&plain);
        state.set_q(&plain, RobotId(0), &r.q()).unwrap();
        let mut all = Vec::new();
        checker.contacts(&state, |c| all.push(c));
        if let [only] = all[..] {
            break (state, only);
        }
    };
    let skipping = scene_of(42, |b| _ = b.edit(contact.b, contact.a, PairEdit::Skip("known".into())));
    let mut same = SceneState::new(&skipping);
    same.set_q(&skipping, RobotId(0), state.q(RobotId(0))).unwrap();
    assert!(Checker::new(&skipping, CheckerOptions::default()).collides(&same).is_none());
    // Edits by hand apply with any options.
    assert!(
        Checker::new(&skipping, CheckerOptions { matrix: false, ..CheckerOptions::default() })
            .collides(&same)
            .is_none()
    );
    // An adjacent link may be tested by hand.
    let neighbours = scene_of(42, |b| _ = b.edit(link(0, 2), link(0, 3), PairEdit::Test("they overlap".into())));
    let contact =
        Checker::new(&neighbours, CheckerOptions::default()).between(link(0, 2).into(), link(0, 3).into()).len(&same);
    assert_eq!(contact, 1);
    // A margin on one pair.
    let margin = scene_of(42, |b| _ = b.edit(link(0, 1), link(1, 1), PairEdit::Margin(3.0)));
    let c = Checker::new(&margin, CheckerOptions { weights: false, ..CheckerOptions::default() })
        .between(link(0, 1).into(), link(1, 1).into())
        .collides(&SceneState::new(&margin));
    assert!(c.is_some());
    // Suggestions change nothing until they are accepted.
    let sampled =
        plain.clone().with_allowed_collision_matrix(plain.allowed_collision_matrix().sampled(&plain, 300)).unwrap();
    assert_eq!(sampled.allowed_collision_matrix().tested(), plain.allowed_collision_matrix().tested());
    assert_eq!(
        plain.allowed_collision_matrix().sampled(&plain, 300),
        plain.allowed_collision_matrix().sampled(&plain, 300)
    );
    let text = sampled.allowed_collision_matrix().to_text(&sampled);
    assert!(text.contains("never_in_samples = { confidence = 0.95, samples = 300 }"), "{text}");
    let mistake = Scene::builder().build().unwrap();
    let mut empty = mistake.allowed_collision_matrix().clone();
    assert!(
        empty
            .edit(&mistake, link(0, 1), link(3, 1), PairEdit::Margin(0.1))
            .unwrap_err()
            .to_string()
            .contains("no pair")
    );
}
