//! Trajectories on the grid: limits, continuity, free cells.

use crate::common;
use crate::common::{Random, blocked_point, free_cell, grid, random_occupancy};
use elbowroom_cspace::OccupancyBitmap;
use elbowroom_kinematics::JointLimits;
use elbowroom_planner::{
    BlendedTrajectory, GridPath, GridPlanner, GridPlannerSettings, LimitKind, TimeParametrizationError,
};
use proptest::prelude::*;

fn fast() -> Vec<JointLimits> {
    vec![JointLimits::new(2.0, 8.0, 90.0), JointLimits::new(1.5, 5.0, 60.0), JointLimits::new(3.0, 12.0, 200.0)]
}

fn path(waypoints: Vec<[f64; 3]>) -> GridPath {
    GridPath { waypoints, length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 }
}

fn three(q: Vec<f64>) -> [f64; 3] {
    q.try_into().unwrap()
}

/// Checks limits and continuity at samples: positions from velocities, velocities from accelerations, accelerations
/// from jerks.
fn check(trajectory: &BlendedTrajectory, limits: &[JointLimits], steps: usize) {
    let h = trajectory.seconds() / steps as f64;
    let mut before = trajectory.at(0.0);
    for n in 1..=steps {
        let now = trajectory.at(n as f64 * h);
        for i in 0..3 {
            let (v, a, j) = (limits[i].velocity, limits[i].acceleration, limits[i].jerk);
            assert!(now.dq[i].abs() <= v * (1.0 + 1e-9), "velocity {} of joint {i}", now.dq[i]);
            assert!(now.ddq[i].abs() <= a * (1.0 + 1e-9), "acceleration {} of joint {i}", now.ddq[i]);
            let jerk = (now.ddq[i] - before.ddq[i]).abs() / h;
            assert!(jerk <= j * (1.0 + 1e-6) + 1e-9 / h, "jerk {jerk} of joint {i} at {}", n as f64 * h);
            // Taylor's remainder with the limit of the jerk.
            let q = before.q[i] + before.dq[i] * h + 0.5 * before.ddq[i] * h * h;
            assert!((now.q[i] - q).abs() <= j * h.powi(3) / 6.0 * (1.0 + 1e-6) + 1e-9, "position jumps");
            let dq = before.dq[i] + before.ddq[i] * h;
            assert!((now.dq[i] - dq).abs() <= 0.5 * j * h * h * (1.0 + 1e-6) + 1e-9, "velocity jumps");
        }
        before = now;
    }
}

fn waypoint() -> impl Strategy<Value = [f64; 3]> {
    let value = prop_oneof![-0.99..0.99, Just(0.0), Just(0.5), Just(0.5 + 1e-7)];
    [value.clone(), value.clone(), value]
}

fn limits() -> impl Strategy<Value = Vec<JointLimits>> {
    let limits = (0.1..5.0, 0.5..50.0, 1.0..5000.0).prop_map(|(v, a, j)| JointLimits::new(v, a, j));
    prop::collection::vec(limits, 3)
}

proptest! {
    #[test]
    fn trajectories_keep_the_limits_and_are_continuous(waypoints in prop::collection::vec(waypoint(), 1..8), limits in limits()) {
        let grid = grid([20, 20, 20]);
        let planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape())).unwrap();
        let trajectory = planner.time_parametrize(&path(waypoints.clone()), &limits).unwrap();
        prop_assert!(trajectory.seconds().is_finite());
        let (first, last) = (trajectory.at(0.0), trajectory.at(trajectory.seconds()));
        prop_assert!((0..3).all(|i| (first.q[i] - waypoints[0][i]).abs() < 2e-9 && first.dq[i] == 0.0));
        prop_assert_eq!(&last.q[..], waypoints.last().unwrap());
        if trajectory.seconds() > 0.0 {
            check(&trajectory, &limits, 3000);
        }
        // A little slower, at rest at multiples of the period: the same limits apply, and samples include both ends.
        let period = 0.01;
        let aligned = trajectory.clone().aligned_to_ticks(period).unwrap();
        let most = trajectory.seconds() + period * (trajectory.stops() + 1) as f64;
        prop_assert!(aligned.seconds() >= trajectory.seconds() * (1.0 - 1e-9) && aligned.seconds() <= most + 1e-9);
        if aligned.seconds() > 0.0 {
            check(&aligned, &limits, 3000);
        }
        let samples = aligned.samples(period).unwrap();
        prop_assert_eq!(samples.last().unwrap(), waypoints.last().unwrap());
        prop_assert!((samples.duration_s() - aligned.seconds()).abs() < 1e-9);
        for w in samples.rows().windows(2) {
            let slow = |i: usize| (w[1].q[i] - w[0].q[i]).abs() <= limits[i].velocity * period * (1.0 + 1e-9) + 1e-12;
            prop_assert!((0..3).all(slow), "{:?}", w);
        }
    }
}

