//! How long planning takes, and how good paths are: 1,000 random pairs of ends in each of three cells.
//!
//! `cargo run --release -p elbowroom-planner --example plan_times`
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use common::{Random, blocked_point, free_cell, grid_optimum, joined};
use elbowroom_cspace::{Cell, Grid, JointMap, Obstacle};
use elbowroom_planner::{How, MappedJoints, MotionLimits, Path, PlanOptions, Planner, Progress, example};
use elbowroom_scene::{Checker, Options, SceneState, SweepOptions};

type Error = Box<dyn std::error::Error>;

const PAIRS: usize = 1000;
/// Every so many pairs the exhaustive search for the shortest way is asked.
const JUDGED: usize = 50;

fn main() -> Result<(), Error> {
    for (name, obstacles) in example::cells() {
        let grid = example::grid(2.0)?;
        let mut map = JointMap::new(example::ARM, &grid)?;
        map.set_fixed(&obstacles);
        println!("{name}: {} cells, {} blocked", grid.cells(), map.table().blocked());
        let paths = planning(&grid, &map)?;
        exact(&grid, &map, &obstacles, &paths)?;
        replanning(&grid, &mut map, &paths)?;
    }
    Ok(())
}

fn planning(grid: &Grid, map: &JointMap) -> Result<Vec<Path>, Error> {
    let made = Instant::now();
    let mut planner = Planner::new(grid, map.table())?;
    println!("  planner made in {:.2?}", made.elapsed());
    let mut random = Random(1);
    let (mut times, mut searched, mut ratios, mut paths) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut found, mut none, mut wrong, mut direct, mut corners, mut taken) = (0, 0, 0, 0, 0, 0);
    for n in 0..PAIRS {
        let Some((from, to)) = ends(map, &mut random) else { continue };
        let (start, goal) = (grid.center(from), grid.center(to));
        let clock = Instant::now();
        let path = planner.plan(start, goal, &PlanOptions::default());
        times.push(clock.elapsed());
        if path.as_ref().is_ok_and(|path| path.waypoints.len() > 2) {
            searched.extend(times.last().copied());
        }
        taken = planner.taken().max(taken);
        let Ok(path) = path else {
            none += 1;
            wrong += usize::from(joined(map.table(), from, to));
            continue;
        };
        found += 1;
        direct += usize::from(path.waypoints.len() == 2);
        corners += path.waypoints.len() - 2;
        wrong += usize::from(blocked_point(grid, map.table(), &path.waypoints, 10_000).is_some());
        if n % JUDGED == 0 && path.waypoints.len() > 2 {
            let scale = [0, 1, 2].map(|i| grid.axes()[i].step());
            ratios.extend(grid_optimum(map.table(), scale, from, to).map(|optimum| path.length_rad / optimum));
        }
        paths.push(path);
    }
    println!(
        "  {found} found ({direct} straight), {none} not joined, {wrong} wrong; corners {corners}, most nodes {taken}"
    );
    println!("  time: {}", spread(&mut times));
    println!("  time where it is not straight: {}", spread(&mut searched));
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    println!("  length over the grid optimum, {} not straight: mean {mean:.4}, worst {worst:.4}", ratios.len());
    println!("  memory {:.2} MB", planner.bytes() as f64 / 1e6);
    Ok(paths)
}

/// Every path in the exact scene, and every motion in time.
fn exact(grid: &Grid, map: &JointMap, obstacles: &[Obstacle], paths: &[Path]) -> Result<(), Error> {
    let scene = example::scene(grid, obstacles)?;
    let (mut checker, state) = (Checker::new(&scene, Options::default()), SceneState::new(&scene));
    let planner = Planner::new(grid, map.table())?;
    let joints = MappedJoints { robot: 0, joints: [0, 1, 2] };
    let [velocity, acceleration, jerk] = [[1.5, 1.5, 2.0], [3.0, 3.0, 5.0], [30.0, 30.0, 50.0]].map(Vec::from);
    let limits = MotionLimits { velocity, acceleration, jerk };
    let (mut refused, mut stops, mut checks, mut timings) = (0, 0, Vec::new(), Vec::new());
    for path in paths {
        let clock = Instant::now();
        refused += usize::from(path.check(&mut checker, &state, joints, &SweepOptions::default()).is_err());
        checks.push(clock.elapsed());
        let clock = Instant::now();
        stops += planner.time(path, &limits)?.stops();
        timings.push(clock.elapsed());
    }
    println!("  exact check, {refused} of {} refused: {}", paths.len(), spread(&mut checks));
    println!("  timing, {stops} stops: {}", spread(&mut timings));
    Ok(())
}

