//! Input that is refused with a reason, and steps in which the tool stands.

use std::sync::Arc;

use elbowroom_proximity::TriMesh;
use elbowroom_shared_control::{
    Limit, NavigatorError, NavigatorSettings, ProtectedSurface, ShieldError, ShieldSettings, ShieldTarget,
    SurfaceNavigator, generate_shield,
};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::common::{ball, block};

fn flipped(mesh: &TriMesh, which: impl Fn(usize) -> bool) -> Arc<TriMesh> {
    let turn = |(i, &[a, b, c]): (usize, &[u32; 3])| if which(i) { [a, c, b] } else { [a, b, c] };
    let triangles = mesh.triangles().iter().enumerate().map(turn).collect();
    Arc::new(TriMesh::new(mesh.vertices().to_vec(), triangles).unwrap())
}

fn refusal(mesh: Arc<TriMesh>) -> NavigatorError {
    ProtectedSurface::new(mesh, Pose::IDENTITY).unwrap_err()
}

#[test]
fn surfaces_without_a_clear_inside_are_refused() {
    let solid = block(Vec3::splat(0.1));
    let open = TriMesh::new(solid.vertices().to_vec(), solid.triangles()[1..].to_vec()).unwrap();
    assert_eq!(refusal(Arc::new(open)), NavigatorError::Open);
    assert_eq!(refusal(flipped(&solid, |_| true)), NavigatorError::InsideOut);
    assert_eq!(refusal(flipped(&solid, |i| i == 3)), NavigatorError::Unoriented);
    let nowhere = Pose::from_translation(Vec3::X * f64::INFINITY);
    let error = ProtectedSurface::new(solid, nowhere).unwrap_err();
    assert_eq!(error, NavigatorError::PoseNotFinite("a protected surface"));
}

#[test]
fn a_target_on_reversed_triangles_is_not_blamed() {
    let solid = block(Vec3::splat(0.1));
    let drill = ShieldTarget::Drill { at: Vec3::Z * 0.05, axis: -Vec3::Z };
    let settings = ShieldSettings { tolerance_m: 0.01, ..ShieldSettings::with_width(0.02) };
    assert!(generate_shield(&solid, &drill, &settings).is_ok());
    let corner = |v: u32| solid.vertices()[v as usize];
    let is_above = |i: usize| solid.triangles()[i].iter().all(|v| corner(*v).z > 0.0);
    let error = generate_shield(&flipped(&solid, is_above), &drill, &settings).unwrap_err();
    assert_eq!(error, ShieldError::Surface(NavigatorError::Unoriented));
}

#[test]
fn a_tool_that_starts_too_near_or_inside_is_refused_with_its_distance() {
    let surface = ProtectedSurface::new(block(Vec3::splat(0.1)), Pose::IDENTITY).unwrap();
    let start = |z: f64| {
        let at = Pose::from_translation(Vec3::Z * z);
        SurfaceNavigator::new(block(Vec3::splat(0.02)), vec![surface.clone()], at, NavigatorSettings::default()).err()
    };
    let Some(NavigatorError::TooNear { gap_m, .. }) = start(0.0601) else { panic!("{:?}", start(0.0601)) };
    assert!((gap_m - 1e-4).abs() < 1e-9, "{gap_m}");
    assert!(matches!(start(0.0), Some(NavigatorError::TooNear { gap_m: 0.0, .. })));
    assert_eq!(start(0.0604), None);
}

#[test]
fn settings_that_protect_nothing_are_refused() {
    let with = |settings| SurfaceNavigator::new(ball(0.01, 1), vec![], Pose::IDENTITY, settings).err();
    let good = NavigatorSettings::default();
    assert_eq!(with(good), None);
    for bad in [
        NavigatorSettings { gap_m: 0.0, ..good },
        NavigatorSettings { least_gap_m: good.gap_m, ..good },
        NavigatorSettings { speed_m_s: f64::NAN, ..good },
        NavigatorSettings { acceleration_m_s2: f64::INFINITY, ..good },
        NavigatorSettings { longest_step_s: -1.0, ..good },
    ] {
        assert!(matches!(with(bad), Some(NavigatorError::Setting { .. })), "{bad:?}");
    }
}

#[test]
fn after_input_that_is_not_usable_the_tool_stands_and_goes_on_later() {
    let mut navigator =
        SurfaceNavigator::new(ball(0.01, 1), vec![], Pose::IDENTITY, NavigatorSettings::default()).unwrap();
    let goal = Pose::from_translation(Vec3::X * 0.1);
    for _ in 0..100 {
        navigator.step(&goal, 1e-3);
    }
    let before = navigator.tool_in_world();
    let nan = Pose::new(Rotation::IDENTITY, Vec3::X * f64::NAN);
    for (desired, dt_s, limit) in [
        (nan, 1e-3, Limit::PoseNotFinite),
        (goal, 0.0, Limit::StepDuration),
        (goal, f64::NAN, Limit::StepDuration),
        (goal, 10.0, Limit::StepDuration),
    ] {
        let step = navigator.step(&desired, dt_s);
        assert_eq!((step.limit, step.velocity, step.tool_in_world), (Some(limit), Vec3::ZERO, before));
    }
    assert!(navigator.step(&goal, 1e-3).velocity.x > 0.0);
}
