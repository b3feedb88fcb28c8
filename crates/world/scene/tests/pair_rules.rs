//! Rules between selections: their effect on a scene, on an attached object, and on the first contacts of a run.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_scene::{
    Checker, CheckerOptions, FirstContacts, MergedRobots, PairEdit, PairRule, PairRules, PairState, Reason, Scene,
    SceneState, Selection, example,
};

const PART: GeometryId = GeometryId::Object(ObjectId(0));
const TABLE: GeometryId = GeometryId::Object(ObjectId(1));

fn rule(a: Selection, b: Selection, edit: PairEdit) -> PairRule {
    PairRule { a, b, edit }
}

fn skip(why: &str) -> PairEdit {
    PairEdit::Skip(why.into())
}

/// The example's two arms, part and table, with rules.
fn scene(rules: PairRules) -> Scene {
    let plain = example::two_arms();
    let mut builder = Scene::builder();
    for r in plain.robots() {
        builder.robot(r.name.clone(), r.robot.clone(), r.base_in_world);
    }
    for o in plain.objects() {
        builder.object(o.clone());
    }
    builder.rules(rules);
    builder.build().unwrap()
}

fn holding(scene: &Scene) -> SceneState {
    let mut state = SceneState::new(scene);
    state.attach(scene, ObjectId(0), RobotId(0), LinkId(3), &[]).unwrap();
    state
}

#[test]
fn a_carried_part_may_touch_what_the_rules_say() {
    let plain = scene(PairRules::default());
    assert_eq!(plain.name(PART), "part");
    assert_eq!(holding(&plain).pair(&plain, PART, TABLE), Some((PairState::Tested, Reason::Default)));
    assert_eq!(SceneState::new(&plain).pair(&plain, PART, TABLE), None);
    for other in [Selection::from(TABLE), Selection::All, Selection::Objects] {
        let rules = PairRules::from_iter([rule(PART.into(), other, skip("it stands there"))]);
        let scene = scene(rules);
        let expected = Some((PairState::Skipped, Reason::ByHand("it stands there".into())));
        assert_eq!(holding(&scene).pair(&scene, PART, TABLE), expected, "{other:?}");
        assert_eq!(holding(&scene).pair(&scene, TABLE, PART), expected);
        // The rules also apply after several robots are merged into one.
        let merged = MergedRobots::new(&scene, &[RobotId(0), RobotId(1)]).unwrap();
        let state = merged.state(&scene, &holding(&scene)).unwrap();
        assert!(matches!(state.pair(merged.scene(), PART, TABLE), Some((PairState::Skipped, _))));
    }
}

#[test]
fn the_last_rule_counts_and_adjacent_links_stay_untested() {
    let arm = Selection::Robot(RobotId(0));
    let rules = PairRules::from_iter([
        rule(arm, Selection::All, skip("soft")),
        rule(arm, PART.into(), PairEdit::Test("not the part".into())),
        rule(arm, TABLE.into(), PairEdit::Weight(7.0)),
    ]);
    let link = GeometryId::Link { robot: RobotId(0), link: LinkId(3) };
    assert_eq!((rules.skipped(link, TABLE), rules.skipped(PART, link)), (Some("soft"), None));
    let scene = scene(rules);
    for entry in scene.allowed_collision_matrix().entries() {
        let of_arm = [entry.a, entry.b].iter().any(|id| matches!(id, GeometryId::Link { robot: RobotId(0), .. }));
        let with = |id: GeometryId| entry.a == id || entry.b == id;
        match &entry.reason {
            Reason::ByHand(why) => assert!(of_arm && !with(PART) && why == "soft", "{entry:?}"),
            Reason::Adjacent => assert!(!with(TABLE)),
            _ => assert!(!of_arm || with(PART), "{entry:?}"),
        }
        if of_arm && with(TABLE) {
            assert_eq!(entry.weight, 7.0);
        }
    }
}

#[test]
fn first_contacts_leave_out_what_the_rules_skip() {
    let plain = example::two_arms();
    let rules = PairRules::from_iter([rule(PART.into(), Selection::All, skip("any"))]);
    let ruled = scene(rules.clone());
    let robots = || plain.robots().iter().map(|r| (&r.robot, r.base_in_world)).collect::<Vec<(&Robot, _)>>();
    let mut states: Vec<ChainState> = plain.robots().iter().map(|r| ChainState::new(&r.robot.chain)).collect();
    states.iter_mut().zip(plain.robots()).for_each(|(state, r)| r.robot.chain.forward(state));
    let (mut of_part, mut of_table) = (0, 0);
    // Down to the part and the table, more or less bent.
    for i in 0..64 {
        let q = [0.0, 1.2 + 0.1 * f64::from(i % 8), -0.4 + 0.2 * f64::from(i / 8)];
        states[0].q.copy_from_slice(&q);
        plain.robots()[0].robot.chain.forward(&mut states[0]);
        let first = |rules: PairRules| {
            let mut contacts = FirstContacts::new(robots(), plain.objects()).skipping(rules);
            let mut found = Vec::new();
            contacts.check(&states.iter().collect::<Vec<_>>(), &[], |c| found.push((c.a, c.b)));
            found.sort();
            found
        };
        let (all, some) = (first(PairRules::default()), first(rules.clone()));
        assert!(some.iter().eq(all.iter().filter(|pair| pair.1 != PART)), "{q:?}: {all:?} {some:?}");
        of_part += all.iter().filter(|pair| pair.1 == PART).count();
        of_table += some.iter().filter(|pair| pair.1 == TABLE).count();
        // The pairs are those of a scene with these rules.
        let mut state = SceneState::new(&ruled);
        state.set_q(&ruled, RobotId(0), &q).unwrap();
        let mut found = Vec::new();
        Checker::new(&ruled, CheckerOptions::default()).contacts(&state, |c| found.push((c.a, c.b)));
        found.sort();
        assert_eq!(found, some, "{q:?}");
    }
    assert!(of_part > 3 && of_table > 3, "{of_part} {of_table}");
}
