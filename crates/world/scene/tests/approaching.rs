//! Level of detail and time to collision: pairs that are omitted or reported coarsely are proven to be distant.

use crate::common::{Random, RandomGeometry, all_distances, apart, link, scene_of, shapes};

use elbowroom_proximity::ccd::{ConstantTwist, RigidMotion};
use elbowroom_proximity::separation;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};

use elbowroom_scene::{
    ApproachingPair, Checker, CheckerOptions, Detail, LevelOfDetail, Scene, SceneMotion, SceneState, Selection,
};
use elbowroom_spatial::{FrameMotion, Vec3};

const DOUBT: f64 = 1e-9;

fn random(scene: &Scene, r: &mut Random) -> (SceneState, SceneMotion) {
    let mut state = SceneState::new(scene);
    let mut motion = SceneMotion::new(scene);
    let speed = r.between(0.0, 2.0);
    for robot in 0..scene.robots().len() {
        state.set_q(scene, RobotId(robot), &r.q()).unwrap();
        let qd = [r.between(-speed, speed), r.between(-speed, speed), r.between(-speed, speed)];
        motion.set_qd(scene, &state, RobotId(robot), &qd).unwrap();
    }
    for object in 0..scene.objects().len() - 1 {
        let angular_velocity = if r.unit() < 0.5 { Vec3::ZERO } else { r.vec3(speed) };
        let velocity = if r.unit() < 0.5 { Vec3::ZERO } else { r.vec3(speed) };
        let moving = FrameMotion { velocity, angular_velocity, ..FrameMotion::REST };
        motion.set_object(scene, ObjectId(object), moving).unwrap();
    }
    (state, motion)
}

fn approaching(checker: &mut Checker, at: &(SceneState, SceneMotion), policy: &LevelOfDetail) -> Vec<ApproachingPair> {
    let mut found = Vec::new();
    checker.approaching(&at.0, &at.1, policy, 1.0, |p| found.push(p));
    found
}

#[test]
fn near_and_soon_pairs_are_exact_and_the_others_are_proven_to_be_neither() {
    let padded = |m: GeometryId| if m == link(0, 3) { 0.03 } else { 0.0 };
    let scene = scene_of(41, |b| _ = b.padding(link(0, 3), 0.03));
    let mut r = Random(41);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let (mut reported, mut levels, mut left_out) = (0, [0; 4], 0);
    for _ in 0..300 {
        let at = random(&scene, &mut r);
        let policy = LevelOfDetail {
            exact_m: r.between(0.0, 0.1),
            exact_s: r.between(0.0, 0.2),
            within_m: r.between(0.1, 1.0),
            progressive: true,
        };
        let found = approaching(&mut checker, &at, &policy);
        for (a, b, metres) in all_distances(&scene, &at.0, padded) {
            let Some(p) = found.iter().find(|p| (p.a, p.b) == (a, b)) else {
                assert!(metres > policy.within_m - DOUBT);
                left_out += 1;
                continue;
            };
            reported += 1;
            assert!(p.lower_bound <= metres + DOUBT && p.earliest_s <= 1.0);
            if let Detail::Boxes(depth) = p.detail {
                levels[usize::from(depth)] += 1;
                assert!(metres > policy.exact_m && p.lower_bound > policy.exact_m && p.earliest_s >= policy.exact_s);
                assert!(p.metres <= metres, "never too large");
            } else {
                levels[3] += 1;
                assert!((p.metres - metres).abs() < DOUBT, "{p:?} {metres}");
                assert!((p.metres == 0.0) == (metres == 0.0) && (p.metres > 0.0 || p.earliest_s == 0.0));
            }
        }
    }
    assert!(levels[0] > 1000 && levels[1] + levels[2] > 5, "{levels:?}");
    assert!(reported > 3000 && left_out > 1000 && levels[3] > 500, "{reported} {left_out} {levels:?}");
}

#[test]
fn no_pair_meets_before_the_earliest_time() {
    let padded = |m: GeometryId| if m == link(0, 3) { 0.02 } else { 0.0 };
    let scene = scene_of(42, |b| _ = b.padding(link(0, 3), 0.02));
    let mut r = Random(42);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let (mut asked, mut tight) = (0, 0);
    for _ in 0..60 {
        let at = random(&scene, &mut r);
        for p in approaching(&mut checker, &at, &LevelOfDetail::default()) {
            if p.earliest_s == 0.0 {
                continue;
            }
            asked += 1;
            // Frames keep their velocities and carry all shapes of the geometry.
            let later = |m: GeometryId, t: f64| {
                let path =
                    ConstantTwist::from_motion(at.0.pose(&scene, m).unwrap(), &at.1.of(&scene, &at.0, m).unwrap(), 1.0);
                let moved = path.pose(t) * path.pose(0.0).inverse();
                shapes(&scene, &at.0, m).into_iter().map(move |(s, pose)| (s, moved * pose)).collect::<Vec<_>>()
            };
            let margin = padded(p.a) + padded(p.b);
            for k in 1..=4 {
                let t = p.earliest_s * f64::from(k) / 4.0;
                let (of_a, of_b) = (later(p.a, t), later(p.b, t));
                let all = of_a.iter().flat_map(|(s, x)| of_b.iter().map(move |(u, y)| separation(s, x, u, y).distance));
                assert!(all.fold(f64::INFINITY, f64::min) > margin - DOUBT, "{p:?} {t}");
            }
            tight += usize::from(p.earliest_s < 1.0 && p.earliest_s > 0.3 * p.estimate_s);
        }
    }
    assert!(asked > 500 && tight > 50, "{asked} {tight}");
}

