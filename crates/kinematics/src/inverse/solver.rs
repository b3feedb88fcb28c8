//! The solver: closed form first where there is one, then descents from the seed and from elsewhere.

use std::f64::consts::TAU;

use elbowroom_spatial::Pose;

use super::arm::Arm;
use super::damped::{Descent, Scratch};
use super::goal::{PoseGoal, Remainder};
use super::sequence::{quasirandom, window};
use super::wrist::Wrist;
use super::{IkError, Method, Options, Solution, Task};
use crate::{Chain, LinkId};

/// Most steps of [`Solver::refine`].
const REFINE_STEPS: usize = 12;
/// Where the closed form has no answer within the limits, how many starts of the numeric method look for one beside
/// its grid (wrist axes that line up leave a choice that it does not make by the limits).
const STARTS_AFTER_CLOSED_FORM: usize = 12;
/// How far outside its range (rad) a closed-form answer may be and still be drawn in.
const DRAW_IN: f64 = 1e-6;

/// Inverse kinematics of one tip of one chain. Holds what it needs of the chain, and all scratch memory.
#[derive(Clone)]
pub struct Solver {
    arm: Arm,
    wrist: Option<Wrist>,
    options: Options,
    dof: usize,
    scale: f64,
    scratch: Scratch<6>,
    x: Vec<f64>,
}

impl std::fmt::Debug for Solver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solver").field("method", &self.method()).field("options", &self.options).finish_non_exhaustive()
    }
}

/// An answer on its way: values of the arm's variables, and what remains.
struct Found {
    x: Vec<f64>,
    remainder: Remainder,
}

/// The least outside of the answers outside the limits.
struct Outside {
    by: f64,
    variable: usize,
    value: f64,
}

impl Solver {
    /// For the frame `tip_offset` (the tool, or any point of a surface, in the link's frame) on the link `tip`. Looks for a
    /// spherical wrist by itself; where the model does not reproduce the chain, the numeric method is used.
    ///
    /// Limits are those of the independent joints; mimic joints go where their source takes them.
    pub fn new(chain: &Chain, tip: LinkId, tip_offset: Pose, options: Options) -> Self {
        let arm = Arm::new(chain, tip, tip_offset);
        let wrist = if options.task == Task::Pose { Wrist::detect(&arm) } else { None };
        Self {
            wrist,
            options,
            dof: chain.dof(),
            scale: arm.scale(),
            scratch: Scratch::new(&arm),
            x: vec![0.0; arm.variables.len()],
            arm,
        }
    }

    /// The method in use.
    pub fn method(&self) -> Method {
        if self.wrist.is_some() { Method::SphericalWrist } else { Method::Numeric }
    }

    /// An answer within the joint limits for the tip at `target_in_root`, near `seed` (all of the chain's `q`, rad or m):
    /// in closed form the nearest of all, numerically the one that a descent from the seed leads to. Full turns are
    /// taken off or added where that is nearer to the seed and within the limits.
    ///
    /// # Errors
    /// [`IkError::BadInput`] where the seed has the wrong length or something is not finite; else [`IkError::Unreachable`],
    /// [`IkError::Limits`] or [`IkError::NoConvergence`], with what remains.
    pub fn solve(&mut self, target_in_root: &Pose, seed: &[f64]) -> Result<Solution, IkError> {
        self.check(target_in_root, seed)?;
        let start = self.start(seed);
        let mut outside = None;
        if self.wrist.is_some() {
            let found = self.closed_form(target_in_root, &start, 1, &mut outside);
            if let Some(nearest) = found.first() {
                return Ok(self.solution(nearest, seed, 0));
            }
        }
        self.search(target_in_root, seed, &start, outside)
    }

