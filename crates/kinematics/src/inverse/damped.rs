//! Damped least squares with joint limits.
//!
//! Levenberg-Marquardt on the error of a [`Goal`]; damping proportional to the squared error (Sugihara 2011,
//! "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method"), so that it vanishes at a solution and
//! convergence there is quadratic. Joints that press against a bound are taken out of the step.

use elbowroom_spatial::{Pose, Vec3};

use super::arm::{Arm, AxisInRoot};
use super::goal::Goal;
use super::linear::solve_spd;

/// Least damping. Columns are of the order of 1: this is far above the rounding of their products, so that a direction
/// that changes nothing is not solved for, and far below what slows convergence down.
const FLOOR: f64 = 1e-13;

/// Memory for descents on goals of `R` equations.
#[derive(Debug, Clone)]
pub struct Scratch<const R: usize> {
    axes: Vec<AxisInRoot>,
    trial_axes: Vec<AxisInRoot>,
    columns: Vec<[f64; R]>,
    trial: Vec<f64>,
    held: Vec<bool>,
}

impl<const R: usize> Scratch<R> {
    pub fn new(arm: &Arm) -> Self {
        let axes = vec![AxisInRoot { origin: Vec3::ZERO, axis: Vec3::ZERO }; arm.segments.len()];
        Self {
            trial_axes: axes.clone(),
            axes,
            columns: vec![[0.0; R]; arm.variables.len()],
            trial: vec![0.0; arm.variables.len()],
            held: vec![false; arm.variables.len()],
        }
    }

    /// The tip in the root; the axes on the way are kept.
    pub fn tip_in_root(&mut self, arm: &Arm, x: &[f64]) -> Pose {
        arm.tip_in_root(x, &mut self.axes)
    }

    /// The axes of the last [`Scratch::tip_in_root`], one per segment.
    pub fn axes(&self) -> &[AxisInRoot] {
        &self.axes
    }
}

/// One search from one starting point.
pub struct Descent<'a, const R: usize, G> {
    pub arm: &'a Arm,
    pub goal: &'a G,
    /// Metres that weigh as much as a radian.
    pub scale: f64,
    /// Whether joint limits are kept.
    pub bounded: bool,
    pub scratch: &'a mut Scratch<R>,
}

