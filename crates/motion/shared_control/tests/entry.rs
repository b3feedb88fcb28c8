//! A point of entry: the shaft always passes through it, whatever the hand does, and turns no more than it must.

use std::sync::Arc;

use elbowroom_proximity::{Shape, TriMesh, separation};
use elbowroom_shared_control::{
    ArmLimit, Guide, Limit, NavigatorError, NavigatorSettings, ProtectedSurface, SurfaceNavigator,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::random::SplitMix;

use crate::common::arm::{self, DT_S, guided, scene};
use crate::common::{block, point, pose};

/// What is stated: the shaft passes within this of the point, beyond the radius, m.
const TOLERANCE_M: f64 = 2e-6;
const ANY_DEPTH: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Distance of the line of the shaft from a point, by the nearest of its points.
fn naive_offset(tool: &Pose, axis: Vec3, at: Vec3) -> f64 {
    let (tip, axis) = (tool.translation, tool.rotation * axis);
    let along = axis.dot(at - tip) / axis.dot(axis);
    (tip + axis * along).distance(at)
}

fn depth(tool: &Pose, axis: Vec3, at: Vec3) -> f64 {
    (tool.translation - at).dot(tool.rotation * axis)
}

/// A random unit vector.
fn direction(random: &mut SplitMix) -> Vec3 {
    point(random, 1.0).try_normalize().unwrap_or(Vec3::Z)
}

/// A tool with its shaft through a point, at a depth.
fn tool_at(random: &mut SplitMix, axis: Vec3, at: Vec3, depth_m: f64) -> Pose {
    let rotation = pose(random, 0.0, 3.0).rotation;
    Pose::new(rotation, at + rotation * axis * depth_m)
}

/// The least angle by which an orientation is turned to bring the shaft within the radius, by trying many.
fn least_angle(hand: Rotation, axis: Vec3, (tip, at, radius): (Vec3, Vec3, f64), side: f64) -> f64 {
    let out = (tip - at) * side;
    let mut least = f64::INFINITY;
    let toward = out.try_normalize().unwrap();
    let (x, steps) = (toward.any_perpendicular(), 24);
    let y = toward.cross(x);
    let most = (radius / out.length()).min(1.0).asin();
    for ring in 0..if radius > 0.0 { 5 } else { 1 } {
        let tilt = most * f64::from(ring) / 4.0;
        for around in 0..steps {
            let phi = std::f64::consts::TAU * f64::from(around) / f64::from(steps);
            let shaft = toward * tilt.cos() + (x * phi.cos() + y * phi.sin()) * tilt.sin();
            let from = hand * axis;
            let about = from.cross(shaft).try_normalize().unwrap_or_else(|| from.any_perpendicular());
            let shortest = Rotation::from_axis_angle(about, from.cross(shaft).length().atan2(from.dot(shaft))) * hand;
            for twist in -6..=6 {
                let turned = Rotation::from_axis_angle(shaft, 0.04 * f64::from(twist)) * shortest;
                least = least.min((turned * hand.inverse()).angle());
            }
        }
    }
    least
}

#[test]
fn the_reachable_pose_has_the_shaft_at_the_point_and_is_turned_least() {
    let mut random = SplitMix(1);
    let (mut turned, mut through) = (0, 0);
    for case in 0..400 {
        let (at, axis) = (point(&mut random, 0.3), direction(&mut random));
        let radius = if case % 3 == 0 { 0.02 * random.unit() } else { 0.0 };
        let mut guide = Guide::entry(at, axis, radius, ANY_DEPTH).unwrap();
        let tool = {
            let depth_m = random.between(-0.2, 0.2);
            tool_at(&mut random, axis, at, depth_m)
        };
        let near = 10_f64.powf(random.between(-4.0, 0.0));
        let hand = Pose::new(pose(&mut random, 0.0, 1.2).rotation * tool.rotation, at + point(&mut random, near));
        let found = guide.toward(&tool, &hand);
        let off = naive_offset(&found, axis, at);
        assert!(off <= radius + TOLERANCE_M, "{case}: {off} m from the point");
        assert!(guide.distance_m(&found) <= TOLERANCE_M);
        let shaft = tool.rotation * axis;
        let side = if depth(&tool, axis, at) < 0.0 { -1.0 } else { 1.0 };
        if (hand.translation - at).dot(shaft) * side >= 0.0 {
            assert_eq!(found.translation, hand.translation, "{case}");
        } else {
            // To the other side along itself, as far as the hand is there.
            let moved = found.translation - tool.translation;
            assert!((moved - shaft * shaft.dot(hand.translation - tool.translation)).length() < 1e-9, "{case}");
            through += 1;
        }
        let side = if (found.translation - at).dot(shaft) < 0.0 { -1.0 } else { 1.0 };
        let angle = (found.rotation * hand.rotation.inverse()).angle();
        let least = least_angle(hand.rotation, axis, (found.translation, at, radius), side);
        assert!(angle <= least + 1e-9, "{case}: {angle} rad, {least} are enough");
        turned += usize::from(angle > 0.01);
    }
    assert!(turned > 200 && through > 50, "{turned} turned, {through} through the point");
}

#[test]
fn the_tool_turns_continuously_while_its_tip_passes_the_point() {
    let mut random = SplitMix(2);
    for case in 0..200 {
        let (at, axis) = (point(&mut random, 0.3), direction(&mut random));
        let mut guide = Guide::entry(at, axis, 0.0, ANY_DEPTH).unwrap();
        let mut tool = tool_at(&mut random, axis, at, 2e-4);
        // The hand keeps its orientation, and moves along the shaft and up to 1 nm beside the point.
        let shaft = tool.rotation * axis;
        let aside = direction(&mut random) * 1e-9;
        let mut last = tool.rotation;
        for k in (-200..=200).rev() {
            let hand = Pose::new(tool.rotation, at + aside + shaft * (1e-6 * f64::from(k)));
            tool = guide.toward(&tool, &hand);
            assert!((tool.rotation * last.inverse()).angle() < 2e-3, "{case}, {k}");
            assert!(naive_offset(&tool, axis, at) <= TOLERANCE_M);
            last = tool.rotation;
        }
        assert!(depth(&tool, axis, at) < -1e-4, "{case}");
    }
}

/// A rod of 6 mm and 200 mm with its tip at the origin.
fn rod() -> Arc<TriMesh> {
    let rod = block(Vec3::new(0.006, 0.006, 0.2));
    let vertices = rod.vertices().iter().map(|v| *v - Vec3::Z * 0.1).collect();
    Arc::new(TriMesh::new(vertices, rod.triangles().to_vec()).unwrap())
}

/// A plate of 10 mm with a square hole of 14 mm around the origin, and a floor 80 mm beyond it.
fn housing() -> Vec<(Arc<TriMesh>, Pose)> {
    let at = |x: f64, y: f64, z: f64| Pose::from_translation(Vec3::new(x, y, z));
    let (long, short) = (block(Vec3::new(0.1, 0.3, 0.01)), block(Vec3::new(0.014, 0.1, 0.01)));
    vec![
        (long.clone(), at(0.057, 0.0, 0.0)),
        (long, at(-0.057, 0.0, 0.0)),
        (short.clone(), at(0.0, 0.057, 0.0)),
        (short, at(0.0, -0.057, 0.0)),
        (block(Vec3::new(0.3, 0.3, 0.01)), at(0.0, 0.0, 0.085)),
    ]
}

fn navigator(surfaces: &[(Arc<TriMesh>, Pose)], start: Pose, settings: NavigatorSettings) -> SurfaceNavigator {
    let protected = surfaces.iter().map(|(m, at)| ProtectedSurface::new(m.clone(), *at).unwrap()).collect();
    SurfaceNavigator::new(rod(), protected, start, settings).unwrap()
}

#[test]
fn no_hand_override_or_surface_takes_the_shaft_from_the_point() {
    let mut random = SplitMix(3);
    let surfaces = housing();
    let solids: Vec<(Shape, Pose)> = surfaces.iter().map(|(m, at)| (Shape::Mesh(m.clone()), *at)).collect();
    let (rod, settings) = (Shape::Mesh(rod()), NavigatorSettings::default());
    let (mut moved, mut glided, mut fastest_turn, mut deepest) = (0.0, 0, 0.0_f64, 0.0_f64);
    for case in 0..16 {
        let radius = if case % 4 == 3 { 0.002 } else { 0.0 };
        let depth_m = if case % 2 == 0 { ANY_DEPTH } else { (0.015, 0.06) };
        let guide = Guide::entry(Vec3::ZERO, Vec3::Z, radius, depth_m).unwrap();
        let mut guide = guide;
        let mut navigator = navigator(&surfaces, Pose::from_translation(Vec3::Z * 0.03), settings);
        navigator.set_remote_center(guide.remote_center().copied());
        let (mut hand, mut share, mut dt_s) = (navigator.tool_in_world(), 1.0, 0.002);
        for k in 0..400 {
            if k % 20 == 0 {
                let reach = 10_f64.powf(random.between(-4.0, -0.5));
                let around = if random.unit() < 0.5 { Vec3::ZERO } else { hand.translation };
                hand = Pose::new(pose(&mut random, 0.0, 0.5).rotation, around + point(&mut random, reach));
                share = [1.0, 0.4, 0.01, 0.0][random.below(4)];
                dt_s = [0.001, 0.002, 0.02][random.below(3)];
            }
            let before = navigator.tool_in_world();
            let wanted = if random.unit() < 0.05 { before } else { guide.toward(&before, &hand) };
            let step = if random.unit() < 0.1 {
                navigator.step_at_velocity(point(&mut random, 0.3), dt_s, share)
            } else {
                navigator.step_at_override(&wanted, dt_s, share)
            };
            let tool = step.tool_in_world;
            let off = naive_offset(&tool, Vec3::Z, Vec3::ZERO);
            assert!(off <= radius + TOLERANCE_M, "{case}, {k}: {off} m from the point after {step:?}");
            let turned = (tool.rotation * before.rotation.inverse()).angle();
            assert!(turned <= settings.turn_rad_s * dt_s * share * (1.0 + 1e-9) + 1e-9, "{case}, {k}: {turned} rad");
            let travelled = tool.translation.distance(before.translation);
            assert!(travelled <= settings.speed_m_s * dt_s * share + 5e-6, "{case}, {k}: {travelled} m");
            let deep = depth(&tool, Vec3::Z, Vec3::ZERO);
            assert!(deep >= depth_m.0 - 1e-9 && deep <= depth_m.1 + 1e-9, "{case}, {k}: {deep} m deep");
            for (solid, at) in &solids {
                let gap = separation(&rod, &tool, solid, at).distance;
                assert!(gap >= settings.least_gap_m - 1e-9, "{case}, {k}: {gap} m after {step:?}");
            }
            moved += travelled;
            glided += usize::from(step.active_rows > 0 && travelled > 1e-6);
            fastest_turn = fastest_turn.max(turned / dt_s);
            deepest = deepest.max(deep);
        }
    }
    assert!(
        moved > 0.5 && glided > 200 && fastest_turn > 0.9 && deepest > 0.055,
        "{moved} {glided} {fastest_turn} {deepest}"
    );
}

#[test]
fn the_tool_reaches_a_hand_that_it_can_reach_and_the_other_side_through_the_point() {
    let settings = NavigatorSettings::default();
    let mut guide = Guide::entry(Vec3::ZERO, Vec3::Z, 0.0, ANY_DEPTH).unwrap();
    let mut navigator = navigator(&[], Pose::from_translation(Vec3::Z * 0.05), settings);
    navigator.set_remote_center(guide.remote_center().copied());
    for to in [Vec3::new(0.04, 0.03, 0.05), Vec3::new(0.02, 0.0, -0.06), Vec3::new(-0.03, 0.01, 0.06)] {
        let hand = Pose::new(Rotation::from_rpy(0.0, 0.0, 0.3), to);
        for _ in 0..2500 {
            let wanted = guide.toward(&navigator.tool_in_world(), &hand);
            navigator.step(&wanted, 0.001);
        }
        let tool = navigator.tool_in_world();
        assert!(tool.translation.distance(to) < 1e-6, "{tool:?} instead of {to:?}");
        let wanted = guide.toward(&tool, &hand);
        assert!((tool.rotation * wanted.rotation.inverse()).angle() < 1e-5, "{tool:?}");
    }
}

#[test]
fn a_shaft_that_lies_against_the_rim_slides_along_itself() {
    // The hand tilts the rod against the rim of the hole, and pushes it in.
    let mut guide = Guide::entry(Vec3::ZERO, Vec3::Z, 0.0, ANY_DEPTH).unwrap();
    let mut navigator = navigator(&housing(), Pose::from_translation(Vec3::Z * 0.02), NavigatorSettings::default());
    navigator.set_remote_center(guide.remote_center().copied());
    let mut contact = 0;
    for k in 0..2000 {
        let hand = Pose::from_translation(Vec3::new(0.2, 0.0, 0.02 + 2e-5 * f64::from(k)));
        let wanted = guide.toward(&navigator.tool_in_world(), &hand);
        contact += usize::from(navigator.step(&wanted, 0.002).active_rows > 0);
    }
    let tool = navigator.tool_in_world();
    let tilt = (tool.rotation * Vec3::Z).dot(Vec3::Z).acos();
    let deep = depth(&tool, Vec3::Z, Vec3::ZERO);
    assert!(contact > 1000 && tilt > 0.3 && deep > 0.055, "{contact} steps in contact, {tilt} rad, {deep} m");
}

#[test]
fn a_shaft_elsewhere_turns_to_the_point_before_its_tip_moves() {
    let start = Pose::new(Rotation::from_rpy(0.2, 0.0, 0.0), Vec3::Z * 0.05);
    let mut guide = Guide::entry(Vec3::ZERO, Vec3::Z, 0.0, ANY_DEPTH).unwrap();
    let mut navigator = navigator(&[], start, NavigatorSettings::default());
    navigator.set_remote_center(guide.remote_center().copied());
    let hand = Pose::from_translation(Vec3::new(0.03, 0.0, 0.05));
    let mut last = guide.distance_m(&start);
    assert!(last > 0.009);
    for k in 0..1500 {
        let before = navigator.tool_in_world();
        let step = navigator.step(&guide.toward(&before, &hand), 0.001);
        let off = guide.distance_m(&step.tool_in_world);
        assert!(off <= last || off < TOLERANCE_M, "{k}: {off} m after {last} m");
        if step.limit == Some(Limit::Entry) {
            assert!(step.tool_in_world.translation.distance(start.translation) < 1e-3, "{k}");
        }
        // In between, at a micrometre, it may be either.
        assert!(step.limit == Some(Limit::Entry) || last <= TOLERANCE_M, "{k}: {last} m");
        assert!(step.limit.is_none() || last > 0.9e-6, "{k}: {last} m");
        last = off;
    }
    assert!(last < TOLERANCE_M && navigator.tool_in_world().translation.distance(hand.translation) < 1e-3);
}

#[test]
fn a_whole_arm_keeps_its_shaft_at_the_point_within_the_limits_of_its_joints() {
    let (scene, start) = scene(Some(0.05));
    let mut arm = guided(&scene, start, true);
    let at = start.translation - start.rotation * Vec3::Z * 0.06;
    arm.set_guide(Some(Guide::entry(at, Vec3::Z, 0.0, (0.02, 0.09)).unwrap()));
    let (robot, flange, tcp_in_flange, _) = arm::arm();
    let mut state = elbowroom_kinematics::ChainState::new(&robot.chain);
    let mut random = SplitMix(7);
    let (mut hand, mut share, mut reasons) = (start, 1.0, [0; 3]);
    let mut largest: f64 = 0.0;
    let mut moved = 0.0;
    for k in 0..1500 {
        if k % 50 == 0 {
            let turn = pose(&mut random, 0.0, if k % 200 == 0 { 3.0 } else { 0.4 }).rotation;
            hand = Pose::new(turn * start.rotation, start.translation + point(&mut random, 0.08));
            share = [1.0, 1.0, 0.3, 0.0][random.below(4)];
        }
        let before = (arm.q().to_vec(), arm.tool_in_world().translation);
        let step = arm.step((k % 300 < 280).then_some(&hand), DT_S, share);
        assert!(before.0.iter().zip(arm.q()).all(|(a, b)| (a - b).abs() <= 1.5 * DT_S * (1.0 + 1e-6)), "{k}");
        state.q.copy_from_slice(arm.q());
        robot.chain.forward(&mut state);
        let tool = state.link_in_root(flange) * tcp_in_flange;
        largest = largest.max(naive_offset(&tool, Vec3::Z, at));
        let deep = depth(&tool, Vec3::Z, at);
        assert!((0.02 - TOLERANCE_M..0.09 + TOLERANCE_M).contains(&deep), "{k}: {deep} m");
        moved += tool.translation.distance(before.1);
        match step.limit {
            None => reasons[0] += 1,
            Some(ArmLimit::Tool(_)) => reasons[1] += 1,
            Some(_) => reasons[2] += 1,
        }
    }
    assert!(largest <= TOLERANCE_M, "{largest} m from the point");
    assert!(moved > 0.1 && reasons[0] > 200, "{moved} m, {reasons:?}");
}

#[test]
fn points_of_entry_that_are_not_usable_are_refused() {
    let entry = |at, axis, radius, depth| Guide::entry(at, axis, radius, depth).err();
    assert_eq!(entry(Vec3::ZERO, Vec3::ZERO, 0.0, ANY_DEPTH), Some(NavigatorError::GuideDirection));
    assert_eq!(entry(Vec3::splat(f64::NAN), Vec3::Z, 0.0, ANY_DEPTH), Some(NavigatorError::GuideDirection));
    assert!(matches!(entry(Vec3::ZERO, Vec3::Z, -1e-3, ANY_DEPTH), Some(NavigatorError::Setting { .. })));
    assert!(matches!(entry(Vec3::ZERO, Vec3::Z, f64::NAN, ANY_DEPTH), Some(NavigatorError::Setting { .. })));
    for depth in [(0.1, 0.1), (0.2, 0.1), (f64::NAN, 0.1), (0.1, f64::NAN)] {
        assert!(matches!(entry(Vec3::ZERO, Vec3::Z, 0.0, depth), Some(NavigatorError::GuideDepth { .. })), "{depth:?}");
    }
}
