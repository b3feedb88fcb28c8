//! Motions in time: limits, continuity, and that they stay in free cells.

mod common;

use common::{Random, blocked_point, free_cell, grid, random_table};
use elbowroom_cspace::Table;
use elbowroom_planner::{MotionError, MotionLimits, Path, PlanOptions, Planner, Trajectory};
use proptest::prelude::*;

fn fast() -> MotionLimits {
    MotionLimits { velocity: vec![2.0, 1.5, 3.0], acceleration: vec![8.0, 5.0, 12.0], jerk: vec![90.0, 60.0, 200.0] }
}

fn path(waypoints: Vec<[f64; 3]>) -> Path {
    Path { waypoints, length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 }
}

fn three(q: Vec<f64>) -> [f64; 3] {
    q.try_into().unwrap()
}

/// Samples limits and continuity: positions by speeds, speeds by accelerations, accelerations by jerks.
fn check(motion: &Trajectory, limits: &MotionLimits, steps: usize) {
    let h = motion.seconds() / steps as f64;
    let mut before = motion.at(0.0);
    for n in 1..=steps {
        let now = motion.at(n as f64 * h);
        for i in 0..3 {
            let (v, a, j) = (limits.velocity[i], limits.acceleration[i], limits.jerk[i]);
            assert!(now.qd[i].abs() <= v * (1.0 + 1e-9), "speed {} of joint {i}", now.qd[i]);
            assert!(now.qdd[i].abs() <= a * (1.0 + 1e-9), "acceleration {} of joint {i}", now.qdd[i]);
            let jerk = (now.qdd[i] - before.qdd[i]).abs() / h;
            assert!(jerk <= j * (1.0 + 1e-6) + 1e-9 / h, "jerk {jerk} of joint {i} at {}", n as f64 * h);
            // Taylor's remainder with the jerk's limit.
            let q = before.q[i] + before.qd[i] * h + 0.5 * before.qdd[i] * h * h;
            assert!((now.q[i] - q).abs() <= j * h.powi(3) / 6.0 * (1.0 + 1e-6) + 1e-9, "position jumps");
            let qd = before.qd[i] + before.qdd[i] * h;
            assert!((now.qd[i] - qd).abs() <= 0.5 * j * h * h * (1.0 + 1e-6) + 1e-9, "speed jumps");
        }
        before = now;
    }
}

fn waypoint() -> impl Strategy<Value = [f64; 3]> {
    let value = prop_oneof![-0.99..0.99, Just(0.0), Just(0.5), Just(0.5 + 1e-7)];
    [value.clone(), value.clone(), value]
}

fn limits() -> impl Strategy<Value = MotionLimits> {
    let three = |low: f64, high: f64| prop::collection::vec(low..high, 3);
    (three(0.1, 5.0), three(0.5, 50.0), three(1.0, 5000.0)).prop_map(|(velocity, acceleration, jerk)| MotionLimits {
        velocity,
        acceleration,
        jerk,
    })
}

proptest! {
    #[test]
    fn limits_are_kept_and_nothing_jumps(waypoints in prop::collection::vec(waypoint(), 1..8), limits in limits()) {
        let grid = grid([20, 20, 20]);
        let planner = Planner::new(&grid, &Table::new(grid.shape())).unwrap();
        let motion = planner.time(&path(waypoints.clone()), &limits).unwrap();
        prop_assert!(motion.seconds().is_finite());
        let (first, last) = (motion.at(0.0), motion.at(motion.seconds()));
        prop_assert!((0..3).all(|i| (first.q[i] - waypoints[0][i]).abs() < 2e-9 && first.qd[i] == 0.0));
        prop_assert_eq!(&last.q[..], waypoints.last().unwrap());
        if motion.seconds() > 0.0 {
            check(&motion, &limits, 3000);
        }
        // A little slower, resting at whole periods: the same limits, and rows that begin, end and stop at waypoints.
        let period = 0.01;
        let ticked = motion.clone().on_ticks(period).unwrap();
        let most = motion.seconds() + period * (motion.stops() + 1) as f64;
        prop_assert!(ticked.seconds() >= motion.seconds() * (1.0 - 1e-9) && ticked.seconds() <= most + 1e-9);
        if ticked.seconds() > 0.0 {
            check(&ticked, &limits, 3000);
        }
        let rows = ticked.rows(period).unwrap();
        prop_assert_eq!(&rows.last().unwrap().1[..], waypoints.last().unwrap());
        prop_assert!((rows.last().unwrap().0 - ticked.seconds()).abs() < 1e-9);
        for w in rows.windows(2) {
            let slow = |i: usize| (w[1].1[i] - w[0].1[i]).abs() <= limits.velocity[i] * period * (1.0 + 1e-9) + 1e-12;
            prop_assert!((0..3).all(slow), "{:?}", w);
        }
    }
}

