//! Search for joint values that bring the point to its target.

use std::f64::consts::TAU;

use elbowroom_spatial::{Pose, Vec3};

use super::error::PointError;
use super::goal::{PositionGoal, SurfaceGoal, angle_between};
use super::options::SurfaceIkSolution;
use super::oriented_point::OrientedPoint;
use super::point_chain::PointChain;
use crate::inverse::arm::ArmVariable;
use crate::inverse::levenberg_marquardt::LevenbergMarquardt;
use crate::inverse::sequence::{element, window};

/// Number of starts for one joint, which has few local minima: more starts find nothing new.
const STARTS_OF_ONE_JOINT: usize = 12;
const STARTS_OF_TWO_JOINTS: usize = 48;
/// Starts for the nearest configuration to a target out of reach.
const STARTS_BEYOND_REACH: usize = 8;

/// Tolerance of a search (m, rad). Convergence is quadratic, so this takes one step more than a millionth.
const SEARCH_TOLERANCE: f64 = 1e-9;

/// The goal of a target.
#[derive(Clone, Copy)]
enum TargetGoal {
    Position(PositionGoal),
    Surface(SurfaceGoal),
}

/// The remaining error.
#[derive(Clone, Copy)]
struct RemainingError {
    position_m: f64,
    angle_rad: f64,
}

impl PointChain {
    /// Brings the point to `target`, with its normal along the target's normal if the target has one. Does not allocate.
    ///
    /// `q` contains all of the chain's values (rad or m). On entry it is the configuration from which the search starts.
    /// On success it is the solution, within the joint limits; if the target is not reached, it is the nearest
    /// configuration found, also within the limits. Joints that do not move the point keep their values. Full turns are
    /// added or subtracted if the result is nearer to the start.
    ///
    /// # Errors
    /// [`PointError::NotReached`] with the remaining error. Another [`PointError`], with `q` unchanged, if a number is
    /// not finite, `q` has the wrong length, or the target has a normal and the point has none.
    pub fn solve(&mut self, target: &OrientedPoint, q: &mut [f64]) -> Result<SurfaceIkSolution, PointError> {
        let goal = self.goal(target, q)?;
        let starts = self.starts(target);
        let mut nearest: Option<RemainingError> = None;
        for index in 0..starts {
            self.start(index, q);
            let error = self.minimize(&goal, self.options.iterations);
            if self.met(&error) {
                self.store_near(q);
                return Ok(SurfaceIkSolution {
                    position_error_m: error.position_m,
                    angle_error_rad: error.angle_rad,
                    restarts: index,
                });
            }
            if nearest.is_none_or(|n| self.weight(&error) < self.weight(&n)) {
                nearest = Some(error);
                self.best.copy_from_slice(&self.x);
            }
        }
        let Some(error) = nearest else {
            return Err(PointError::NoStarts);
        };
        self.x.copy_from_slice(&self.best);
        self.store_near(q);
        Err(PointError::NotReached { position_error_m: error.position_m, angle_error_rad: error.angle_rad, starts })
    }

    /// Performs at most `steps` steps from `q` towards `target`, in place: for a control loop with a target nearby. The
    /// error never grows. Does not allocate. Returns `Ok` if the target is met.
    ///
    /// # Errors
    /// As [`PointChain::solve`], with one start.
    pub fn refine(
        &mut self,
        target: &OrientedPoint,
        q: &mut [f64],
        steps: usize,
    ) -> Result<SurfaceIkSolution, PointError> {
        let goal = self.goal(target, q)?;
        self.load(q);
        let RemainingError { position_m: position_error_m, angle_rad: angle_error_rad } = self.minimize(&goal, steps);
        self.store(q);
        if self.met(&RemainingError { position_m: position_error_m, angle_rad: angle_error_rad }) {
            return Ok(SurfaceIkSolution { position_error_m, angle_error_rad, restarts: 0 });
        }
        Err(PointError::NotReached { position_error_m, angle_error_rad, starts: 1 })
    }

