//! The guide alone, on a map that is changed by hand: it stops before what is blocked.

mod watched;

use elbowroom_cell::watch::{Doing, Exact, Guide, GuideError, GuideSettings, Reason, SeeTimes, Sighting, Step};
use elbowroom_cspace::{JointMap, Obstacle, PlanarArm};
use elbowroom_planner::PlanError;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::Sight;
use proptest::prelude::*;
use watched::{A, B, TICK_S, arm, limits, radians};

fn sighting(t: f64) -> Sighting {
    Sighting {
        stamp_s: t,
        sight: Sight::Clear,
        prisms: vec![],
        entered: vec![],
        left: vec![],
        blocked: 0,
        freed: 0,
        times: SeeTimes::default(),
    }
}

fn map() -> JointMap {
    JointMap::new(PlanarArm::KR125, &arm().grid(3.0_f64.to_radians()).unwrap()).unwrap()
}

fn guide(map: &JointMap, settings: GuideSettings) -> Guide {
    Guide::new(arm(), map.grid(), map.reader(), None, settings, &radians(A)).unwrap()
}

/// A wall as high as the arm reaches, from the axis outward at an angle in the base.
fn wall(angle: f64) -> Obstacle {
    let at = Vec3::new(1.8 * angle.cos(), 1.8 * angle.sin(), 1.5);
    Obstacle::cuboid(Pose::from_xyz_rpy(at.to_array(), [0.0, 0.0, angle]), Vec3::new(1.3, 0.05, 1.6)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// A wall that lets nothing through comes up while the arm goes: wherever it is, the arm stops on free cells if it had
    /// the room to stop, and goes on once the wall is gone.
    #[test]
    fn it_stops_before_a_wall_and_goes_on_when_that_is_gone(angle in -0.6..0.9_f64, after in 1_u32..20) {
        let mut map = map();
        map.set("behind", &wall(std::f64::consts::PI)); // or it goes round the other way
        let mut guide = guide(&map, GuideSettings::new(limits()));
        guide.go_to(&radians(B)).unwrap();
        let mut t = 0.0;
        let mut run = |guide: &mut Guide, map: &mut JointMap, frames: u32| -> Vec<Step> {
            let mut steps = Vec::new();
            for _ in 0..frames {
                map.publish();
                guide.look(&sighting(t));
                steps.extend((0..10).map(|_| { t += TICK_S; guide.tick(t, TICK_S) }));
            }
            steps
        };
        run(&mut guide, &mut map, after);
        map.set("wall", &wall(angle));
        let was_free = !map.is_blocked(guide.planar());
        let before = guide.planar();
        let mut blocked_after = false;
        for _ in 0..40 {
            for step in run(&mut guide, &mut map, 1) {
                blocked_after |= map.is_blocked(arm().to_planar(&step.q));
            }
        }
        let last = run(&mut guide, &mut map, 1).pop().unwrap();
        let stands = last.qd == [0.0; 3];
        prop_assert!(stands, "{last:?}");
        // From full speed it stops within 0.44 rad (1.75² / 2 / 3.5); a cell and 2° before the wall, and one frame later, at most.
        let mut room = 0.0;
        let mut q = before;
        while room < 1.2 && !map.is_blocked(q) {
            room += 0.01;
            q[0] += 0.01;
        }
        if was_free && room > 0.7 {
            prop_assert!(!blocked_after, "it went into the wall with {room} rad to stop");
        }
        if last.doing != Doing::Arrived {
            prop_assert!(matches!(last.doing, Doing::Waiting(Reason::Blocked | Reason::NoPath(_))), "{last:?}");
        }
        map.remove("wall");
        let end = run(&mut guide, &mut map, 80).pop().unwrap();
        prop_assert!(end.q.iter().zip(radians(B)).all(|(a, b)| (a - b).abs() < 1e-9), "{end:?}");
    }
}

#[test]
fn another_goal_on_the_way_stops_the_arm_first() {
    let mut map = map();
    let mut guide = guide(&map, GuideSettings::new(limits()));
    guide.go_to(&radians(B)).unwrap();
    let mut t = 0.0;
    let mut steps = Vec::new();
    for frame in 0..120 {
        map.publish();
        guide.look(&sighting(t));
        if frame == 12 {
            guide.go_to(&radians(A)).unwrap();
        }
        for _ in 0..10 {
            t += TICK_S;
            steps.push(guide.tick(t, TICK_S));
        }
    }
    assert!(steps.iter().any(|s| matches!(s.doing, Doing::Slowing(_))));
    let end = steps.last().unwrap();
    assert!(end.q.iter().zip(radians(A)).all(|(a, b)| (a - b).abs() < 1e-9) && end.doing == Doing::Arrived, "{end:?}");
    let jump = steps.windows(2).map(|w| (w[1].q[0] - w[0].q[0]).abs()).fold(0.0, f64::max);
    assert!(jump < 1.76 * TICK_S, "{jump}");
}

#[test]
fn an_arm_in_the_way_retreats_and_comes_back() {
    let mut map = map();
    let retreat = arm().to_planar(&radians([60.0, -120.0, 130.0, 0.0, 44.5, 0.0]));
    let settings = GuideSettings { retreat: Some(retreat), ..GuideSettings::new(limits()) };
    let exact = Exact::new(arm(), Vec::new()).unwrap();
    let mut guide = Guide::new(arm(), map.grid(), map.reader(), Some(exact), settings, &radians(A)).unwrap();
    let mut t = 0.0;
    let mut run = |guide: &mut Guide, map: &mut JointMap, frames: u32| {
        for _ in 0..frames {
            map.publish();
            guide.look(&sighting(t));
            for _ in 0..10 {
                t += TICK_S;
                guide.tick(t, TICK_S);
            }
        }
    };
    guide.go_to(&radians(A)).unwrap();
    run(&mut guide, &mut map, 3);
    let wrist = Vec3::new(1.0, -1.73, 0.5);
    map.set("somebody", &Obstacle::sphere(wrist, 0.2).unwrap());
    assert!(map.is_blocked(guide.planar()));
    run(&mut guide, &mut map, 60);
    assert!(!map.is_blocked(guide.planar()));
    map.remove("somebody");
    run(&mut guide, &mut map, 80);
    let home = arm().to_planar(&radians(A));
    assert!((0..3).all(|i| (guide.planar()[i] - home[i]).abs() < 1e-9), "{:?}", guide.planar());
}

#[test]
fn a_picture_from_the_future_is_none() {
    let map = map();
    let mut guide = guide(&map, GuideSettings::new(limits()));
    guide.go_to(&radians(B)).unwrap();
    guide.look(&sighting(1.1));
    // Clocks may differ a little …
    let mut t = 1.0;
    for _ in 0..50 {
        t += TICK_S;
        assert_eq!(guide.tick(t, TICK_S).doing, Doing::Going);
    }
    // … but not by an hour: nothing would ever be too old.
    guide.look(&sighting(t + 3600.0));
    let steps: Vec<Step> = (0..250)
        .map(|_| {
            t += TICK_S;
            guide.tick(t, TICK_S)
        })
        .collect();
    assert!(matches!(steps[0].doing, Doing::Slowing(Reason::NoPicture { age_s }) if age_s < -3599.0), "{:?}", steps[0]);
    let last = steps.last().unwrap();
    assert!(matches!(last.doing, Doing::Waiting(Reason::NoPicture { .. })) && last.qd == [0.0; 3], "{last:?}");
    assert!(last.doing.reason().unwrap().to_string().contains("future"));
    guide.look(&sighting(t));
    assert_eq!(guide.tick(t + TICK_S, TICK_S).doing, Doing::Going);
}

#[test]
fn a_tick_that_takes_no_time_moves_nothing() {
    let mut map = map();
    map.set("behind", &wall(std::f64::consts::PI));
    map.publish();
    for dt in [0.0, -0.0, -TICK_S, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for is_blocked in [false, true] {
            map.remove("wall");
            map.publish();
            let mut guide = guide(&map, GuideSettings::new(limits()));
            guide.go_to(&radians(B)).unwrap();
            guide.look(&sighting(0.0));
            (0..60).for_each(|_| _ = guide.tick(0.0, TICK_S));
            if is_blocked {
                map.set("wall", &wall(0.0));
                map.publish();
                assert!(guide.look(&sighting(0.0)).was_blocked);
            }
            let before = guide.planar();
            let step = guide.tick(0.0, dt);
            assert!(guide.planar() == before && step.qd == [0.0; 3] && step.rate.to_bits() == 0, "{dt}: {step:?}");
            assert!(matches!(step.doing, Doing::Waiting(Reason::NoTime { .. })), "{dt}: {step:?}");
            assert!(step.doing.reason().unwrap().to_string().contains("seconds"));
            // It goes on from rest.
            let next = guide.tick(0.0, TICK_S);
            assert!(next.rate < 0.1 && guide.planar().iter().all(|q| q.is_finite()), "{dt}: {next:?}");
        }
    }
}

#[test]
fn a_very_short_tick_is_worked_out_as_fast_as_any() {
    let mut map = map();
    map.set("behind", &wall(std::f64::consts::PI));
    map.publish();
    let mut guide = guide(&map, GuideSettings::new(limits()));
    guide.go_to(&radians(B)).unwrap();
    guide.look(&sighting(0.0));
    (0..60).for_each(|_| _ = guide.tick(0.0, TICK_S));
    map.set("wall", &wall(0.0));
    map.publish();
    assert!(guide.look(&sighting(0.0)).was_blocked);
    let before = guide.planar();
    for dt in [1e-9, 1e-300, f64::MIN_POSITIVE] {
        guide.tick(0.0, dt);
    }
    assert!((0..3).all(|i| (guide.planar()[i] - before[i]).abs() < 1e-6));
}

#[test]
fn what_cannot_be_guided_is_refused() {
    let map = map();
    let settings = GuideSettings::new(limits());
    let new = |settings: GuideSettings, q: &[f64]| {
        Guide::new(arm(), map.grid(), map.reader(), None, settings, q).map(|_| ()).unwrap_err()
    };
    let q = radians(A);
    assert_eq!(new(settings.clone(), &q[..4]), GuideError::Values { found: 4, dof: 6 });
    let outside = radians([0.0, 20.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(matches!(new(settings.clone(), &outside), GuideError::Plan(PlanError::Outside { joint: 1, .. })));
    assert!(matches!(new(settings.clone(), &[f64::NAN; 6]), GuideError::Plan(PlanError::Outside { .. })));
    let bad = GuideSettings { stale_s: f64::NAN, ..settings.clone() };
    assert!(matches!(new(bad, &q), GuideError::Setting { name: "stale_s", .. }));
    let bad = GuideSettings { stop: [1.0, -1.0, 1.0], ..settings.clone() };
    assert!(matches!(new(bad, &q), GuideError::Setting { name: "stop", .. }));
    let mut bad = settings.clone();
    bad.limits.jerk[2] = 0.0;
    assert!(matches!(new(bad, &q), GuideError::Motion(_)));
    let mut guide = Guide::new(arm(), map.grid(), map.reader(), None, settings, &q).unwrap();
    assert!(guide.go_to(&outside).is_err() && guide.go_to(&[]).is_err());
}
