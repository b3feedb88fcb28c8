//! Guides: nearest points of their sets, bends that are followed, and surfaces that win.

use elbowroom_shared_control::{Guide, NavigatorError, NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::common::{ball, block, point};

const TOLERANCE_M: f64 = 0.5e-3;

/// The place to which a guide that keeps orientations leads the tool.
fn toward(guide: &mut Guide, tool: Vec3, hand: Vec3) -> Vec3 {
    guide.toward(&Pose::from_translation(tool), &Pose::from_translation(hand)).translation
}

fn distance_m(guide: &Guide, point: Vec3) -> f64 {
    guide.distance_m(&Pose::from_translation(point))
}

/// A random line of corners that are 20 to 80 mm apart.
fn line(random: &mut SplitMix, corners: usize) -> Vec<Vec3> {
    let mut points = vec![point(random, 0.1)];
    while points.len() < corners {
        let step = point(random, 0.05);
        let last = points.iter().rev().zip(points.iter().rev().skip(1)).next().map_or(step, |(b, a)| *b - *a);
        // Where a line turns back by more than 135°, a hand beside it may mean both branches.
        if step.length() > 0.02 && step.dot(last) > -0.7 * step.length() * last.length() {
            points.push(points[points.len() - 1] + step);
        }
    }
    points
}

/// The nearest point of a line by trying many.
fn naive_distance(points: &[Vec3], p: Vec3) -> f64 {
    let mut least = f64::INFINITY;
    for w in points.windows(2) {
        for k in 0..=1000 {
            least = least.min((w[0] + (w[1] - w[0]) * (f64::from(k) * 1e-3)).distance(p));
        }
    }
    least
}

#[test]
fn planes_cones_and_straight_tubes_give_the_nearest_point_and_never_stretch() {
    let mut random = SplitMix(1);
    for _ in 0..300 {
        let (at, axis) = (point(&mut random, 0.2), point(&mut random, 1.0));
        let end = at + axis.try_normalize().unwrap() * 0.3;
        let radius = 0.05 * random.unit();
        let guides = [
            Guide::plane(at, axis).unwrap(),
            Guide::cone(at, axis, 1.5 * random.unit()).unwrap(),
            Guide::path(vec![at, end], radius, TOLERANCE_M).unwrap(),
            Guide::path(vec![at, end], 0.0, TOLERANCE_M).unwrap(),
        ];
        for mut guide in guides {
            let (a, b) = (point(&mut random, 0.5), point(&mut random, 0.5));
            let (near_a, near_b) = (toward(&mut guide, at, a), toward(&mut guide, at, b));
            assert!(near_a.distance(near_b) <= a.distance(b) + 1e-12, "{guide:?}");
            assert!(distance_m(&guide, near_a) < 1e-9, "{guide:?}: {}", distance_m(&guide, near_a));
            assert!((distance_m(&guide, a) - a.distance(near_a)).abs() < 1e-9, "{guide:?}");
            // Nothing of the set is nearer: the straight way to any of its points gets no shorter.
            assert!((b - near_b).dot(near_a - near_b) <= 1e-9, "{guide:?}");
            assert!(toward(&mut guide, at, near_a).distance(near_a) < 1e-9, "{guide:?}");
        }
    }
}

#[test]
fn a_tool_follows_every_bend_within_the_tolerance_and_reaches_the_end() {
    let mut random = SplitMix(2);
    let (mut largest, mut reached) = (0.0_f64, 0);
    for _ in 0..12 {
        let points = line(&mut random, 6);
        let mut guide = Guide::path(points.clone(), 0.0, TOLERANCE_M).unwrap();
        let start = Pose::from_translation(points[0]);
        let mut navigator = SurfaceNavigator::new(ball(0.002, 0), vec![], start, NavigatorSettings::default()).unwrap();
        for (&from, &to) in points.iter().zip(&points[1..]) {
            for k in 0..800 {
                // The hand cuts corners and trembles.
                let hand = from + (to - from) * (f64::from(k) / 600.0).min(1.0) + point(&mut random, 0.001);
                let tool = navigator.tool_in_world().translation;
                let hand = toward(&mut guide, tool, hand);
                navigator.step(&Pose::from_translation(hand), 0.001);
                largest = largest.max(naive_distance(&points, navigator.tool_in_world().translation));
            }
        }
        reached += usize::from(navigator.tool_in_world().translation.distance(points[5]) < 0.01);
    }
    assert!(largest < 2.0 * TOLERANCE_M, "{largest} m from the line");
    assert!(reached >= 11, "{reached} of 12 ends");
}

#[test]
fn the_other_branch_of_a_hairpin_does_not_attract_the_tool() {
    let points = vec![Vec3::ZERO, Vec3::X * 0.2, Vec3::new(0.2, 0.005, 0.0), Vec3::new(0.0, 0.005, 0.0)];
    let mut guide = Guide::path(points, 0.0, TOLERANCE_M).unwrap();
    let tool = Vec3::X * 0.05;
    for k in 0..100 {
        let across = Vec3::new(0.05, 1e-4 * f64::from(k), 0.0);
        assert_eq!(toward(&mut guide, tool, across), tool);
    }
}

#[test]
fn a_fine_curve_does_not_stop_the_tool_at_its_corners() {
    // A circle of 0.1 m in 2,000 pieces.
    let at = |k: i32| f64::from(k) * std::f64::consts::TAU / 2000.0;
    let points: Vec<Vec3> = (0..1500).map(|k| Vec3::new(0.1 * at(k).cos(), 0.1 * at(k).sin(), 0.0)).collect();
    let mut guide = Guide::path(points.clone(), 0.0, TOLERANCE_M).unwrap();
    let start = Pose::from_translation(points[0]);
    let mut navigator = SurfaceNavigator::new(ball(0.002, 0), vec![], start, NavigatorSettings::default()).unwrap();
    let (mut slowest, mut largest) = (f64::INFINITY, 0.0_f64);
    for k in 0..3000 {
        // The hand is 0.3 rad ahead, at 0.1 m/s.
        let angle: f64 = f64::from(k) * 1e-3 + 0.3;
        let hand = Vec3::new(angle.cos(), angle.sin(), 0.05) * 0.1;
        let hand = toward(&mut guide, navigator.tool_in_world().translation, hand);
        let step = navigator.step(&Pose::from_translation(hand), 0.001);
        let tool = step.tool_in_world.translation;
        largest = largest.max((tool.length() - 0.1).abs().max(tool.z.abs()));
        if k > 500 {
            slowest = slowest.min(step.velocity.length());
        }
    }
    assert!(slowest > 0.05 && largest < 1.1 * TOLERANCE_M, "{slowest} m/s, {largest} m");
}

#[test]
fn a_surface_wins_over_a_guide() {
    let wall = ProtectedSurface::new(block(Vec3::new(0.1, 0.1, 0.1)), Pose::from_translation(Vec3::X * 0.1)).unwrap();
    let settings = NavigatorSettings::default();
    let mut navigator = SurfaceNavigator::new(ball(0.002, 1), vec![wall], Pose::IDENTITY, settings).unwrap();
    let mut guide = Guide::path(vec![Vec3::ZERO, Vec3::X * 0.2], 0.0, TOLERANCE_M).unwrap();
    for _ in 0..2000 {
        let hand = toward(&mut guide, navigator.tool_in_world().translation, Vec3::X * 0.2);
        navigator.step(&Pose::from_translation(hand), 0.001);
    }
    let x = navigator.tool_in_world().translation.x;
    assert!((0.04..=0.048 - settings.least_gap_m).contains(&x), "{x}");
}

#[test]
fn guides_without_a_shape_are_refused() {
    let line = |points| Guide::path(points, 0.0, TOLERANCE_M).err();
    assert_eq!(line(vec![Vec3::X]), Some(NavigatorError::GuideLine));
    assert_eq!(line(vec![Vec3::X, Vec3::X]), Some(NavigatorError::GuideLine));
    assert_eq!(line(vec![Vec3::X, Vec3::splat(f64::NAN)]), Some(NavigatorError::GuideLine));
    assert_eq!(Guide::plane(Vec3::ZERO, Vec3::ZERO).err(), Some(NavigatorError::GuideDirection));
    assert_eq!(Guide::cone(Vec3::splat(f64::NAN), Vec3::Z, 0.1).err(), Some(NavigatorError::GuideDirection));
    assert!(Guide::cone(Vec3::ZERO, Vec3::Z, 2.0).is_err());
    assert!(Guide::path(vec![Vec3::ZERO, Vec3::X], -1.0, TOLERANCE_M).is_err());
    assert!(Guide::path(vec![Vec3::ZERO, Vec3::X], 0.0, 0.0).is_err());
}