/// A ball enters where the wrist will be; the path is mended, and planned anew for comparison.
fn replanning(grid: &Grid, map: &mut JointMap, paths: &[Path]) -> Result<(), Error> {
    let options = PlanOptions::default();
    for radius in [0.05, 0.15] {
        let mut planner = Planner::new(grid, map.table())?;
        let (mut updates, mut mends, mut anews) = (Vec::new(), Vec::new(), Vec::new());
        let (mut shares, mut lengths, mut hows, mut lost, mut unequal) = (Vec::new(), Vec::new(), [0; 3], 0, 0);
        for path in paths.iter().filter(|path| path.length_rad > 1.0).take(300) {
            let middle = halfway(path);
            let wrist = example::ARM.joints_in_base(middle)[2];
            map.set("intruder", &Obstacle::sphere(wrist, radius)?);
            let here = Progress { leg: 0, q: path.waypoints[0] };
            let clock = Instant::now();
            planner.update(map.table())?;
            updates.push(clock.elapsed());
            let goal = path.waypoints[path.waypoints.len() - 1];
            // Whoever comes first finds the caches cold: they take turns.
            let (mended, mend, anew, fresh);
            if hows.iter().sum::<usize>() % 2 == 0 {
                (mended, mend) = timed(|| planner.replan(path, here, &options));
                (anew, fresh) = timed(|| planner.plan(here.q, goal, &options));
            } else {
                (anew, fresh) = timed(|| planner.plan(here.q, goal, &options));
                (mended, mend) = timed(|| planner.replan(path, here, &options));
            }
            unequal += usize::from(mended.is_ok() != anew.is_ok());
            if let (Ok((mended, how)), Ok(anew)) = (mended, anew) {
                hows[how as usize] += 1;
                if how != How::Kept {
                    shares.push(mend.as_secs_f64() / fresh.as_secs_f64());
                    lengths.push(mended.length_rad / anew.length_rad);
                    mends.push(mend);
                    anews.push(fresh);
                }
            } else {
                lost += 1;
            }
            map.remove("intruder");
            planner.update(map.table())?;
        }
        println!(
            "  a ball of {radius} m enters: kept, mended, anew {hows:?}; {lost} without a path, {unequal} unequal"
        );
        println!("    update {}", spread(&mut updates));
        println!("    mend   {}", spread(&mut mends));
        println!("    anew   {}", spread(&mut anews));
        let sum = |times: &[Duration]| times.iter().sum::<Duration>().as_secs_f64();
        shares.sort_by(f64::total_cmp);
        let median = shares.get(shares.len() / 2).copied().unwrap_or_default();
        let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
        let worst = lengths.iter().copied().fold(0.0, f64::max);
        println!(
            "    mend over anew: sum {:.3}, median {median:.3}; length over anew: mean {mean:.3}, worst {worst:.3}",
            sum(&mends) / sum(&anews)
        );
    }
    Ok(())
}

fn timed<T>(ask: impl FnOnce() -> T) -> (T, Duration) {
    let clock = Instant::now();
    let answer = ask();
    (answer, clock.elapsed())
}

/// The configuration at half of the length.
fn halfway(path: &Path) -> [f64; 3] {
    let mut left = 0.5 * path.length_rad;
    for w in path.waypoints.windows(2) {
        let far = (0..3).map(|i| (w[0][i] - w[1][i]).powi(2)).sum::<f64>().sqrt();
        if far >= left {
            return [0, 1, 2].map(|i| w[0][i] + (w[1][i] - w[0][i]) * left / far);
        }
        left -= far;
    }
    path.waypoints[0]
}

fn ends(map: &JointMap, random: &mut Random) -> Option<(Cell, Cell)> {
    free_cell(map.table(), random).zip(free_cell(map.table(), random))
}

/// Median, 99th percentile, largest.
fn spread(times: &mut [Duration]) -> String {
    times.sort_unstable();
    let at =
        |share: f64| times.get((times.len() as f64 * share) as usize).or(times.last()).copied().unwrap_or_default();
    format!("median {:.3?}, p99 {:.3?}, most {:.3?}", at(0.5), at(0.99), at(1.0))
}
