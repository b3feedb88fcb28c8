//! The solver: uses the closed form if possible, then numeric searches from the seed and from other starting points.

use std::f64::consts::TAU;

use elbowroom_spatial::Pose;

use super::arm::{Arm, ArmVariable};
use super::arm_configuration::ArmConfiguration;
use super::error::IkError;
use super::levenberg_marquardt::{LevenbergMarquardt, LmWorkspace};
use super::options::{IkMethod, IkOptions, IkTask};
use super::pose_goal::{PoseError, PoseGoal};
use super::sequence::{quasirandom, window};
use super::solution::IkSolution;
use super::spherical_wrist::SphericalWrist;
use crate::{Chain, LinkId};

/// Largest number of steps of [`IkSolver::refine`].
const REFINE_STEPS: usize = 12;
/// Starts of the numeric method if the closed form has no solution within the limits. Aligned wrist axes leave a
/// choice that the closed form makes without regard to the limits.
const STARTS_AFTER_CLOSED_FORM: usize = 12;
/// Starts of the search for the closest pose if the target is beyond reach.
const STARTS_BEYOND_REACH: usize = 8;
/// Largest violation of a limit (rad) by a closed-form solution that is still refined into the range.
const LIMIT_SLACK: f64 = 1e-6;

/// Inverse kinematics of one tip of one chain. Contains its data of the chain and its workspace.
#[derive(Clone)]
pub struct IkSolver {
    arm: Arm,
    wrist: Option<SphericalWrist>,
    options: IkOptions,
    dof: usize,
    scale: f64,
    workspace: LmWorkspace<6>,
    x: Vec<f64>,
}

impl std::fmt::Debug for IkSolver {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("IkSolver")
            .field("method", &self.method())
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

/// A candidate solution: values of the arm's variables, and the remaining error.
struct Candidate {
    x: Vec<f64>,
    error: PoseError,
}

/// The worst limit violation of a solution outside the limits.
struct LimitViolation {
    by: f64,
    variable: usize,
    value: f64,
}

impl IkSolver {
    /// Creates a solver for the frame `tip_offset` on the link `tip`: the tool, or any point of a surface, in the link's
    /// frame (m).
    ///
    /// Detects a spherical wrist; if the closed-form model does not reproduce the chain, the numeric method is used. The
    /// limits of the independent joints apply; mimic joints follow them.
    pub fn new(chain: &Chain, tip: LinkId, tip_offset: Pose, options: IkOptions) -> Self {
        let arm = Arm::new(chain, tip, tip_offset);
        let wrist = if options.task == IkTask::Pose { SphericalWrist::detect(&arm) } else { None };
        Self {
            wrist,
            options,
            dof: chain.dof(),
            scale: arm.scale(),
            workspace: LmWorkspace::new(&arm),
            x: vec![0.0; arm.variables.len()],
            arm,
        }
    }

    /// The method used.
    pub fn method(&self) -> IkMethod {
        if self.wrist.is_some() { IkMethod::SphericalWrist } else { IkMethod::Numeric }
    }

    /// The branch that `q` (all of the chain's values) belongs to; `None` if the arm has no spherical wrist, or if `q`
    /// has another length or is not finite.
    pub fn configuration(&self, q: &[f64]) -> Option<ArmConfiguration> {
        if q.len() != self.dof || !q.iter().all(|v| v.is_finite()) {
            return None;
        }
        let x = self.start(q);
        self.wrist.as_ref()?.configuration(&self.arm, x.as_slice().try_into().ok()?)
    }

