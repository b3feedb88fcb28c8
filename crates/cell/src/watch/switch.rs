//! From one path to another without stopping.
//!
//! A trajectory begins at rest. So the new one begins so far *behind* the arm, on the straight stretch that the arm is
//! on, that where the arm is it is at least as fast as the arm; and it leaves that stretch so far ahead that the arm
//! could stop before. Entered in the middle, at the rate at which both are equally fast, it goes on from the old one
//! without a jump in place, direction or speed.

use std::time::Duration;

use elbowroom_cspace::Grid;
use elbowroom_planner::{How, MotionLimits, Path, PlanOptions, Planner, Progress, Standing, Trajectory};

use super::motion::{Motion, distance, state_at};
use super::times::Clock;

/// What [`reroute`] goes by.
pub(super) struct Bounds<'a> {
    pub limits: &'a MotionLimits,
    pub options: &'a PlanOptions,
    pub grid: &'a Grid,
}

/// A motion that goes on from another, and how its path came about; `None` where the arm must stop first. The time that
/// planning and timing took is told in either case.
pub(super) fn reroute(
    planner: &mut Planner,
    old: &Motion,
    bounds: &Bounds<'_>,
) -> (Option<(Motion, How)>, [Duration; 2]) {
    let mut times = [Duration::ZERO; 2];
    (try_reroute(planner, old, bounds, &mut times), times)
}

fn try_reroute(
    planner: &mut Planner,
    old: &Motion,
    bounds: &Bounds<'_>,
    times: &mut [Duration; 2],
) -> Option<(Motion, How)> {
    let mut clock = Clock::start();
    let state = old.state();
    let leg = old.leg()?;
    let speed = norm(state.qd) * old.rate;
    let along = unit(state.qd)?;
    let back_rad = stretch(speed, along, bounds.limits);
    let here = Progress { leg, q: state.q };
    if let Standing::Blocked { free_rad, .. } = planner.standing(&old.path, here, bounds.options).ok()?
        && free_rad <= back_rad
    {
        return None;
    }
    let (ahead, branch) = walk(&old.path, here, back_rad)?;
    let mended = planner.replan(&old.path, branch, bounds.options);
    let goal = old.path.waypoints.last().copied()?;
    let anew = planner.plan(branch.q, goal, bounds.options).map(|path| (path, How::Anew));
    times[0] = clock.lap();
    let behind = [0, 1, 2].map(|i| state.q[i] - along[i] * back_rad);
    // Mended again and again a path becomes a bad one, a new one is often slow to leave the old: the faster of the two.
    let mut best: Option<(f64, f64, Path, Trajectory, How)> = None;
    for (rest, how) in [mended, anew].into_iter().flatten() {
        if rest.start_moved_rad > 0.0 || rest.goal_moved_rad > 0.0 {
            continue;
        }
        let waypoints = std::iter::once(behind).chain(ahead.iter().copied()).chain(rest.waypoints).collect();
        let path = Path { waypoints, ..rest };
        let Ok(trajectory) = planner.time(&path, bounds.limits) else { continue };
        let reached = |tau: f64| dot(sub(state_at(&trajectory, tau).q, behind), along) - back_rad;
        let Some(tau_s) = first_root(reached, trajectory.seconds()) else { continue };
        let left_s = trajectory.seconds() - tau_s;
        if best.as_ref().is_none_or(|(best_s, ..)| left_s < *best_s) {
            best = Some((left_s, tau_s, path, trajectory, how));
        }
    }
    times[1] = clock.lap();
    let (_, tau_s, path, trajectory, how) = best?;
    let met = state_at(&trajectory, tau_s);
    let rate = speed / norm(met.qd);
    let is_smooth = distance(met.q, state.q) < 1e-6 && rate <= 1.0 + 1e-6 && dot(met.qd, along) > 0.0;
    let motion = || Motion::new(path, trajectory, tau_s, rate.min(1.0), bounds.grid, bounds.limits);
    is_smooth.then(|| (motion(), how))
}

/// The way in which a speed along a direction can be reached from rest, and lost again, with some to spare.
fn stretch(speed: f64, along: [f64; 3], limits: &MotionLimits) -> f64 {
    let least = |of: &[f64]| (0..3).map(|i| of[i] / along[i].abs().max(1e-12)).fold(f64::INFINITY, f64::min);
    let (a, j) = (least(&limits.acceleration), least(&limits.jerk));
    let seconds = if speed >= a * a / j { speed / a + a / j } else { 2.0 * (speed / j).sqrt() };
    0.5 * speed * seconds * 1.05 + 1e-3
}

/// So far along a path: the corners on the way, and the place.
fn walk(path: &Path, here: Progress, mut left: f64) -> Option<(Vec<[f64; 3]>, Progress)> {
    let (mut corners, mut at) = (Vec::new(), here.q);
    for leg in here.leg..path.waypoints.len().saturating_sub(1) {
        let to = path.waypoints[leg + 1];
        let length = distance(at, to);
        if length > left {
            let t = left / length;
            return Some((corners, Progress { leg, q: [0, 1, 2].map(|i| at[i] + (to[i] - at[i]) * t) }));
        }
        left -= length;
        corners.push(to);
        at = to;
    }
    None
}

/// Where a function that rises from below 0 reaches 0 first, in steps of 4 ms and then by halves.
fn first_root(value: impl Fn(f64) -> f64, end: f64) -> Option<f64> {
    let mut low = 0.0;
    let mut high = low;
    while value(high) < 0.0 {
        low = high;
        high += 0.004;
        if low > end {
            return None;
        }
    }
    for _ in 0..50 {
        let middle = f64::midpoint(low, high);
        if value(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
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
    (length > 1e-9).then(|| a.map(|x| x / length))
}