    fn goal(&self, target: &OrientedPoint, q: &[f64]) -> Result<TargetGoal, PointError> {
        if q.len() != self.dof {
            return Err(PointError::ConfigurationLength);
        }
        if !q.iter().all(|v| v.is_finite()) {
            return Err(PointError::ConfigurationNotFinite);
        }
        if !target.point_in_root.is_finite() {
            return Err(PointError::TargetNotFinite);
        }
        let tolerance_m = self.options.position_tolerance_m.min(SEARCH_TOLERANCE);
        let position = PositionGoal { target: target.point_in_root, tolerance_m, scale: self.scale };
        let Some(normal) = target.normal_in_root else {
            return Ok(TargetGoal::Position(position));
        };
        let wanted_in_root = normal.try_normalize().ok_or(PointError::TargetNormalWithoutDirection)?;
        // The arm's tip frame has the orientation of the link.
        let normal_in_tip = self.normal_in_link().ok_or(PointError::NoNormal)?;
        let tolerance_rad = self.options.angle_tolerance_rad.min(SEARCH_TOLERANCE);
        Ok(TargetGoal::Surface(SurfaceGoal { position, normal_in_tip, wanted_in_root, tolerance_rad }))
    }

    fn starts(&self, target: &OrientedPoint) -> usize {
        let most = match self.arm.variables.len() {
            0 => 1,
            _ if self.beyond_reach(target.point_in_root) => STARTS_BEYOND_REACH,
            1 => STARTS_OF_ONE_JOINT,
            2 => STARTS_OF_TWO_JOINTS,
            _ => usize::MAX,
        };
        self.options.starts.min(most)
    }

    fn beyond_reach(&self, target: Vec3) -> bool {
        let Some(first) = self.arm.joints.first() else {
            return false;
        };
        first.origin.translation.distance(target) > self.arm.reach + self.options.position_tolerance_m
    }

    /// Fills `x` with starting point `index`: `q` itself, then points of a sequence over the joint ranges.
    fn start(&mut self, index: usize, q: &[f64]) {
        if index == 0 {
            return self.load(q);
        }
        let reach = 2.0 * self.scale;
        for ((value, v), increment) in self.x.iter_mut().zip(&self.arm.variables).zip(&self.increments) {
            let (lower, upper) = window(v.lower, v.upper, v.turns, reach);
            *value = lower + (upper - lower) * element(index, *increment);
        }
    }

    /// Improves `x` in place; returns the remaining error.
    fn minimize(&mut self, goal: &TargetGoal, iterations: usize) -> RemainingError {
        let Self { arm, scale, x, position, surface, .. } = self;
        let (arm, scale, bounded) = (&*arm, *scale, true);
        match goal {
            TargetGoal::Position(goal) => {
                let tip = LevenbergMarquardt { arm, goal, scale, bounded, workspace: position }.run(x, iterations);
                RemainingError { position_m: tip.translation.distance(goal.target), angle_rad: 0.0 }
            }
            TargetGoal::Surface(goal) => {
                let tip = LevenbergMarquardt { arm, goal, scale, bounded, workspace: surface }.run(x, iterations);
                goal.remaining_error(&tip)
            }
        }
    }

    fn met(&self, error: &RemainingError) -> bool {
        error.position_m <= self.options.position_tolerance_m && error.angle_rad <= self.options.angle_tolerance_rad
    }

    /// Both errors in radians; NaN counts as infinite.
    fn weight(&self, error: &RemainingError) -> f64 {
        let weight = (error.position_m / self.scale).hypot(error.angle_rad);
        if weight.is_nan() { f64::INFINITY } else { weight }
    }

    fn store(&self, q: &mut [f64]) {
        for (value, variable) in self.x.iter().zip(&self.arm.variables) {
            q[variable.q_index] = *value;
        }
    }

    /// Stores `x` in `q`, shifted by full turns as near to the old values as the limits allow.
    fn store_near(&self, q: &mut [f64]) {
        for (value, variable) in self.x.iter().zip(&self.arm.variables) {
            let q = &mut q[variable.q_index];
            *q = near_turn(*value, *q, variable);
        }
    }
}

impl SurfaceGoal {
    fn remaining_error(&self, tip_in_root: &Pose) -> RemainingError {
        RemainingError {
            position_m: tip_in_root.translation.distance(self.position.target),
            angle_rad: angle_between(tip_in_root.rotation * self.normal_in_tip, self.wanted_in_root),
        }
    }
}

/// `value` plus the full turns that bring it nearest to `near`, if that is within the limits; otherwise `value`.
fn near_turn(value: f64, near: f64, variable: &ArmVariable) -> f64 {
    if !variable.wraps {
        return value;
    }
    let turned = value + TAU * ((near - value) / TAU).round();
    if turned >= variable.lower && turned <= variable.upper { turned } else { value }
}
