//! Which joint values bring the point to its target.

use std::f64::consts::TAU;

use elbowroom_spatial::{Pose, Vec3};

use super::chain::NO_NORMAL;
use super::goal::{PositionGoal, SurfaceGoal, angle_between};
use super::{PointChain, PointError, Reached, SurfacePoint};
use crate::inverse::arm::Variable;
use crate::inverse::damped::Descent;
use crate::inverse::sequence::{element, window};

/// Few joints have few local minima: more starts than these find nothing new.
const STARTS_OF_ONE_JOINT: usize = 12;
const STARTS_OF_TWO_JOINTS: usize = 48;
/// Starts for the nearest place to a target that is too far for every configuration.
const STARTS_BEYOND_REACH: usize = 8;

/// What a descent goes on to (m, rad): convergence is quadratic, so this is one step more than a millionth.
const AIM: f64 = 1e-9;

/// The equations of a target.
#[derive(Clone, Copy)]
enum Wanted {
    Position(PositionGoal),
    Surface(SurfaceGoal),
}

/// What remains.
#[derive(Clone, Copy)]
struct Missing {
    position_m: f64,
    angle_rad: f64,
}

impl PointChain {
    /// Brings the point to `target`, its normal along the target's where that has one. `q` holds all of the chain's values
    /// (rad or m): on entry where the robot is, from where the search starts; on success the answer, within the joint
    /// limits; where the target is not reached the nearest place found, within the limits, too. Joints that do not move
    /// the point keep their values, full turns are taken off or added where that is nearer to the start. Does not allocate.
    ///
    /// # Errors
    /// [`PointError::NotReached`] with what remains; [`PointError::BadInput`] where something is not finite, `q` has the
    /// wrong length, or the target has a normal and the point has none (`q` is untouched then).
    pub fn solve(&mut self, target: &SurfacePoint, q: &mut [f64]) -> Result<Reached, PointError> {
        let wanted = self.wanted(target, q)?;
        let starts = self.starts(target);
        let mut nearest: Option<Missing> = None;
        for index in 0..starts {
            self.start(index, q);
            let missing = self.descend(&wanted, self.options.iterations);
            if self.met(&missing) {
                self.store_near(q);
                return Ok(Reached {
                    position_error_m: missing.position_m,
                    angle_error_rad: missing.angle_rad,
                    restarts: index,
                });
            }
            if nearest.is_none_or(|n| self.weight(&missing) < self.weight(&n)) {
                nearest = Some(missing);
                self.best.copy_from_slice(&self.x);
            }
        }
        let Some(missing) = nearest else { return Err(PointError::BadInput("Options::starts is 0; write 1 or more")) };
        self.x.copy_from_slice(&self.best);
        self.store_near(q);
        Err(PointError::NotReached { position_error_m: missing.position_m, angle_error_rad: missing.angle_rad, starts })
    }

    /// At most `steps` steps from `q` towards `target`, in place: for a control loop, where the target is near. What
    /// remains never grows; `Ok` where the target is met. Does not allocate.
    ///
    /// # Errors
    /// As [`PointChain::solve`], with one start.
    pub fn refine(&mut self, target: &SurfacePoint, q: &mut [f64], steps: usize) -> Result<Reached, PointError> {
        let wanted = self.wanted(target, q)?;
        self.load(q);
        let Missing { position_m: position_error_m, angle_rad: angle_error_rad } = self.descend(&wanted, steps);
        self.store(q);
        if self.met(&Missing { position_m: position_error_m, angle_rad: angle_error_rad }) {
            return Ok(Reached { position_error_m, angle_error_rad, restarts: 0 });
        }
        Err(PointError::NotReached { position_error_m, angle_error_rad, starts: 1 })
    }