impl<const R: usize, G: Goal<R>> Descent<'_, R, G> {
    /// Walks `x` downhill for at most `iterations` steps and returns the tip in the root at the best point, which `x` then
    /// is.
    pub fn run(&mut self, x: &mut [f64], iterations: usize) -> Pose {
        self.clamp(x);
        let mut tip = self.scratch.tip_in_root(self.arm, x);
        let mut e = self.goal.error(&tip);
        let mut cost = squared(&e);
        let (mut damping, mut milestone) = (1e-1, (0, cost));
        for iteration in 0..iterations {
            if self.goal.met(&e) || !cost.is_finite() {
                break;
            }
            if iteration >= milestone.0 + 10 {
                // Stuck on a slope that leads nowhere: a new start is worth more.
                if cost > 0.5 * milestone.1 && cost > 1e-6 {
                    break;
                }
                milestone = (iteration, cost);
            }
            let mut improved = false;
            self.linearize(&tip);
            for _ in 0..6 {
                if !self.step(x, &e, damping * cost + FLOOR) {
                    damping *= 10.0;
                    continue;
                }
                let Scratch { trial, trial_axes, axes, .. } = &mut *self.scratch;
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

    /// Fills the columns at the point whose axes are at hand, and holds the joints that cannot move at all.
    fn linearize(&mut self, tip: &Pose) {
        let Scratch { axes, columns, held, .. } = &mut *self.scratch;
        let place = self.goal.place(tip);
        columns.fill([0.0; R]);
        for (segment, at) in self.arm.segments.iter().zip(axes) {
            let (linear, angular) = segment.twist(at, tip.translation);
            let column = &mut columns[segment.variable];
            for (sum, v) in column.iter_mut().zip(self.goal.column(&place, linear, angular)) {
                *sum += v;
            }
        }
        for (held, variable) in held.iter_mut().zip(&self.arm.variables) {
            *held = self.bounded && variable.lower >= variable.upper;
        }
    }

    /// A step into `trial`, without the joints that would leave their range by it; false where there is none.
    fn step(&mut self, x: &[f64], e: &[f64; R], lambda: f64) -> bool {
        // Every round but the last takes a joint out, so there are no more rounds than joints.
        for _ in 0..=x.len() {
            let solved = if x.len() < R { self.solve_few_joints(e, lambda) } else { self.solve_for_step(e, lambda) };
            if !solved {
                return false;
            }
            if !self.hold_what_presses(x) {
                break;
            }
        }
        self.apply_step(x)
    }

    /// `Δx = Jᵀ(J·Jᵀ + λ·1)⁻¹·e` over the joints that are not held: a system of as many equations as the goal has.
    fn solve_for_step(&mut self, e: &[f64; R], lambda: f64) -> bool {
        let mut a = [[0.0; R]; R];
        for (column, _) in self.scratch.columns.iter().zip(&self.scratch.held).filter(|(_, held)| !**held) {
            for i in 0..R {
                for j in 0..=i {
                    a[i][j] += column[i] * column[j];
                }
            }
        }
        for (i, row) in a.iter_mut().enumerate() {
            row[i] += lambda;
        }
        let Some(y) = solve_spd(a, *e, R) else { return false };
        let Scratch { columns, trial, held, .. } = &mut *self.scratch;
        for ((delta, column), held) in trial.iter_mut().zip(columns).zip(held) {
            *delta = if *held { 0.0 } else { dot(column, &y) };
        }
        true
    }

    /// `Δx = (Jᵀ·J + λ·1)⁻¹·Jᵀ·e`, the same step by a system of as many equations as there are joints, fewer than `R`:
    /// the other one would be singular but for λ.
    fn solve_few_joints(&mut self, e: &[f64; R], lambda: f64) -> bool {
        let Scratch { columns, trial, held, .. } = &mut *self.scratch;
        let (mut a, mut b) = ([[0.0; R]; R], [0.0; R]);
        for (i, column) in columns.iter().enumerate() {
            if !held[i] {
                b[i] = dot(column, e);
                for j in (0..i).filter(|&j| !held[j]) {
                    a[i][j] = dot(column, &columns[j]);
                }
                a[i][i] = dot(column, column);
            }
            a[i][i] += lambda;
        }
        let joints = trial.len();
        let Some(y) = solve_spd(a, b, joints) else { return false };
        trial.copy_from_slice(&y[..joints]);
        true
    }

    /// Holds the joints that stand at a bound and would go on; true where there was one.
    fn hold_what_presses(&mut self, x: &[f64]) -> bool {
        let mut any = false;
        for (i, variable) in self.arm.variables.iter().enumerate() {
            let delta = self.scratch.trial[i];
            let outward = (x[i] <= variable.lower && delta < 0.0) || (x[i] >= variable.upper && delta > 0.0);
            let can_wrap = variable.wraps && variable.upper - variable.lower >= std::f64::consts::TAU - 1e-9;
            if self.bounded && outward && !can_wrap && !self.scratch.held[i] {
                self.scratch.held[i] = true;
                any = true;
            }
        }
        any
    }

    /// Shortens the step where it is long, and keeps it within the bounds.
    fn apply_step(&mut self, x: &[f64]) -> bool {
        let mut largest: f64 = 0.0;
        for (delta, variable) in self.scratch.trial.iter().zip(&self.arm.variables) {
            let unit = if variable.turns { 1.0 } else { self.scale };
            if !delta.is_finite() {
                return false;
            }
            largest = largest.max(delta.abs() / unit);
        }
        let shorten = if largest > 1.0 { 1.0 / largest } else { 1.0 };
        for i in 0..x.len() {
            let value = x[i] + self.scratch.trial[i] * shorten;
            self.scratch.trial[i] = if self.bounded { self.bring_within(i, value) } else { value };
        }
        true
    }

    /// Past the end of a range of a full turn or more lies its other end.
    fn bring_within(&self, i: usize, value: f64) -> f64 {
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