    /// Finds a solution within the joint limits for the tip at `target_in_root`, near `seed` (all of the chain's `q`,
    /// rad or m).
    ///
    /// In closed form it is the nearest of all solutions, numerically the one to which the search from the seed
    /// converges. Full turns are added or subtracted if the result is nearer to the seed and within the limits.
    ///
    /// # Errors
    /// [`IkError::SeedLength`], [`IkError::SeedNotFinite`] or [`IkError::TargetNotFinite`] for invalid input; otherwise
    /// [`IkError::Unreachable`], [`IkError::Limits`] or [`IkError::NoConvergence`], with the remaining error.
    pub fn solve(&mut self, target_in_root: &Pose, seed: &[f64]) -> Result<IkSolution, IkError> {
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

    /// All solutions found within the limits, nearest to the seed first; empty if none is found or the input is invalid.
    ///
    /// In closed form these are all branches (up to eight), each with the turns nearest to the seed. Numerically they
    /// are the distinct solutions to which the configured starts converge, at most 16; for more than six axes this is a
    /// sample of infinitely many.
    pub fn solve_all(&mut self, target_in_root: &Pose, seed: &[f64]) -> Vec<Vec<f64>> {
        if self.check(target_in_root, seed).is_err() || self.beyond_reach(target_in_root) {
            return Vec::new();
        }
        let start = self.start(seed);
        let mut all = Vec::new();
        if self.wrist.is_some() {
            all = self.closed_form(target_in_root, &start, usize::MAX, &mut None);
        }
        if all.is_empty() && !self.is_proven_out_of_reach(target_in_root, &start) {
            for index in 0..self.starts() {
                if let Some(found) = self.minimize_from(target_in_root, &start, index, true).0
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

    /// Refines a nearby `q` (all of the chain's values, within the limits) by a few steps, in place. Does not allocate.
    ///
    /// Returns true if the target is met within the tolerances; otherwise `q` is the best result of the steps.
    pub fn refine(&mut self, target_in_root: &Pose, q: &mut [f64]) -> bool {
        if self.check(target_in_root, q).is_err() {
            return false;
        }
        let mut x = std::mem::take(&mut self.x);
        for (value, variable) in x.iter_mut().zip(&self.arm.variables) {
            *value = q[variable.q_index];
        }
        let error = self.minimize(target_in_root, &mut x, true, REFINE_STEPS);
        for (value, variable) in x.iter().zip(&self.arm.variables) {
            q[variable.q_index] = *value;
        }
        self.x = x;
        self.met(&error)
    }

    fn check(&self, target: &Pose, seed: &[f64]) -> Result<(), IkError> {
        if seed.len() != self.dof {
            return Err(IkError::SeedLength);
        }
        if !seed.iter().all(|v| v.is_finite()) {
            return Err(IkError::SeedNotFinite);
        }
        if !(target.translation.is_finite() && target.rotation.is_finite()) {
            return Err(IkError::TargetNotFinite);
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

    /// Improves `x`; returns the remaining error.
    fn minimize(&mut self, target: &Pose, x: &mut [f64], bounded: bool, iterations: usize) -> PoseError {
        let goal = PoseGoal { target: *target, task: self.options.task, scale: self.scale };
        let workspace = &mut self.workspace;
        let tip = LevenbergMarquardt { arm: &self.arm, goal: &goal, scale: self.scale, bounded, workspace }
            .run(x, iterations);
        PoseError::between(&tip, target)
    }

    fn pose_error(&mut self, target: &Pose, x: &[f64]) -> PoseError {
        PoseError::between(&self.workspace.tip_in_root(&self.arm, x), target)
    }

    fn met(&self, r: &PoseError) -> bool {
        r.position_m() <= self.options.position_tolerance_m
            && (self.options.task == IkTask::Position || r.angle_rad() <= self.options.angle_tolerance_rad)
    }

    fn beyond_reach(&self, target: &Pose) -> bool {
        let base = self.arm.joints.first().map_or(self.arm.tip_in_last.translation, |j| j.origin.translation);
        target.translation.distance(base) > self.arm.reach * (1.0 + 1e-12) + self.options.position_tolerance_m
    }

    fn solution(&self, found: &Candidate, seed: &[f64], restarts: usize) -> IkSolution {
        let mut q = seed.to_vec();
        for (value, variable) in found.x.iter().zip(&self.arm.variables) {
            q[variable.q_index] = *value;
        }
        IkSolution { q, position_error_m: found.error.position_m(), angle_error_rad: found.error.angle_rad(), restarts }
    }

    /// The `most` nearest closed-form solutions within the limits, refined on the chain, nearest first.
    fn closed_form(
        &mut self,
        target: &Pose,
        start: &[f64],
        most: usize,
        outside: &mut Option<LimitViolation>,
    ) -> Vec<Candidate> {
        let Some(wrist) = &self.wrist else {
            return Vec::new();
        };
        // The library subtracts turns one by one, so the seed is passed without full turns.
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
        let mut found: Vec<Candidate> = Vec::with_capacity(most.min(within.len()));
        for mut x in within {
            let error = self.minimize(target, &mut x, true, REFINE_STEPS);
            if self.met(&error) && found.iter().all(|known| self.differ(&known.x, &x)) {
                found.push(Candidate { x: x.to_vec(), error });
            }
            if found.len() >= most {
                break;
            }
        }
        found
    }

    /// Whether the closed form proves that there is no solution, although it is that of a model: every candidate is farther beyond a
    /// limit than a solution can be away from it.
    fn is_proven_out_of_reach(&self, target: &Pose, start: &[f64]) -> bool {
        let Some(wrist) = self.wrist.as_ref().filter(|wrist| wrist.is_regular(target)) else { return false };
        let seed: [f64; 6] = std::array::from_fn(|i| start[i] % TAU);
        wrist.candidates(target, &seed).iter_mut().all(|x| {
            self.unwind(x, start);
            let beyond = |joints: std::ops::Range<usize>| {
                joints.clone().zip(&self.arm.variables[joints]).any(|(i, variable)| {
                    (variable.lower - x[i]).max(x[i] - variable.upper) > wrist.largest_difference()
                })
            };
            beyond(0..3) || beyond(3..6) && wrist.is_turned(x)
        })
    }

    /// Adds and subtracts full turns until every joint is as near to `start` as its limits allow. Returns the worst
    /// violation if a joint stays outside its limits.
    fn unwind(&self, x: &mut [f64], start: &[f64]) -> Option<LimitViolation> {
        let mut worst: Option<LimitViolation> = None;
        for (i, variable) in self.arm.variables.iter().enumerate() {
            if variable.wraps {
                x[i] = nearest_turn(x[i], start[i], variable.lower, variable.upper);
            }
            let by = (variable.lower - x[i]).max(x[i] - variable.upper);
            if by > LIMIT_SLACK && worst.as_ref().is_none_or(|w| by > w.by) {
                worst = Some(LimitViolation { by, variable: i, value: x[i] });
            }
        }
        worst
    }

    /// A search from starting point `index` (0 is the seed itself).
    fn minimize_from(
        &mut self,
        target: &Pose,
        start: &[f64],
        index: usize,
        bounded: bool,
    ) -> (Option<Candidate>, PoseError) {
        let mut x = if index == 0 { start.to_vec() } else { self.sample(index) };
        let iterations = self.options.iterations;
        let error = self.minimize(target, &mut x, bounded, iterations);
        if !self.met(&error) {
            return (None, error);
        }
        // Convergence may have been slow (at a bound, or with aligned axes): a second run gains the last digits.
        self.minimize(target, &mut x, bounded, iterations);
        let mut unwound = x.clone();
        if self.unwind(&mut unwound, start).is_none() || !bounded {
            // Corrects violations from the rounding of the turns.
            let error = self.minimize(target, &mut unwound, bounded, REFINE_STEPS);
            if self.met(&error) {
                return (Some(Candidate { x: unwound, error }), error);
            }
        }
        let error = self.pose_error(target, &x);
        (Some(Candidate { x, error }), error)
    }

    fn sample(&self, index: usize) -> Vec<f64> {
        let n = self.arm.variables.len();
        let point = |(i, v): (usize, &ArmVariable)| {
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
        outside: Option<LimitViolation>,
    ) -> Result<IkSolution, IkError> {
        let mut closest = self.pose_error(target, start);
        let beyond_reach = self.beyond_reach(target);
        let starts = if beyond_reach { self.starts().min(STARTS_BEYOND_REACH) } else { self.starts() };
        for index in 0..starts {
            let (found, error) = self.minimize_from(target, start, index, true);
            if let Some(found) = found {
                return Ok(self.solution(&found, seed, index));
            }
            if self.weight(&error) < self.weight(&closest) {
                closest = error;
            }
        }
        if beyond_reach {
            return Err(unreachable(&closest));
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

    /// The limit violation of a solution without limits, if one is found; for an error that names the limiting joint.
    fn search_outside(&mut self, target: &Pose, start: &[f64]) -> Option<LimitViolation> {
        if self.wrist.is_some() {
            return None;
        }
        (0..8).find_map(|index| {
            let found = self.minimize_from(target, start, index, false).0?;
            let mut x = found.x;
            self.unwind(&mut x, start)
        })
    }

    fn weight(&self, r: &PoseError) -> f64 {
        r.position_m() / self.scale + if self.options.task == IkTask::Pose { r.angle_rad() } else { 0.0 }
    }

    /// True if two solutions differ by more than full turns.
    fn differ(&self, a: &[f64], b: &[f64]) -> bool {
        self.arm.variables.iter().enumerate().any(|(i, v)| {
            let delta = a[i] - b[i];
            let delta = if v.wraps { delta - TAU * (delta / TAU).round() } else { delta };
            delta.abs() > 1e-6
        })
    }
}

fn unreachable(closest: &PoseError) -> IkError {
    IkError::Unreachable { position_error_m: closest.position_m(), angle_error_rad: closest.angle_rad() }
}

fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// `angle` plus the whole turns that bring it nearest to `near` within the bounds; if none is within, least outside
/// them.
fn nearest_turn(angle: f64, near: f64, lower: f64, upper: f64) -> f64 {
    let nearest = angle + TAU * ((near - angle) / TAU).round();
    // The best value within the bounds is the nearest one, or the first one inside either bound.
    let at_lower = if lower.is_finite() { angle + TAU * ((lower - LIMIT_SLACK - angle) / TAU).ceil() } else { nearest };
    let at_upper =
        if upper.is_finite() { angle + TAU * ((upper + LIMIT_SLACK - angle) / TAU).floor() } else { nearest };
    let inside = |v: &f64| *v >= lower - LIMIT_SLACK && *v <= upper + LIMIT_SLACK;
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
