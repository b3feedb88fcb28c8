//! The velocity of a tool in valleys and over ridges: no jump from one step to the next.

use elbowroom_shared_control::{NavigatorSettings, ProtectedSurface, SurfaceNavigator};
use elbowroom_spatial::{Pose, Vec3};

use crate::common::{ball, relief, valley};

/// The largest change of velocity in one step of 1 ms while the hand moves this way, m/s.
fn largest_change(mut navigator: SurfaceNavigator, hand: impl Fn(f64) -> Vec3, seconds: f64) -> f64 {
    let (mut last, mut largest): (Option<Vec3>, f64) = (None, 0.0);
    for k in 0..(seconds * 1e3) as usize {
        let step = navigator.step(&Pose::from_translation(hand(k as f64 * 1e-3)), 1e-3);
        if let Some(last) = last {
            largest = largest.max(step.velocity.distance(last));
        }
        last = Some(step.velocity);
    }
    largest
}

#[test]
fn in_a_valley_the_velocity_changes_no_faster_than_the_brakes() {
    let settings = NavigatorSettings { speed_m_s: 0.15, ..Default::default() };
    for slope in [0.2, 0.5, 1.0, 2.0] {
        let surface = ProtectedSurface::new(valley(slope), Pose::IDENTITY).unwrap();
        let start = Pose::from_translation(Vec3::new(-0.05, 0.0, 0.05 * slope + 0.03));
        let navigator = SurfaceNavigator::new(ball(0.01, 3), vec![surface], start, settings).unwrap();
        // The hand crosses the valley below its ground: down one wall, up the other.
        let change = largest_change(navigator, |t| Vec3::new(-0.05 + 0.05 * t, 0.02 * t, -0.03), 2.0);
        assert!(change < 0.03, "slope {slope}: {change} m/s in a millisecond");
    }
}

#[test]
fn over_a_relief_the_velocity_changes_by_little() {
    let settings = NavigatorSettings { speed_m_s: 0.1, gap_m: 2e-3, least_gap_m: 1e-3, ..Default::default() };
    let surface = ProtectedSurface::new(relief(72), Pose::IDENTITY).unwrap();
    let start = Pose::from_translation(Vec3::new(-0.15, -0.1, 0.04));
    let navigator = SurfaceNavigator::new(ball(0.01, 3), vec![surface], start, settings).unwrap();
    let change = largest_change(navigator, |t| Vec3::new(-0.15 + 0.08 * t, -0.1 + 0.05 * t, -0.02), 3.5);
    assert!(change < 0.03, "{change} m/s in a millisecond");
}
