//! The work-piece before a camera: handed over before the arm that holds it hides it, and never stopped for that.

use elbowroom_cooperation::{CooperationSettings, HoldLimit};
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_scene::SceneState;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::common::{DT_S, HIDDEN_SHARE, PER_ROW, Pair, carry, desire_in_step, part_pose, straight};

/// A plate before a camera, between two arms.
fn plate() -> Pair {
    Pair::with_plate().seen_from(Vec3::new(-0.1, -1.3, 0.55), Vec3::new(-0.1, 0.1, 0.45))
}

/// A turn about an axis to this place within 5 s, and then a slow motion for 10 s.
fn turned(pair: &Pair, axis: Vec3, angle: f64, to: Vec3) -> Vec<Pose> {
    let start = part_pose(pair);
    let turned = Pose::new(Rotation::from_axis_angle(axis, angle) * start.rotation, to);
    let end = Pose::new(turned.rotation, to + Vec3::splat(0.05));
    let piece = |from: Pose, to: Pose, count: u32| {
        (1..=count).map(move |k| from.interpolate(&to, f64::from(k) / f64::from(count)))
    };
    piece(start, turned, 250).chain(piece(turned, end, 500)).collect()
}

/// A turn of the plate that brings the hand of the first arm between it and the camera.
fn show_the_back(pair: &Pair) -> Vec<Pose> {
    turned(pair, Vec3::Z, 1.1, Vec3::new(-0.1, 0.1, 0.45))
}

/// The settings without a preference for any arm.
fn indifferent() -> CooperationSettings {
    CooperationSettings { hidden_share: 1.0, ..CooperationSettings::default() }
}

#[test]
fn an_arm_that_will_hide_the_plate_hands_it_over_before_and_the_plate_does_not_stop() {
    let pair = plate();
    let way = show_the_back(&pair);
    let before = carry(&pair, indifferent(), &way);
    assert!(before.hand_overs.is_empty() && before.hidden_s > 1.5, "{} s", before.hidden_s);
    let outcome = carry(&pair, CooperationSettings::default(), &way);
    let from_to: Vec<(usize, usize)> = outcome.hand_overs.iter().map(|(_, h)| (h.from, h.to)).collect();
    assert_eq!(from_to, [(0, 1)], "{:?}", outcome.hand_overs);
    let (_, handed_over) = outcome.hand_overs[0];
    assert_eq!(handed_over.reason.limit, Some(HoldLimit::Hidden));
    assert!(handed_over.reason.receiver_holds_s > handed_over.reason.takes_s, "{handed_over:?}");
    assert!(outcome.hidden_s == 0.0 && outcome.out_of_view_s == 0.0, "{} s", outcome.hidden_s);
    assert!(outcome.share > 0.999_999 && outcome.stopped_s == 0.0, "{} s", outcome.stopped_s);
    assert!(outcome.deviation_m < 1e-9 && outcome.contacts == 0, "{}", outcome.contacts);
}

#[test]
fn a_plate_that_every_arm_hides_goes_on() {
    let pair = plate().with_one_hand();
    let outcome = carry(&pair, CooperationSettings::default(), &show_the_back(&pair));
    assert!(outcome.hand_overs.is_empty() && outcome.hidden_s > 1.5, "{} s", outcome.hidden_s);
    assert!(outcome.share > 0.999_999 && outcome.stopped_s == 0.0, "{} s", outcome.stopped_s);
}

#[test]
fn no_arm_waits_in_the_line_of_sight() {
    let target = Vec3::new(0.1, 0.0, 0.45);
    let pair = Pair::new(2, 0.6).seen_from(Vec3::new(0.1, -1.5, 0.6), target);
    let way = turned(&pair, Vec3::X, 1.4, target);
    let before = carry(&pair, indifferent(), &way);
    let outcome = carry(&pair, CooperationSettings::default(), &way);
    assert!(before.hand_overs.is_empty() && before.hidden_s > 5.0, "{} s", before.hidden_s);
    assert!(outcome.hand_overs.is_empty() && outcome.hidden_s < 0.5, "{} s", outcome.hidden_s);
}

#[test]
fn an_arm_that_hides_the_bar_takes_it_before_it_stops() {
    // Only the second arm reaches the end, and hides the bar from there.
    let pair = Pair::new(2, 0.6).seen_from(Vec3::new(1.6, 0.0, 1.0), Vec3::new(0.1, 0.0, 0.4));
    let start = part_pose(&pair);
    let end = Pose::new(start.rotation, Vec3::new(0.3, 0.0, 0.45));
    let outcome = carry(&pair, CooperationSettings::default(), &straight(start, end, 0.05));
    assert!(outcome.share > 0.999_999 && outcome.stopped_s == 0.0, "{outcome:?}");
    assert!(outcome.hidden_s > 0.5, "{outcome:?}");
    assert!(
        outcome.hand_overs.iter().any(|(_, h)| h.reason.limit.is_some_and(|l| l != HoldLimit::Hidden)),
        "{outcome:?}"
    );
}

#[test]
fn the_hidden_share_is_that_of_all_arms_where_they_are() {
    let pair = plate();
    let way = show_the_back(&pair);
    let mut robot = pair.robot(indifferent());
    let mut visibility = pair.visibility.clone().unwrap();
    let mut state = SceneState::new(&pair.scene);
    let mut shares = Vec::new();
    for k in 0..way.len() * PER_ROW {
        desire_in_step(&mut robot, &way, k);
        robot.step(DT_S, &[1.0; 2]);
        if !k.is_multiple_of(50) {
            continue;
        }
        (0..2).for_each(|member| state.set_q(&pair.scene, RobotId(member), robot.q(member)).unwrap());
        let links = pair.scene.geometries().filter(|id| *id != GeometryId::Object(ObjectId(0)));
        let parts: Vec<_> = links
            .flat_map(|id| {
                let in_world = state.pose(&pair.scene, id).unwrap();
                pair.scene.shapes(id).map(move |(shape, in_link)| (shape, in_world * in_link))
            })
            .collect();
        let share = visibility.hidden_share(&robot.part_in_world(), parts);
        assert_eq!(robot.hidden_share(), share, "step {k}");
        shares.extend(share);
    }
    let (least, most) = shares.iter().fold((1.0, 0.0), |(a, b), s| (f64::min(a, *s), f64::max(b, *s)));
    assert!(least < HIDDEN_SHARE && most > HIDDEN_SHARE, "{least} to {most}");
}

#[test]
fn random_turns_before_a_camera_are_hidden_for_a_shorter_time_and_keep_their_path() {
    let pair = plate();
    let mut random = SplitMix(9);
    let (mut hidden_s, mut before_s) = (0.0, 0.0);
    for _ in 0..5 {
        let to = Vec3::new(-0.1, 0.1, 0.45) + Vec3::from(random.within(0.04));
        let way = turned(&pair, Vec3::Z, random.between(1.0, 1.3), to);
        before_s += carry(&pair, indifferent(), &way).hidden_s;
        let outcome = carry(&pair, CooperationSettings::default(), &way);
        assert!(outcome.deviation_m < 1e-9 && outcome.contacts == 0, "{}", outcome.contacts);
        assert!(outcome.share > 0.999 || outcome.last_hold.is_some(), "a stop has a reason");
        hidden_s += outcome.hidden_s;
    }
    assert!(hidden_s < 0.5 * before_s, "{hidden_s} s hidden, {before_s} s without the camera");
}
