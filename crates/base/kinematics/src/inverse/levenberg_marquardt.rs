//! Damped least squares with joint limits.
//!
//! Levenberg-Marquardt on the error of a [`Goal`], with damping proportional to the squared error. So the damping
//! vanishes at a solution, and convergence there is quadratic. Joints at a bound that the step would violate are
//! excluded from the step.
//!
//! Source: Sugihara 2011, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method".

use elbowroom_spatial::linalg::solve_spd;
use elbowroom_spatial::{Pose, Vec3};

use super::arm::{Arm, AxisInRoot};
use super::goal::Goal;

/// Least damping. Jacobian columns are of the order of 1. This is far above the rounding of their products, so that
/// singular directions are not amplified, and far below values that slow convergence down.
const FLOOR: f64 = 1e-13;

/// Workspace for goals of `R` equations.
#[derive(Debug, Clone)]
pub struct LmWorkspace<const R: usize> {
    axes: Vec<AxisInRoot>,
    trial_axes: Vec<AxisInRoot>,
    columns: Vec<[f64; R]>,
    trial: Vec<f64>,
    fixed: Vec<bool>,
}

impl<const R: usize> LmWorkspace<R> {
    pub fn new(arm: &Arm) -> Self {
        let axes = vec![AxisInRoot { origin: Vec3::ZERO, axis: Vec3::ZERO }; arm.joints.len()];
        Self {
            trial_axes: axes.clone(),
            axes,
            columns: vec![[0.0; R]; arm.variables.len()],
            trial: vec![0.0; arm.variables.len()],
            fixed: vec![false; arm.variables.len()],
        }
    }

    /// The tip in the root; stores the joint axes.
    pub fn tip_in_root(&mut self, arm: &Arm, x: &[f64]) -> Pose {
        arm.tip_in_root(x, &mut self.axes)
    }

    /// The joint axes of the last [`LmWorkspace::tip_in_root`], one per joint.
    pub fn axes(&self) -> &[AxisInRoot] {
        &self.axes
    }
}

/// A search from one starting point.
pub struct LevenbergMarquardt<'a, const R: usize, G> {
    pub arm: &'a Arm,
    pub goal: &'a G,
    /// Length (m) whose error counts as much as one radian.
    pub scale: f64,
    /// Whether joint limits are respected.
    pub bounded: bool,
    pub workspace: &'a mut LmWorkspace<R>,
}