#[test]
fn a_motion_stays_in_free_cells() {
    let mut random = Random(31);
    let (mut count, mut stops, mut corners) = (0, 0, 0);
    for _ in 0..300 {
        let shape = [20, 18, 50];
        let (grid, table) = (grid(shape), random_table(shape, &mut random));
        let mut planner = Planner::new(&grid, &table).unwrap();
        let Some((from, to)) = free_cell(&table, &mut random).zip(free_cell(&table, &mut random)) else { continue };
        let Ok(path) = planner.plan(grid.center(from), grid.center(to), &PlanOptions::default()) else { continue };
        let motion = planner.time(&path, &fast()).unwrap();
        let points: Vec<_> =
            (0..=4000).map(|n| motion.at(motion.seconds() * f64::from(n) / 4000.0).q).map(three).collect();
        assert_eq!(blocked_point(&grid, &table, &points, 1), None);
        count += 1;
        stops += motion.stops();
        corners += path.waypoints.len().saturating_sub(2);
    }
    println!("{count} motions, {corners} corners, {stops} stops");
    assert!(count > 100 && corners > 50 && stops < corners / 2);
}

/// Rest to rest: a half of it speeds up as fast as jerk and acceleration allow.
#[test]
fn a_straight_leg_takes_the_least_time() {
    let grid = grid([20, 20, 20]);
    let planner = Planner::new(&grid, &Table::new(grid.shape())).unwrap();
    let limits = MotionLimits { velocity: vec![1.0; 3], acceleration: vec![2.0; 3], jerk: vec![10.0; 3] };
    let seconds = |far: f64| planner.time(&path(vec![[0.0; 3], [far, 0.0, 0.0]]), &limits).unwrap().seconds();
    // Speed reached: length / v + v / a + a / j.
    assert!((seconds(0.9) - (0.9 + 0.5 + 0.2)).abs() < 1e-9);
    // Acceleration not reached: 4·∛(length / 2j).
    assert!((seconds(0.02) - 4.0 * (0.02_f64 / 20.0).cbrt()).abs() < 1e-9);
}

#[test]
fn corners_are_rounded_and_less_where_there_is_little_room() {
    let grid = grid([20, 20, 20]);
    let mut table = Table::new(grid.shape());
    let corner = path(vec![grid.center([2, 2, 5]), grid.center([15, 2, 5]), grid.center([15, 15, 5])]);
    let open = Planner::new(&grid, &table).unwrap().time(&corner, &fast()).unwrap();
    for i in 0..20 {
        for j in 0..20 {
            if !(j == 2 || i == 15) {
                common::block(&mut table, [i, j, 5]);
            }
        }
    }
    let planner = Planner::new(&grid, &table).unwrap();
    let tight = planner.time(&corner, &fast()).unwrap();
    assert!(open.stops() == 0 && open.seconds() < tight.seconds());
    let points: Vec<_> = (0..=4000).map(|n| tight.at(tight.seconds() * f64::from(n) / 4000.0).q).map(three).collect();
    assert_eq!(blocked_point(&grid, &table, &points, 1), None);
    let back = path(vec![grid.center([2, 2, 5]), grid.center([15, 2, 5]), grid.center([4, 2, 5])]);
    check(&planner.time(&back, &fast()).unwrap(), &fast(), 3000);
}

#[test]
fn bad_limits_and_paths_are_refused() {
    let grid = grid([5, 5, 5]);
    let planner = Planner::new(&grid, &Table::new(grid.shape())).unwrap();
    let here = path(vec![grid.center([1, 1, 1])]);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let limits = MotionLimits { jerk: vec![100.0, bad, 100.0], ..fast() };
        assert!(matches!(planner.time(&here, &limits), Err(MotionError::Limit { joint: 1, what: "jerk", .. })));
    }
    let few = MotionLimits { velocity: vec![1.0; 2], ..fast() };
    assert_eq!(planner.time(&here, &few).unwrap_err(), MotionError::Count { what: "speed", given: 2, joints: 3 });
    assert_eq!(planner.time(&path(vec![]), &fast()).unwrap_err(), MotionError::Path);
    assert_eq!(planner.time(&path(vec![[f64::NAN; 3]]), &fast()).unwrap_err(), MotionError::Path);
    assert_eq!(planner.time(&here, &fast()).unwrap().seconds(), 0.0);
}