#[test]
fn trajectories_stay_in_free_cells() {
    let mut random = Random(31);
    let (mut count, mut stops, mut corners) = (0, 0, 0);
    for _ in 0..300 {
        let shape = [20, 18, 50];
        let (grid, occupancy) = (grid(shape), random_occupancy(shape, &mut random));
        let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
        let Some((from, to)) = free_cell(&occupancy, &mut random).zip(free_cell(&occupancy, &mut random)) else {
            continue;
        };
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &GridPlannerSettings::default()) else {
            continue;
        };
        let trajectory = planner.time_parametrize(&path, &fast()).unwrap();
        let points: Vec<_> =
            (0..=4000).map(|n| trajectory.at(trajectory.seconds() * f64::from(n) / 4000.0).q).map(three).collect();
        assert_eq!(blocked_point(&grid, &occupancy, &points, 1), None);
        count += 1;
        stops += trajectory.stops();
        corners += path.waypoints.len().saturating_sub(2);
    }
    println!("{count} trajectories, {corners} corners, {stops} stops");
    assert!(count > 100 && corners > 50 && stops < corners / 2);
}

/// Motion from rest to rest: the first half accelerates within limits of jerk and acceleration.
#[test]
fn a_straight_segment_takes_the_least_time() {
    let grid = grid([20, 20, 20]);
    let planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape())).unwrap();
    let limits = vec![JointLimits::new(1.0, 2.0, 10.0); 3];
    let seconds =
        |far: f64| planner.time_parametrize(&path(vec![[0.0; 3], [far, 0.0, 0.0]]), &limits).unwrap().seconds();
    // If the speed limit is reached: length / v + v / a + a / j.
    assert!((seconds(0.9) - (0.9 + 0.5 + 0.2)).abs() < 1e-9);
    // If the acceleration limit is not reached: 4·∛(length / 2j).
    assert!((seconds(0.02) - 4.0 * (0.02_f64 / 20.0).cbrt()).abs() < 1e-9);
}

#[test]
fn blends_shrink_where_cells_beside_the_corner_are_blocked() {
    let grid = grid([20, 20, 20]);
    let mut occupancy = OccupancyBitmap::new(grid.shape());
    let corner = path(vec![grid.center([2, 2, 5]), grid.center([15, 2, 5]), grid.center([15, 15, 5])]);
    let open = GridPlanner::new(&grid, &occupancy).unwrap().time_parametrize(&corner, &fast()).unwrap();
    for i in 0..20 {
        for j in 0..20 {
            if !(j == 2 || i == 15) {
                common::block(&mut occupancy, [i, j, 5]);
            }
        }
    }
    let planner = GridPlanner::new(&grid, &occupancy).unwrap();
    let narrow = planner.time_parametrize(&corner, &fast()).unwrap();
    assert!(open.stops() == 0 && open.seconds() < narrow.seconds());
    let points: Vec<_> = (0..=4000).map(|n| narrow.at(narrow.seconds() * f64::from(n) / 4000.0).q).map(three).collect();
    assert_eq!(blocked_point(&grid, &occupancy, &points, 1), None);
    let back = path(vec![grid.center([2, 2, 5]), grid.center([15, 2, 5]), grid.center([4, 2, 5])]);
    check(&planner.time_parametrize(&back, &fast()).unwrap(), &fast(), 3000);
}

#[test]
fn invalid_limits_and_paths_are_rejected() {
    let grid = grid([5, 5, 5]);
    let planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape())).unwrap();
    let here = path(vec![grid.center([1, 1, 1])]);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut limits = fast();
        limits[1].jerk = bad;
        assert!(matches!(
            planner.time_parametrize(&here, &limits),
            Err(TimeParametrizationError::Limit { joint: 1, kind: LimitKind::Jerk, .. })
        ));
    }
    let few = &fast()[..2];
    assert_eq!(
        planner.time_parametrize(&here, few).unwrap_err(),
        TimeParametrizationError::Count { given: 2, joints: 3 }
    );
    assert_eq!(planner.time_parametrize(&path(vec![]), &fast()).unwrap_err(), TimeParametrizationError::Path);
    assert_eq!(
        planner.time_parametrize(&path(vec![[f64::NAN; 3]]), &fast()).unwrap_err(),
        TimeParametrizationError::Path
    );
    assert_eq!(planner.time_parametrize(&here, &fast()).unwrap().seconds(), 0.0);
}