impl<const R: usize, G: Goal<R>> LevenbergMarquardt<'_, R, G> {
    /// Improves `x` in at most `iterations` steps; returns the tip in the root at the result.
    pub fn run(&mut self, x: &mut [f64], iterations: usize) -> Pose {
        self.clamp(x);
        let mut tip = self.workspace.tip_in_root(self.arm, x);
        let mut e = self.goal.error(&tip);
        let mut cost = squared(&e);
        let (mut damping, mut milestone) = (1e-1, (0, cost));
        for iteration in 0..iterations {
            if self.goal.is_met(&e) || !cost.is_finite() {
                break;
            }
            if iteration >= milestone.0 + 10 {
                // Slow progress far from a solution: a new start is more promising.
                if cost > 0.5 * milestone.1 && cost > 1e-6 {
                    break;
                }
                milestone = (iteration, cost);
            }
            let mut improved = false;
            self.compute_jacobian(&tip);
            for _ in 0..6 {
                if !self.step(x, &e, damping * cost + FLOOR) {
                    damping *= 10.0;
                    continue;
                }
                let LmWorkspace { trial, trial_axes, axes, .. } = &mut *self.workspace;
                let trial_tip = self.arm.tip_in_root(trial, trial_axes);
                let trial_e = self.goal.error(&trial_tip);
                let trial_cost = squared(&trial_e);
                improved = trial_cost < cost;
                if improved {
                    x.copy_from_slice(trial);
                    std::mem::swap(axes, trial_axes);
                    (tip, e, cost) = (trial_tip, trial_e, trial_cost);
                    damping = (damping * 0.25).max(1e-9);
                    break;
                }
                damping = (damping * 8.0).min(1e9);
            }
            if !improved {
                break;
            }
        }
        tip
    }

    fn clamp(&self, x: &mut [f64]) {
        if !self.bounded {
            return;
        }
        for (value, variable) in x.iter_mut().zip(&self.arm.variables) {
            *value = value.max(variable.lower).min(variable.upper);
        }
    }

    /// Computes the Jacobian for the present axes, and fixes the joints without a range.
    fn compute_jacobian(&mut self, tip: &Pose) {
        let LmWorkspace { axes, columns, fixed, .. } = &mut *self.workspace;
        let at_tip = self.goal.linearize(tip);
        columns.fill([0.0; R]);
        for (joint, axis) in self.arm.joints.iter().zip(axes) {
            let (linear, angular) = joint.twist(axis, tip.translation);
            let column = &mut columns[joint.variable];
            for (sum, v) in column.iter_mut().zip(self.goal.jacobian_column(&at_tip, linear, angular)) {
                *sum += v;
            }
        }
        for (fixed, variable) in fixed.iter_mut().zip(&self.arm.variables) {
            *fixed = self.bounded && variable.lower >= variable.upper;
        }
    }

    /// Computes the step's result in `trial`, without the joints that it would move beyond their limits; false if no
    /// step exists.
    fn step(&mut self, x: &[f64], e: &[f64; R], lambda: f64) -> bool {
        // Each round but the last fixes a joint, so the number of rounds is limited by the number of joints.
        for _ in 0..=x.len() {
            let solved =
                if x.len() < R { self.solve_in_joint_space(e, lambda) } else { self.solve_in_task_space(e, lambda) };
            if !solved {
                return false;
            }
            if !self.fix_joints_at_bounds(x) {
                break;
            }
        }
        self.apply_step(x)
    }

    /// Solves `Δx = Jᵀ(J·Jᵀ + λ·1)⁻¹·e` over the joints that are not fixed: one equation per equation of the goal.
    fn solve_in_task_space(&mut self, e: &[f64; R], lambda: f64) -> bool {
        let mut a = [[0.0; R]; R];
        for (column, _) in self.workspace.columns.iter().zip(&self.workspace.fixed).filter(|(_, fixed)| !**fixed) {
            for i in 0..R {
                for j in 0..=i {
                    a[i][j] += column[i] * column[j];
                }
            }
        }
        for (i, row) in a.iter_mut().enumerate() {
            row[i] += lambda;
        }
        let Some(y) = solve_spd(a, *e, R) else {
            return false;
        };
        let LmWorkspace { columns, trial, fixed, .. } = &mut *self.workspace;
        for ((delta, column), fixed) in trial.iter_mut().zip(columns).zip(fixed) {
            *delta = if *fixed { 0.0 } else { dot(column, &y) };
        }
        true
    }

    /// Solves `Δx = (Jᵀ·J + λ·1)⁻¹·Jᵀ·e`, the same step, with one equation per joint, for fewer than `R` joints: the
    /// system in task space would be singular without λ.
    fn solve_in_joint_space(&mut self, e: &[f64; R], lambda: f64) -> bool {
        let LmWorkspace { columns, trial, fixed, .. } = &mut *self.workspace;
        let (mut a, mut b) = ([[0.0; R]; R], [0.0; R]);
        for (i, column) in columns.iter().enumerate() {
            if !fixed[i] {
                b[i] = dot(column, e);
                for j in (0..i).filter(|&j| !fixed[j]) {
                    a[i][j] = dot(column, &columns[j]);
                }
                a[i][i] = dot(column, column);
            }
            a[i][i] += lambda;
        }
        let joints = trial.len();
        let Some(y) = solve_spd(a, b, joints) else {
            return false;
        };
        trial.copy_from_slice(&y[..joints]);
        true
    }

    /// Fixes the joints at a bound that the step would move beyond it; true if there are any.
    fn fix_joints_at_bounds(&mut self, x: &[f64]) -> bool {
        let mut any = false;
        for (i, variable) in self.arm.variables.iter().enumerate() {
            let delta = self.workspace.trial[i];
            let outward = (x[i] <= variable.lower && delta < 0.0) || (x[i] >= variable.upper && delta > 0.0);
            let can_wrap = variable.wraps && variable.upper - variable.lower >= std::f64::consts::TAU - 1e-9;
            if self.bounded && outward && !can_wrap && !self.workspace.fixed[i] {
                self.workspace.fixed[i] = true;
                any = true;
            }
        }
        any
    }

    /// Limits the length of the step, and keeps its result within the bounds.
    fn apply_step(&mut self, x: &[f64]) -> bool {
        let mut largest: f64 = 0.0;
        for (delta, variable) in self.workspace.trial.iter().zip(&self.arm.variables) {
            let unit = if variable.turns { 1.0 } else { self.scale };
            if !delta.is_finite() {
                return false;
            }
            largest = largest.max(delta.abs() / unit);
        }
        let shorten = if largest > 1.0 { 1.0 / largest } else { 1.0 };
        for i in 0..x.len() {
            let value = x[i] + self.workspace.trial[i] * shorten;
            self.workspace.trial[i] = if self.bounded { self.wrapped_or_clamped(i, value) } else { value };
        }
        true
    }

    /// Wraps a value beyond a range of a full turn or more to the other end; clamps any other value.
    fn wrapped_or_clamped(&self, i: usize, value: f64) -> f64 {
        let v = &self.arm.variables[i];
        let turn = std::f64::consts::TAU;
        if v.wraps && value > v.upper && value - turn >= v.lower {
            return value - turn;
        }
        if v.wraps && value < v.lower && value + turn <= v.upper {
            return value + turn;
        }
        value.max(v.lower).min(v.upper)
    }
}

fn squared<const R: usize>(e: &[f64; R]) -> f64 {
    dot(e, e)
}

fn dot<const R: usize>(a: &[f64; R], b: &[f64; R]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