    /// All answers found within the limits, nearest to the seed first; empty where there is none or the input is bad.
    ///
    /// In closed form these are all branches (up to eight), each with the turns nearest to the seed. Numerically they are
    /// the distinct ones that the configured starts lead to, at most 16: for more than six axes a sample of infinitely many.
    pub fn solve_all(&mut self, target_in_root: &Pose, seed: &[f64]) -> Vec<Vec<f64>> {
        if self.check(target_in_root, seed).is_err() || self.beyond_reach(target_in_root) {
            return Vec::new();
        }
        let start = self.start(seed);
        let mut all = Vec::new();
        if self.wrist.is_some() {
            all = self.closed_form(target_in_root, &start, usize::MAX, &mut None);
        }
        if all.is_empty() {
            for index in 0..self.starts() {
                if let Some(found) = self.descend_from(target_in_root, &start, index, true).0
                    && all.iter().all(|known| self.differ(&known.x, &found.x))
                {
                    all.push(found);
                }
                if all.len() == 16 {
                    break;
                }
            }
            all.sort_by(|a, b| squared_distance(&a.x, &start).total_cmp(&squared_distance(&b.x, &start)));
        }
        all.iter().map(|found| self.solution(found, seed, 0).q).collect()
    }

    /// A few steps from a near `q` (all of the chain's values, within the limits), in place; true where the target is met
    /// within the tolerances. Does not allocate. Where false, `q` is as near as the steps led.
    pub fn refine(&mut self, target_in_root: &Pose, q: &mut [f64]) -> bool {
        if self.check(target_in_root, q).is_err() {
            return false;
        }
        let mut x = std::mem::take(&mut self.x);
        for (value, variable) in x.iter_mut().zip(&self.arm.variables) {
            *value = q[variable.q_index];
        }
        let remainder = self.descend(target_in_root, &mut x, true, REFINE_STEPS);
        for (value, variable) in x.iter().zip(&self.arm.variables) {
            q[variable.q_index] = *value;
        }
        self.x = x;
        self.met(&remainder)
    }

    fn check(&self, target: &Pose, seed: &[f64]) -> Result<(), IkError> {
        if seed.len() != self.dof {
            return Err(IkError::BadInput("the seed needs one value per independent joint of the chain"));
        }
        if !seed.iter().all(|v| v.is_finite()) {
            return Err(IkError::BadInput("the seed holds a value that is not finite"));
        }
        if !(target.translation.is_finite() && target.rotation.is_finite()) {
            return Err(IkError::BadInput("the target pose is not finite"));
        }
        Ok(())
    }

    fn start(&self, seed: &[f64]) -> Vec<f64> {
        self.arm.variables.iter().map(|v| seed[v.q_index]).collect()
    }

    fn starts(&self) -> usize {
        let most = if self.wrist.is_some() { STARTS_AFTER_CLOSED_FORM } else { usize::MAX };
        self.options.restarts.clamp(1, most)
    }

    /// From `x` downhill; what remains at the best point, which `x` then is.
    fn descend(&mut self, target: &Pose, x: &mut [f64], bounded: bool, iterations: usize) -> Remainder {
        let goal = PoseGoal { target: *target, task: self.options.task, scale: self.scale };
        let scratch = &mut self.scratch;
        let tip = Descent { arm: &self.arm, goal: &goal, scale: self.scale, bounded, scratch }.run(x, iterations);
        Remainder::between(&tip, target)
    }

    fn remainder(&mut self, target: &Pose, x: &[f64]) -> Remainder {
        Remainder::between(&self.scratch.tip_in_root(&self.arm, x), target)
    }

    fn met(&self, r: &Remainder) -> bool {
        r.position_m() <= self.options.position_tolerance_m
            && (self.options.task == Task::Position || r.angle_rad() <= self.options.angle_tolerance_rad)
    }

    fn beyond_reach(&self, target: &Pose) -> bool {
        let base = self.arm.segments.first().map_or(self.arm.tip_in_last.translation, |s| s.origin.translation);
        target.translation.distance(base) > self.arm.reach * (1.0 + 1e-12) + self.options.position_tolerance_m
    }