    fn wanted(&self, target: &SurfacePoint, q: &[f64]) -> Result<Wanted, PointError> {
        if q.len() != self.dof {
            return Err(PointError::BadInput("q needs one value per independent joint of the chain"));
        }
        if !q.iter().all(|v| v.is_finite()) {
            return Err(PointError::BadInput("q holds a value that is not finite"));
        }
        if !target.point_in_root.is_finite() {
            return Err(PointError::BadInput("the target point is not finite"));
        }
        let tolerance_m = self.options.position_tolerance_m.min(AIM);
        let position = PositionGoal { target: target.point_in_root, tolerance_m, scale: self.scale };
        let Some(normal) = target.normal_in_root else { return Ok(Wanted::Position(position)) };
        let wanted_in_root = normal.try_normalize().ok_or(PointError::BadInput(
            "the target's normal is no direction; write a finite vector other than zero in the root's frame",
        ))?;
        // The arm's tip frame is turned as the link is.
        let normal_in_tip = self.normal_in_link().ok_or(PointError::BadInput(NO_NORMAL))?;
        let tolerance_rad = self.options.angle_tolerance_rad.min(AIM);
        Ok(Wanted::Surface(SurfaceGoal { position, normal_in_tip, wanted_in_root, tolerance_rad }))
    }

    fn starts(&self, target: &SurfacePoint) -> usize {
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
        let Some(first) = self.arm.segments.first() else { return false };
        first.origin.translation.distance(target) > self.arm.reach + self.options.position_tolerance_m
    }

    /// Fills `x` with starting point `index`: `q` itself, then points of a sequence that fills the joint ranges.
    fn start(&mut self, index: usize, q: &[f64]) {
        if index == 0 {
            return self.load(q);
        }
        let reach = 2.0 * self.scale;
        for ((value, v), step) in self.x.iter_mut().zip(&self.arm.variables).zip(&self.spread) {
            let (lower, upper) = window(v.lower, v.upper, v.turns, reach);
            *value = lower + (upper - lower) * element(index, *step);
        }
    }

    /// From `x` downhill, in place.
    fn descend(&mut self, wanted: &Wanted, iterations: usize) -> Missing {
        let Self { arm, scale, x, position, surface, .. } = self;
        let (arm, scale, bounded) = (&*arm, *scale, true);
        match wanted {
            Wanted::Position(goal) => {
                let tip = Descent { arm, goal, scale, bounded, scratch: position }.run(x, iterations);
                Missing { position_m: tip.translation.distance(goal.target), angle_rad: 0.0 }
            }
            Wanted::Surface(goal) => {
                let tip = Descent { arm, goal, scale, bounded, scratch: surface }.run(x, iterations);
                goal.missing(&tip)
            }
        }
    }

    fn met(&self, missing: &Missing) -> bool {
        missing.position_m <= self.options.position_tolerance_m && missing.angle_rad <= self.options.angle_tolerance_rad
    }

    /// Both in radians; NaN is no nearer than anything.
    fn weight(&self, missing: &Missing) -> f64 {
        let weight = (missing.position_m / self.scale).hypot(missing.angle_rad);
        if weight.is_nan() { f64::INFINITY } else { weight }
    }

    fn store(&self, q: &mut [f64]) {
        for (value, variable) in self.x.iter().zip(&self.arm.variables) {
            q[variable.q_index] = *value;
        }
    }

    /// Puts `x` into `q`, by full turns as near to what is there as the limits allow.
    fn store_near(&self, q: &mut [f64]) {
        for (value, variable) in self.x.iter().zip(&self.arm.variables) {
            let q = &mut q[variable.q_index];
            *q = near_turn(*value, *q, variable);
        }
    }
}

impl SurfaceGoal {
    fn missing(&self, tip_in_root: &Pose) -> Missing {
        Missing {
            position_m: tip_in_root.translation.distance(self.position.target),
            angle_rad: angle_between(tip_in_root.rotation * self.normal_in_tip, self.wanted_in_root),
        }
    }
}

/// `value` plus the full turns that bring it nearest to `near`, where that is within the limits; else `value`.
fn near_turn(value: f64, near: f64, variable: &Variable) -> f64 {
    if !variable.wraps {
        return value;
    }
    let turned = value + TAU * ((near - value) / TAU).round();
    if turned >= variable.lower && turned <= variable.upper { turned } else { value }
}
