//! Time-optimal parametrization: durations and computing times over random paths of seven joints; over random paths of
//! three joints, durations compared with the grid planner's time parametrization.
//!
//! `cargo bench -p elbowroom-planner --bench time_optimal_times -- [FILE]`: with a file, each path is written to a line
//! of it: waypoints and blend distance, then the durations.
#![allow(clippy::print_stdout)]

use elbowroom_kinematics::JointLimits;
use std::fmt::Write as _;
use std::time::Instant;

use elbowroom_cspace::{Grid, GridAxis, OccupancyBitmap};
use elbowroom_planner::{BlendedPath, GridPath, GridPlanner, TimeOptimalTrajectory};
use elbowroom_testkit::random::{split_mix, unit};

type Error = Box<dyn std::error::Error>;

const PATHS: usize = 200;
const REPEATS: u32 = 5;

/// Limits of a light arm, rad/s, rad/s², rad/s³.
fn limits(jerk_factor: f64) -> Vec<JointLimits> {
    let limits = [[2.175, 15.0], [2.175, 7.5], [2.175, 10.0], [2.175, 12.5], [2.61, 15.0], [2.61, 20.0], [2.61, 20.0]];
    limits
        .map(|[velocity, acceleration]| JointLimits::new(velocity, acceleration, 500.0 * acceleration * jerk_factor))
        .to_vec()
}

fn random_path(count: usize, state: &mut u64) -> Vec<Vec<f64>> {
    let mut q: Vec<f64> = (0..7).map(|_| 2.0 * unit(split_mix(state)) - 1.0).collect();
    let mut step = |q: &[f64]| q.iter().map(|x| x + 1.2 * (unit(split_mix(state)) - 0.5)).collect::<Vec<f64>>();
    let mut path = Vec::new();
    for _ in 0..count {
        let next = step(&q);
        path.push(std::mem::replace(&mut q, next));
    }
    path
}

/// The result, and the best of several computing times, µs.
fn timed(solve: impl Fn() -> TimeOptimalTrajectory) -> (TimeOptimalTrajectory, f64) {
    let mut best = f64::INFINITY;
    let mut result = solve();
    for _ in 0..REPEATS {
        let clock = Instant::now();
        result = solve();
        best = best.min(clock.elapsed().as_secs_f64() * 1e6);
    }
    (result, best)
}

/// Parametrizes the same three-joint paths by `GridPlanner::time_parametrize`, with all cells free.
fn beside_grid_planner() -> Result<(), Error> {
    let axis = |name| GridAxis::new(name, -1.0, 1.0, 0.1);
    let grid = Grid::new([axis("a")?, axis("b")?, axis("c")?])?;
    let planner = GridPlanner::new(&grid, &OccupancyBitmap::new(grid.shape()))?;
    for jerk in [20.0, 100.0, 1000.0] {
        let limits = vec![JointLimits::new(2.0, 10.0, jerk); 3];
        let mut state = 3;
        let [mut before, mut now] = [0.0; 2];
        for n in 0..PATHS {
            let mut value = || 1.98 * unit(split_mix(&mut state)) - 0.99;
            let waypoints: Vec<[f64; 3]> = (0..2 + n % 9).map(|_| [value(), value(), value()]).collect();
            let path = BlendedPath::new(&waypoints, |_| true)?;
            now += path.time_optimal(&limits)?.seconds();
            let path = GridPath { waypoints, length_rad: 0.0, start_moved_rad: 0.0, goal_moved_rad: 0.0 };
            before += planner.time_parametrize(&path, &limits)?.seconds();
        }
        println!("three joints, jerk {jerk}: S-curves {before:.1} s, time-optimal {now:.1} s (x{:.3})", now / before);
    }
    Ok(())
}

fn main() -> Result<(), Error> {
    let mut lines = String::new();
    for jerk_factor in [1.0, 0.1, 0.02] {
        for most in [f64::INFINITY, 0.1, 0.01] {
            let limits = limits(jerk_factor);
            let mut state = 7;
            let (mut intervals, mut topp_intervals, mut topp_us, mut all_us, mut topp_s, mut all_s) =
                (0, 0, 0.0, 0.0, 0.0, 0.0);
            let mut worst: f64 = 0.0;
            for n in 0..PATHS {
                let waypoints = random_path(2 + n % 9, &mut state);
                let path = BlendedPath::new(&waypoints, |blend| blend.distance() <= most)?;
                let (fast, us) = timed(|| path.time_optimal_without_jerk_limit(&limits).unwrap());
                topp_us += us;
                topp_intervals += fast.grid_intervals();
                topp_s += fast.seconds();
                let (all, us) = timed(|| path.time_optimal(&limits).unwrap());
                all_us += us;
                all_s += all.seconds();
                intervals += all.grid_intervals();
                worst = worst.max(all.seconds() / fast.seconds());
                writeln!(lines, "{jerk_factor};{most};{};{};{waypoints:?}", fast.seconds(), all.seconds())?;
            }
            println!(
                "jerk x{jerk_factor:<5} blends <= {most:<4}: {:4.0} intervals a path; per 100: TOPP-RA {:5.1} us, \
                 with jerk {:6.1} us; durations {topp_s:.1} and {all_s:.1} s (x{:.3}, at most x{worst:.3})",
                intervals as f64 / PATHS as f64,
                topp_us * 100.0 / topp_intervals as f64,
                all_us * 100.0 / intervals as f64,
                all_s / topp_s,
            );
        }
    }
    beside_grid_planner()?;
    if let Some(file) = elbowroom_testkit::bench::arguments().next() {
        std::fs::write(file, lines)?;
    }
    Ok(())
}