    fn solution(&self, found: &Found, seed: &[f64], restarts: usize) -> Solution {
        let mut q = seed.to_vec();
        for (value, variable) in found.x.iter().zip(&self.arm.variables) {
            q[variable.q_index] = *value;
        }
        Solution {
            q,
            position_error_m: found.remainder.position_m(),
            angle_error_rad: found.remainder.angle_rad(),
            restarts,
        }
    }

    /// The `most` nearest closed-form answers within the limits, polished on the chain, nearest first.
    fn closed_form(&mut self, target: &Pose, start: &[f64], most: usize, outside: &mut Option<Outside>) -> Vec<Found> {
        let Some(wrist) = &self.wrist else { return Vec::new() };
        // The library takes turns off one by one: hand it none.
        let seed: [f64; 6] = std::array::from_fn(|i| start[i] % TAU);
        let mut within: Vec<[f64; 6]> = Vec::with_capacity(8);
        for mut x in wrist.candidates(target, &seed) {
            match self.unwind(&mut x, start) {
                None => within.push(x),
                Some(beyond) if outside.as_ref().is_none_or(|o| beyond.by < o.by) => *outside = Some(beyond),
                Some(_) => {}
            }
        }
        within.sort_by(|a, b| squared_distance(a, start).total_cmp(&squared_distance(b, start)));
        let mut found: Vec<Found> = Vec::with_capacity(most.min(within.len()));
        for mut x in within {
            let remainder = self.descend(target, &mut x, true, REFINE_STEPS);
            if self.met(&remainder) && found.iter().all(|known| self.differ(&known.x, &x)) {
                found.push(Found { x: x.to_vec(), remainder });
            }
            if found.len() >= most {
                break;
            }
        }
        found
    }

    /// Adds and takes off full turns until every joint is as near to `start` as its limits allow. Returns the joint that
    /// is farthest outside where that cannot be.
    fn unwind(&self, x: &mut [f64], start: &[f64]) -> Option<Outside> {
        let mut worst: Option<Outside> = None;
        for (i, variable) in self.arm.variables.iter().enumerate() {
            if variable.wraps {
                x[i] = nearest_turn(x[i], start[i], variable.lower, variable.upper);
            }
            let by = (variable.lower - x[i]).max(x[i] - variable.upper);
            if by > DRAW_IN && worst.as_ref().is_none_or(|w| by > w.by) {
                worst = Some(Outside { by, variable: i, value: x[i] });
            }
        }
        worst
    }

    /// Starting point `index` (0 is the seed itself), then downhill.
    fn descend_from(
        &mut self,
        target: &Pose,
        start: &[f64],
        index: usize,
        bounded: bool,
    ) -> (Option<Found>, Remainder) {
        let mut x = if index == 0 { start.to_vec() } else { self.spread(index) };
        let iterations = self.options.iterations;
        let remainder = self.descend(target, &mut x, bounded, iterations);
        if !self.met(&remainder) {
            return (None, remainder);
        }
        // Met, but perhaps slowly (at a bound, or where axes line up): the last digits are cheap.
        self.descend(target, &mut x, bounded, iterations);
        let mut unwound = x.clone();
        if self.unwind(&mut unwound, start).is_none() || !bounded {
            // Draws in what the turns left outside by rounding.
            let remainder = self.descend(target, &mut unwound, bounded, REFINE_STEPS);
            if self.met(&remainder) {
                return (Some(Found { x: unwound, remainder }), remainder);
            }
        }
        let remainder = self.remainder(target, &x);
        (Some(Found { x, remainder }), remainder)
    }

    fn spread(&self, index: usize) -> Vec<f64> {
        let n = self.arm.variables.len();
        let point = |(i, v): (usize, &super::arm::Variable)| {
            let (lo, hi) = window(v.lower, v.upper, v.turns, self.scale * 2.0);
            lo + (hi - lo) * quasirandom(index, i, n)
        };
        self.arm.variables.iter().enumerate().map(point).collect()
    }

