//! The velocity of a tool in valleys and over ridges: no jump from one step to the next.

use std::sync::Arc;

use elbowroom_proximity::{Shape, TriMesh, project_point};
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

/// The admissible projection of a ball's centre that is nearest to the desired one, in each step by itself: onto the planes of
/// the triangles, or onto their borders, a radius and a gap outside; `last` if none is admissible (after Giralt et al., decision
/// 0044).
fn nearest_projection(mesh: &Arc<TriMesh>, away_m: f64, desired: Vec3, last: Vec3) -> Vec3 {
    let shape = Shape::Mesh(mesh.clone());
    let is_free = |p: Vec3| project_point(&shape, &Pose::IDENTITY, p).signed_distance >= away_m - 1e-9;
    if is_free(desired) {
        return desired;
    }
    let onto = |[a, b, c]: [Vec3; 3]| {
        let normal = (b - a).cross(c - a).try_normalize()?;
        let alone = TriMesh::new(vec![a, b, c], vec![[0, 1, 2]]).ok()?;
        Some(alone.nearest_point_within(desired, f64::INFINITY)? + normal * away_m)
    };
    let triangles = mesh.triangles().iter().map(|t| t.map(|i| mesh.vertices()[i as usize]));
    let near = triangles.filter(|t| t.iter().any(|v| v.distance(desired) < 0.08));
    let admissible = near.filter_map(onto).filter(|p| is_free(*p));
    admissible.min_by(|p, q| p.distance(desired).total_cmp(&q.distance(desired))).unwrap_or(last)
}

#[test]
fn over_a_relief_the_velocity_changes_less_than_between_nearest_projections() {
    let settings = NavigatorSettings { speed_m_s: 0.1, gap_m: 2e-3, least_gap_m: 1e-3, ..Default::default() };
    let (mesh, start) = (relief(24), Vec3::new(-0.15, -0.1, 0.04));
    let hand = |t: f64| Vec3::new(-0.15 + 0.08 * t, -0.1 + 0.05 * t, -0.02);
    let surface = ProtectedSurface::new(mesh.clone(), Pose::IDENTITY).unwrap();
    let navigator =
        SurfaceNavigator::new(ball(0.01, 3), vec![surface], Pose::from_translation(start), settings).unwrap();
    let change = largest_change(navigator, hand, 3.5);
    let (mut at, mut velocity, mut without) = (nearest_projection(&mesh, 0.012, hand(0.0), start), None, 0.0_f64);
    for k in 1..3500 {
        let next = nearest_projection(&mesh, 0.012, hand(f64::from(k) * 1e-3), at);
        let now = (next - at) * 1e3;
        without = velocity.map_or(without, |before: Vec3| without.max(now.distance(before)));
        (at, velocity) = (next, Some(now));
    }
    assert!(change < 0.03 && without > 10.0 * change, "{change} m/s, {without} m/s by nearest projections");
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