#[test]
fn near_pairs_and_contacts_are_the_same_with_and_without_level_of_detail() {
    let scene = scene_of(43, |_| {});
    let mut r = Random(43);
    let mut checkers = [true, false].map(|progressive| {
        let policy = LevelOfDetail { progressive, ..LevelOfDetail::default() };
        (Checker::new(&scene, CheckerOptions::default()), policy)
    });
    let mut contacts = 0;
    for _ in 0..300 {
        let at = random(&scene, &mut r);
        let [coarse, exact] = checkers.each_mut().map(|(checker, policy)| approaching(checker, &at, policy));
        assert!(exact.iter().all(|p| p.detail == Detail::Exact));
        for p in &exact {
            let other = coarse.iter().find(|q| (q.a, q.b) == (p.a, p.b)).expect("reported as well");
            if p.metres <= 0.1 || other.detail == Detail::Exact {
                assert!(other.detail == Detail::Exact && (other.metres - p.metres).abs() < DOUBT, "{other:?} {p:?}");
            }
            contacts += usize::from(p.metres == 0.0);
        }
        let mut touching = Vec::new();
        checkers[0].0.contacts(&at.0, |c| touching.push((c.a, c.b)));
        let reported: Vec<_> = coarse.iter().filter(|p| p.metres == 0.0).map(|p| (p.a, p.b)).collect();
        assert_eq!(reported, touching);
    }
    assert!(contacts > 30, "{contacts}");
}

#[test]
fn time_to_collision_of_a_falling_object_is_that_of_the_formula() {
    let scene = elbowroom_scene::example::two_arms();
    let mut state = SceneState::new(&scene);
    let mut motion = SceneMotion::new(&scene);
    let mut at = scene.objects()[0].in_world;
    at.translation = Vec3::new(0.0, 0.0, 1.6); // over the left arm, which ends at 1.2
    state.place(&scene, ObjectId(0), at).unwrap();
    motion.set_object(&scene, ObjectId(0), FrameMotion { velocity: Vec3::Z * -0.5, ..FrameMotion::REST }).unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let forearm = Selection::Link { robot: RobotId(0), link: elbowroom_kinematics::LinkId(3) };
    let mut found = Vec::new();
    let policy = LevelOfDetail { exact_s: 2.0, ..LevelOfDetail::default() };
    checker
        .between(forearm, Selection::Object(ObjectId(0)))
        .approaching(&state, &motion, &policy, 3.0, |p| found.push(p));
    let [p] = found[..] else { panic!("{found:?}") };
    let gap = apart(&scene, &state, p.a, p.b);
    assert!((p.metres - gap).abs() < 1e-12 && (p.closing_m_s - 0.5).abs() < 1e-12);
    assert!((p.estimate_s - gap / 0.5).abs() < 1e-9 && (p.earliest_s - gap / 0.5).abs() < 0.02, "{p:?}");
    // Separating geometry never meets.
    motion.set_object(&scene, ObjectId(0), FrameMotion { velocity: Vec3::Z * 0.5, ..FrameMotion::REST }).unwrap();
    checker.between(forearm, Selection::Object(ObjectId(0))).approaching(&state, &motion, &policy, 3.0, |p| {
        assert!(p.estimate_s == f64::INFINITY && p.earliest_s == 3.0, "{p:?}");
    });
}

#[test]
fn nan_is_near_and_soon_and_invalid_input_is_refused() {
    let scene = scene_of(44, |_| {});
    let mut r = Random(44);
    let (state, mut motion) = random(&scene, &mut r);
    let mut checker = Checker::new(&scene, CheckerOptions { matrix: false, ..CheckerOptions::default() });
    let pairs = checker.between(Selection::All, Selection::All).len(&state);
    let at = (state, motion.clone());
    for policy in [
        LevelOfDetail { exact_m: f64::NAN, within_m: f64::NAN, ..LevelOfDetail::default() },
        LevelOfDetail { exact_s: f64::NAN, within_m: f64::INFINITY, ..LevelOfDetail::default() },
        LevelOfDetail { exact_m: f64::INFINITY, within_m: f64::INFINITY, ..LevelOfDetail::default() },
    ] {
        let found = approaching(&mut checker, &at, &policy);
        assert!(found.len() == pairs && found.iter().all(|p| p.detail == Detail::Exact), "{policy:?}");
    }
    let bad = FrameMotion { velocity: Vec3::X * f64::NAN, ..FrameMotion::REST };
    assert!(
        motion.set_object(&scene, ObjectId(0), bad).is_err()
            && motion.set_object(&scene, ObjectId(99), FrameMotion::REST).is_err()
    );
    assert!(motion.set_qd(&scene, &at.0, RobotId(0), &[0.0, f64::NAN, 0.0]).is_err());
    assert!(
        motion.set_qd(&scene, &at.0, RobotId(0), &[0.0]).is_err()
            && motion.set_qd(&scene, &at.0, RobotId(9), &[]).is_err()
    );
    assert!(
        motion.of(&scene, &at.0, GeometryId::Object(ObjectId(99))).is_none()
            && motion.of(&scene, &at.0, link(0, 99)).is_none()
    );
}