    fn search(
        &mut self,
        target: &Pose,
        seed: &[f64],
        start: &[f64],
        outside: Option<Outside>,
    ) -> Result<Solution, IkError> {
        let mut closest = self.remainder(target, start);
        if self.beyond_reach(target) {
            return Err(unreachable(&closest));
        }
        let starts = self.starts();
        for index in 0..starts {
            let (found, remainder) = self.descend_from(target, start, index, true);
            if let Some(found) = found {
                return Ok(self.solution(&found, seed, index));
            }
            if self.weight(&remainder) < self.weight(&closest) {
                closest = remainder;
            }
        }
        let outside = outside.or_else(|| self.search_outside(target, start));
        match outside {
            Some(o) => {
                let v = &self.arm.variables[o.variable];
                Err(IkError::Limits { joint: v.name.clone(), value: o.value, lower: v.lower, upper: v.upper })
            }
            None if self.wrist.is_some() => Err(unreachable(&closest)),
            None => Err(IkError::NoConvergence {
                position_error_m: closest.position_m(),
                angle_error_rad: closest.angle_rad(),
                restarts: starts,
            }),
        }
    }

    /// Whether the target could be met if there were no limits: tells a user which joint is in the way.
    fn search_outside(&mut self, target: &Pose, start: &[f64]) -> Option<Outside> {
        if self.wrist.is_some() {
            return None;
        }
        (0..8).find_map(|index| {
            let found = self.descend_from(target, start, index, false).0?;
            let mut x = found.x;
            self.unwind(&mut x, start)
        })
    }

    fn weight(&self, r: &Remainder) -> f64 {
        r.position_m() / self.scale + if self.options.task == Task::Pose { r.angle_rad() } else { 0.0 }
    }

    /// Full turns do not make two answers different.
    fn differ(&self, a: &[f64], b: &[f64]) -> bool {
        self.arm.variables.iter().enumerate().any(|(i, v)| {
            let delta = a[i] - b[i];
            let delta = if v.wraps { delta - TAU * (delta / TAU).round() } else { delta };
            delta.abs() > 1e-6
        })
    }
}

fn unreachable(closest: &Remainder) -> IkError {
    IkError::Unreachable { position_error_m: closest.position_m(), angle_error_rad: closest.angle_rad() }
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// `angle` plus the whole turns that bring it nearest to `near` within the bounds; nearest of all where none is within.
fn nearest_turn(angle: f64, near: f64, lower: f64, upper: f64) -> f64 {
    let nearest = angle + TAU * ((near - angle) / TAU).round();
    // A turn on each side of the nearest, and those next to either bound, hold the best one within the bounds.
    let at_lower = if lower.is_finite() { angle + TAU * ((lower - DRAW_IN - angle) / TAU).ceil() } else { nearest };
    let at_upper = if upper.is_finite() { angle + TAU * ((upper + DRAW_IN - angle) / TAU).floor() } else { nearest };
    let inside = |v: &f64| *v >= lower - DRAW_IN && *v <= upper + DRAW_IN;
    let gap = |v: &f64| (v - near).abs();
    [nearest, at_lower, at_upper].into_iter().filter(inside).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or_else(
        || {
            let out = |v: &f64| (lower - v).max(v - upper);
            [nearest, at_lower, at_upper].into_iter().min_by(|a, b| out(a).total_cmp(&out(b))).unwrap_or(angle)
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn turns_are_chosen_near_and_within() {
        let inf = f64::INFINITY;
        assert!((nearest_turn(0.5, 100.0, -inf, inf) - (0.5 + 16.0 * TAU)).abs() < 1e-12);
        assert_eq!(nearest_turn(0.5 - TAU, 0.0, -PI, PI), 0.5);
        assert_eq!(nearest_turn(3.0, -3.0, -PI, PI), 3.0); // -3.28 is nearer, but outside
        assert_eq!(nearest_turn(3.0, -3.0, -4.0, 4.0), 3.0 - TAU);
        assert_eq!(nearest_turn(2.0, 0.0, -1.0, 1.0), 2.0); // nowhere within: least outside
    }
}
