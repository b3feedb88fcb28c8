//! Replanning while the arm moves: change of path without a stop, by an entry in motion ([`motion_entry`](crate::motion_entry)).

use std::time::Duration;

use elbowroom_cspace::Grid;
use elbowroom_planner::{
    GridPlanner, GridPlannerSettings, KinematicLimits, Path, PathProgress, ReplanKind, Trajectory,
};
use elbowroom_vision::Stopwatch;

use crate::free_arc::free_arc_rad;
use crate::motion_entry::{acceleration_distance, first_root};
use crate::path_execution::{PathExecution, distance, state_at};

/// The arm enters the new path where that passes its configuration within this distance, rad.
const ENTRY_DISTANCE_RAD: f64 = 1e-6;
/// The rate at the entry may exceed 1 by this much, which is rounding; it is then 1.
const RATE_ROUNDING: f64 = 1e-6;
/// A slower arm has no direction of motion, rad/s.
const MIN_SPEED_RAD_S: f64 = 1e-9;

/// Settings of [`replan_in_motion`].
pub(super) struct InMotionSettings<'a> {
    pub limits: &'a KinematicLimits,
    pub planner: &'a GridPlannerSettings,
    pub grid: &'a Grid,
}

/// Result of [`replan_in_motion`].
#[derive(Default)]
pub(super) struct InMotionReplan {
    /// The motion that continues from the old one, and how its path was found; `None` where the arm must stop first.
    pub found: Option<(PathExecution, ReplanKind)>,
    /// Wall-clock time of repairing and replanning.
    pub replan: Duration,
    /// Wall-clock time of the time parametrization.
    pub timing: Duration,
}

/// A timed path that the arm can enter in motion.
struct Candidate {
    /// Time from the entry to the end, seconds.
    remaining_s: f64,
    /// Time of the trajectory at the entry, seconds.
    entry_s: f64,
    path: Path,
    trajectory: Trajectory,
    kind: ReplanKind,
}

/// Replaces the path of an arm in motion. The times are measured in either case.
pub(super) fn replan_in_motion(
    planner: &mut GridPlanner,
    old: &PathExecution,
    settings: &InMotionSettings<'_>,
) -> InMotionReplan {
    let mut result = InMotionReplan::default();
    let found = find_replacement(planner, old, settings, &mut result);
    InMotionReplan { found, ..result }
}

fn find_replacement(
    planner: &mut GridPlanner,
    old: &PathExecution,
    settings: &InMotionSettings<'_>,
    result: &mut InMotionReplan,
) -> Option<(PathExecution, ReplanKind)> {
    let mut stopwatch = Stopwatch::start();
    let state = old.state();
    let segment = old.segment()?;
    let speed = norm(state.qd) * old.rate;
    let along = unit(state.qd)?;
    let back_rad = acceleration_distance(speed, &along, settings.limits);
    let here = PathProgress { segment, q: state.q };
    // Both lengths are unweighted: a weighted free length could exceed the stopping distance although the path is blocked
    // before the arm can leave it.
    if free_arc_rad(planner, &old.path, here).ok()?.is_some_and(|free_rad| free_rad <= back_rad) {
        return None;
    }
    let (ahead, branch) = advance_along(&old.path, here, back_rad)?;
    let repaired = planner.replan(&old.path, branch, settings.planner);
    let goal = old.path.waypoints.last().copied()?;
    let replanned = planner.plan(branch.q, goal, settings.planner).map(|path| (path, ReplanKind::Replanned));
    result.replan = stopwatch.lap();
    let behind = [0, 1, 2].map(|i| state.q[i] - along[i] * back_rad);
    // A path that is repaired repeatedly degrades, and a new one often branches off slowly: take the faster one.
    let mut best: Option<Candidate> = None;
    for (rest, kind) in [repaired, replanned].into_iter().flatten() {
        if rest.start_moved_rad > 0.0 || rest.goal_moved_rad > 0.0 {
            continue;
        }
        let waypoints = std::iter::once(behind).chain(ahead.iter().copied()).chain(rest.waypoints).collect();
        let path = Path { waypoints, ..rest };
        let Ok(trajectory) = planner.time_parametrize(&path, settings.limits) else { continue };
        let reached = |tau: f64| dot(sub(state_at(&trajectory, tau).q, behind), along) - back_rad;
        let Some(entry_s) = first_root(reached, trajectory.seconds()) else { continue };
        let remaining_s = trajectory.seconds() - entry_s;
        if best.as_ref().is_none_or(|best| remaining_s < best.remaining_s) {
            best = Some(Candidate { remaining_s, entry_s, path, trajectory, kind });
        }
    }
    result.timing = stopwatch.lap();
    let Candidate { entry_s, path, trajectory, kind, .. } = best?;
    let entry = state_at(&trajectory, entry_s);
    let rate = speed / norm(entry.qd);
    let is_near = distance(entry.q, state.q) < ENTRY_DISTANCE_RAD;
    let is_smooth = is_near && rate <= 1.0 + RATE_ROUNDING && dot(entry.qd, along) > 0.0;
    let execution = || PathExecution::new(path, trajectory, entry_s, rate.min(1.0), settings.grid, settings.limits);
    is_smooth.then(|| (execution(), kind))
}

