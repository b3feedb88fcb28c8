//! Where a tool goes: never into a surface, never through one, and as near to the desired point as it can.

use std::sync::Arc;

use elbowroom_proximity::ccd::{CcdOptions, ConstantTwist, time_of_impact};
use elbowroom_proximity::{Shape, TriMesh, separation};
use elbowroom_shared_control::{NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_testkit::extent::amount;
use elbowroom_testkit::random::SplitMix;

use crate::common::{ball, block, point, pose, relief};

/// Distance between tool and surfaces, by another path of the library than the navigator's; 0 inside.
fn distance(tool: &Shape, tool_in_world: &Pose, surfaces: &[(Shape, Pose)]) -> f64 {
    surfaces.iter().map(|(s, at)| separation(tool, tool_in_world, s, at).distance).fold(f64::INFINITY, f64::min)
}

struct Bench {
    tool: Shape,
    surfaces: Vec<(Shape, Pose)>,
    navigator: SurfaceNavigator,
}

impl Bench {
    fn new(tool: &Arc<TriMesh>, surfaces: &[(Arc<TriMesh>, Pose)], start: Pose, settings: NavigatorSettings) -> Self {
        let protected = surfaces.iter().map(|(m, at)| ProtectedSurface::new(m.clone(), *at).unwrap()).collect();
        let navigator = SurfaceNavigator::new(tool.clone(), protected, start, settings).unwrap();
        let surfaces = surfaces.iter().map(|(m, at)| (Shape::Mesh(m.clone()), *at)).collect();
        Self { tool: Shape::Mesh(tool.clone()), surfaces, navigator }
    }

    /// One step, with the distance checked at points along it.
    fn step(&mut self, desired: &Pose, dt_s: f64, least_gap_m: f64) {
        let before = self.navigator.tool_in_world();
        let step = self.navigator.step(desired, dt_s);
        let gap = distance(&self.tool, &before, &self.surfaces);
        assert!(
            step.gap_m.is_none_or(|told| told <= gap && told > gap - 1e-9),
            "{:?} told, {gap} measured",
            step.gap_m
        );
        // The way of the tool point, by continuous collision detection: nothing is passed through.
        let way = step.tool_in_world.translation - before.translation;
        let options = CcdOptions { tolerance: 1e-6, ..CcdOptions::default() };
        for (surface, in_world) in &self.surfaces {
            let hit = time_of_impact(&self.tool, &ConstantTwist::linear(before, way), surface, in_world, &options);
            assert_eq!(hit, None, "{step:?}");
        }
        for k in 1..=4 {
            let share = f64::from(k) / 4.0;
            let at = if k == 4 { step.tool_in_world } else { before.interpolate(&step.tool_in_world, share) };
            let gap = distance(&self.tool, &at, &self.surfaces);
            assert!(gap >= least_gap_m - 1e-9, "gap {gap} at {share} of a step to {desired:?}: {step:?}");
        }
    }
}

/// Desired poses from micrometres to metres away, some turned, and steps of 1 to 20 ms.
fn wander(bench: &mut Bench, random: &mut SplitMix, steps: usize, settings: &NavigatorSettings) {
    let mut desired = bench.navigator.tool_in_world();
    for _ in 0..steps {
        if random.unit() < 0.2 {
            let reach = 10_f64.powf(random.between(-6.0, 0.3));
            let turned = if random.unit() < 0.5 { pose(random, 0.0, 1.0).rotation } else { Rotation::IDENTITY };
            let from = if random.unit() < 0.5 { Vec3::ZERO } else { bench.navigator.tool_in_world().translation };
            desired = Pose::new(turned * desired.rotation, from + point(random, reach));
        }
        let dt_s = if random.unit() < 0.1 { 0.02 } else { 0.001 };
        bench.step(&desired, dt_s, settings.least_gap_m);
    }
}

#[test]
fn no_desired_pose_brings_the_tool_into_a_relief_or_through_a_thin_plate() {
    let plates = [
        (block(Vec3::new(0.3, 0.3, 1e-4)), Pose::from_translation(Vec3::Z * 0.06)),
        (block(Vec3::new(1e-4, 0.3, 0.3)), Pose::new(Rotation::from_rpy(0.2, 0.1, 0.3), Vec3::new(0.08, 0.0, 0.1))),
    ];
    let mut random = SplitMix(5);
    // A million steps in a long run, also over the finest relief.
    for round in 0..amount(1, 117) {
        for (tool, steps) in [(ball(0.01, 3), 4000), (block(Vec3::new(0.02, 0.004, 0.03)), 4000), (ball(0.01, 4), 600)]
        {
            let ground = relief(if round % 8 == 7 { 225 } else { 24 });
            let surfaces: Vec<_> = [(ground, Pose::IDENTITY)].into_iter().chain(plates.clone()).collect();
            for speed_m_s in [0.25, 20.0] {
                let settings = NavigatorSettings { speed_m_s, turn_rad_s: 10.0 * speed_m_s, ..Default::default() };
                let start = Pose::from_translation(Vec3::new(0.0, 0.0, 0.035));
                let mut bench = Bench::new(&tool, &surfaces, start, settings);
                wander(&mut bench, &mut random, steps / 2, &settings);
            }
        }
    }
}

#[test]
fn a_jump_of_a_metre_does_not_pass_a_plate_of_a_tenth_of_a_millimetre() {
    let plate = (block(Vec3::new(2.0, 2.0, 1e-4)), Pose::IDENTITY);
    let settings = NavigatorSettings { speed_m_s: 100.0, acceleration_m_s2: 1e6, ..Default::default() };
    let mut bench = Bench::new(&ball(0.01, 3), &[plate], Pose::from_translation(Vec3::Z * 0.2), settings);
    for _ in 0..200 {
        bench.step(&Pose::from_translation(Vec3::new(0.3, 0.0, -0.8)), 0.01, settings.least_gap_m);
    }
    let end = bench.navigator.tool_in_world().translation;
    // 10 mm of the ball's radius, half of the plate, the gap.
    assert!((end - Vec3::new(0.3, 0.0, 0.01 + 0.5e-4 + settings.gap_m)).length() < 2e-5, "{end:?}");
}

#[test]
fn a_surface_that_is_off_is_passed_and_not_switched_on_around_the_tool() {
    let plate = |z_m: f64| {
        ProtectedSurface::new(block(Vec3::new(0.2, 0.2, 0.01)), Pose::from_translation(Vec3::Z * z_m)).unwrap()
    };
    let settings = NavigatorSettings::default();
    let surfaces = vec![plate(0.0).switched(false), plate(-0.1)];
    let start = Pose::from_translation(Vec3::Z * 0.03);
    let mut navigator = SurfaceNavigator::new(ball(0.005, 2), surfaces, start, settings).unwrap();
    let go = |navigator: &mut SurfaceNavigator, z_m: f64| {
        let to = Pose::from_translation(Vec3::Z * z_m);
        for _ in 0..600 {
            navigator.step(&to, 1e-3);
        }
        navigator.tool_in_world().translation.z
    };
    assert!(go(&mut navigator, 0.0).abs() < 1e-5, "inside the plate that is off");
    assert!(navigator.separation_from(0, 1.0).is_none());
    let refused = navigator.switch(|index| index == 0);
    assert!(matches!(refused, Err(elbowroom_shared_control::NavigatorError::TooNear { .. })), "{refused:?}");
    // Nothing was switched: the other one still protects.
    let stopped = go(&mut navigator, -0.1);
    assert!((stopped - (-0.1 + 0.005 + 0.005 + settings.gap_m)).abs() < 2e-5, "{stopped}");
    navigator.switch(|index| index == 0).unwrap();
    assert!((go(&mut navigator, -0.1) + 0.1).abs() < 1e-5, "now this one is off");
    let stopped = go(&mut navigator, 0.1);
    assert!((stopped + 0.005 + 0.005 + settings.gap_m).abs() < 2e-5, "{stopped}");
}

#[test]
fn gliding_loses_no_tangential_motion() {
    let table = (block(Vec3::new(1.0, 1.0, 0.1)), Pose::new(Rotation::from_rpy(0.3, -0.2, 0.5), Vec3::ZERO));
    let normal = table.1.transform_vector(Vec3::Z);
    let along = table.1.transform_vector(Vec3::X);
    let settings = NavigatorSettings::default();
    let start = Pose::from_translation(normal * 0.08 - along * 0.3);
    let mut bench = Bench::new(&block(Vec3::splat(0.01)), &[table], start, settings);
    // The hand moves along the table and far inside it; the tool keeps up with its tangential motion.
    let hand = |t: f64| Pose::from_translation(normal * -0.01 + along * (0.1 * t - 0.3));
    for k in 0..3000 {
        bench.step(&hand(f64::from(k) * 1e-3), 1e-3, settings.least_gap_m);
    }
    let tool = bench.navigator.tool_in_world().translation;
    let behind = (hand(3.0).translation - tool).dot(along);
    assert!(behind.abs() < 2e-3, "{behind} m behind the hand");
}

#[test]
fn the_tool_comes_to_rest_at_the_nearest_point_of_a_convex_solid() {
    let solid = block(Vec3::new(0.2, 0.3, 0.1));
    let mut random = SplitMix(8);
    let settings = NavigatorSettings::default();
    for _ in 0..20 {
        let tool = ball(0.01, 2);
        let start = Pose::from_translation(Vec3::new(0.0, 0.0, 0.1));
        let mut bench = Bench::new(&tool, &[(solid.clone(), Pose::IDENTITY)], start, settings);
        let inside = Vec3::new(random.between(-0.05, 0.05), random.between(-0.1, 0.1), random.between(0.03, 0.05));
        for _ in 0..1500 {
            bench.step(&Pose::from_translation(inside), 1e-3, settings.least_gap_m);
        }
        // The upper face is the nearest; the tool touches it with its lower pole.
        let expected = Vec3::new(inside.x, inside.y, 0.05 + 0.01 + settings.gap_m);
        let tool = bench.navigator.tool_in_world().translation;
        assert!(tool.distance(expected) < 2e-5, "{tool:?} instead of {expected:?}");
    }
}

#[test]
fn the_tool_turns_where_there_is_room_and_stays_where_there_is_none() {
    let slot = [
        (block(Vec3::new(0.2, 0.2, 0.02)), Pose::from_translation(Vec3::Z * 0.017)),
        (block(Vec3::new(0.2, 0.2, 0.02)), Pose::from_translation(Vec3::Z * -0.017)),
    ];
    let settings = NavigatorSettings::default();
    let blade = block(Vec3::new(0.1, 0.01, 0.01));
    let mut bench = Bench::new(&blade, &slot, Pose::IDENTITY, settings);
    let flat = Rotation::from_rpy(0.0, 0.0, 0.5);
    for _ in 0..1000 {
        bench.step(&Pose::new(flat, Vec3::ZERO), 1e-3, settings.least_gap_m);
    }
    assert!((bench.navigator.tool_in_world().rotation * flat.inverse()).angle() < 1e-3, "there is room to turn flat");
    for _ in 0..1000 {
        bench.step(&Pose::new(Rotation::from_rpy(0.0, 0.5, 0.0), Vec3::ZERO), 1e-3, settings.least_gap_m);
    }
    let up = bench.navigator.tool_in_world().transform_vector(Vec3::X).z.abs();
    assert!(up < 0.045, "the blade of 100 mm cannot rise by more than 4 mm in a slot of 14 mm: {up}");
}

#[test]
fn the_speed_limit_holds_in_a_tapered_slot() {
    // Two walls, each half a degree off the vertical, nearer to the ball than the gap: both push it upwards.
    let half_angle: f64 = 0.5_f64.to_radians();
    let (radius, gap) = (0.005, 0.3e-3);
    let wall = |side: f64| {
        let turned = Rotation::from_rpy(0.0, side * half_angle, 0.0);
        let away = turned * Vec3::X * (side * (0.05 + radius + gap));
        (block(Vec3::new(0.1, 0.1, 1.0)), Pose::new(turned, away))
    };
    let settings = NavigatorSettings::default();
    let mut bench = Bench::new(&ball(radius, 2), &[wall(-1.0), wall(1.0)], Pose::IDENTITY, settings);
    for _ in 0..300 {
        let before = bench.navigator.tool_in_world().translation;
        bench.step(&Pose::IDENTITY, 1e-3, settings.least_gap_m);
        let speed = bench.navigator.tool_in_world().translation.distance(before) / 1e-3;
        assert!(speed <= settings.speed_m_s * (1.0 + 1e-9), "{speed} m/s");
    }
}

#[test]
fn a_tool_with_a_part_inside_out_is_guarded_as_a_whole() {
    let (outer, inner) = (block(Vec3::splat(0.02)), block(Vec3::splat(0.01)));
    let mut vertices = outer.vertices().to_vec();
    let mut triangles = outer.triangles().to_vec();
    let first = vertices.len() as u32;
    vertices.extend(inner.vertices().iter().map(|v| *v - Vec3::Z * 0.03));
    triangles.extend(inner.triangles().iter().map(|[a, b, c]| [a + first, c + first, b + first]));
    let tool = Arc::new(TriMesh::new(vertices, triangles).unwrap());
    let table = (block(Vec3::new(1.0, 1.0, 0.1)), Pose::from_translation(Vec3::Z * -0.05));
    let settings = NavigatorSettings::default();
    let mut bench = Bench::new(&tool, &[table], Pose::from_translation(Vec3::Z * 0.06), settings);
    for _ in 0..1000 {
        bench.step(&Pose::from_translation(Vec3::Z * -0.1), 1e-3, settings.least_gap_m);
    }
    let z = bench.navigator.tool_in_world().translation.z;
    assert!((z - 0.035 - settings.gap_m).abs() < 1e-5, "{z}");
}

#[test]
fn equal_input_gives_equal_bits() {
    let run = || {
        let start = Pose::from_translation(Vec3::Z * 0.035);
        let mut bench =
            Bench::new(&ball(0.01, 2), &[(relief(12), Pose::IDENTITY)], start, NavigatorSettings::default());
        wander(&mut bench, &mut SplitMix(9), 300, &NavigatorSettings::default());
        bench.navigator.tool_in_world()
    };
    assert_eq!(run(), run());
}