/// Moves `left` rad along a path: the waypoints passed, and the point reached.
fn advance_along(path: &Path, here: PathProgress, mut left: f64) -> Option<(Vec<[f64; 3]>, PathProgress)> {
    let (mut corners, mut at) = (Vec::new(), here.q);
    for segment in here.segment..path.waypoints.len().saturating_sub(1) {
        let to = path.waypoints[segment + 1];
        let length = distance(at, to);
        if length > left {
            let t = left / length;
            return Some((corners, PathProgress { segment, q: [0, 1, 2].map(|i| at[i] + (to[i] - at[i]) * t) }));
        }
        left -= length;
        corners.push(to);
        at = to;
    }
    None
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = norm(a);
    (length > MIN_SPEED_RAD_S).then(|| a.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use elbowroom_cspace::{GridAxis, OccupancyBitmap, RowSpan};

    use super::*;

    /// An arm in the middle of a straight motion along the first joint; cells of `blocked` (first joint, second joint)
    /// become blocked for all values of the third.
    fn replan(weights: [f64; 3], blocked: [std::ops::Range<u32>; 2]) -> Option<(PathExecution, ReplanKind)> {
        let axis = |name| GridAxis::new(name, 0.0, 3.0, 0.05);
        let grid = Grid::new([axis("a").unwrap(), axis("b").unwrap(), axis("c").unwrap()]).unwrap();
        let mut occupancy = OccupancyBitmap::new(grid.shape());
        let mut planner = GridPlanner::new(&grid, &occupancy).unwrap();
        let planner_settings = GridPlannerSettings { weights, ..GridPlannerSettings::DEFAULT };
        let limits = KinematicLimits { velocity: vec![1.0; 3], acceleration: vec![2.0; 3], jerk: vec![20.0; 3] };
        let path = planner.plan([0.12, 1.52, 1.52], [2.88, 1.52, 1.52], &planner_settings).unwrap();
        let trajectory = planner.time_parametrize(&path, &limits).unwrap();
        let middle_s = 0.5 * trajectory.seconds();
        let motion = PathExecution::new(path, trajectory, middle_s, 1.0, &grid, &limits);
        assert!((motion.state().q[0] - 1.5).abs() < 1e-6 && (motion.state().qd[0] - 1.0).abs() < 1e-6);
        let [a, b] = blocked;
        for (i, j) in a.flat_map(|i| b.clone().map(move |j| (i, j))) {
            occupancy.block(RowSpan { row: i * 60 + j, first: 0, last: 59 });
        }
        planner.update(&occupancy).unwrap();
        let settings = InMotionSettings { limits: &limits, planner: &planner_settings, grid: &grid };
        replan_in_motion(&mut planner, &motion, &settings).found
    }

    /// The arm cannot stop before a wall at 1.65 rad; the configuration where it could leave its path is behind the wall.
    #[test]
    fn no_path_is_found_through_a_wall_nearer_than_the_stop_whatever_the_weights() {
        for weight in [0.1, 1.0, 4.0, 100.0] {
            assert!(replan([weight; 3], [33..35, 0..60]).is_none(), "{weight}");
        }
    }

    /// An obstacle at 2.2 rad that can be bypassed.
    #[test]
    fn a_bypass_behind_the_stop_is_found_whatever_the_weights() {
        for weight in [0.1, 1.0, 4.0, 100.0] {
            let found = replan([weight; 3], [44..46, 28..33]);
            assert!(found.is_some_and(|(_, kind)| kind != ReplanKind::Kept), "{weight}");
        }
    }
}
