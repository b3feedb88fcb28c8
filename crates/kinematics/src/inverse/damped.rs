//! Damped least squares with joint limits.
//!
//! Levenberg-Marquardt on the pose error; damping proportional to the squared error (Sugihara 2011,
//! "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method"), so that it vanishes at a solution and
//! convergence there is quadratic. Joints that press against a bound are taken out of the step.

use elbowroom_spatial::{Pose, Vec3};

use super::Task;
use super::arm::{Arm, AxisInRoot, turn_between};
use super::linear::solve_spd;

/// Below this (m, rad) nothing but rounding is left to gain.
const FLOOR: f64 = 1e-13;

/// What remains between the tip and its target.
#[derive(Debug, Clone, Copy)]
pub struct Remainder {
    pub linear: Vec3,
    pub angular: Vec3,
}

impl Remainder {
    /// Distance from the target.
    pub fn position_m(&self) -> f64 {
        self.linear.length()
    }
    pub fn angle_rad(&self) -> f64 {
        self.angular.length()
    }
}

/// Memory for one descent.
#[derive(Debug, Clone)]
pub struct Scratch {
    axes: Vec<AxisInRoot>,
    columns: Vec<[f64; 6]>,
    trial: Vec<f64>,
    held: Vec<bool>,
}

impl Scratch {
    pub fn new(arm: &Arm) -> Self {
        Self {
            axes: vec![AxisInRoot { origin: Vec3::ZERO, axis: Vec3::ZERO }; arm.segments.len()],
            columns: vec![[0.0; 6]; arm.variables.len()],
            trial: vec![0.0; arm.variables.len()],
            held: vec![false; arm.variables.len()],
        }
    }
}

/// One search from one starting point.
pub struct Descent<'a> {
    pub arm: &'a Arm,
    pub task: Task,
    /// Metres that weigh as much as a radian.
    pub scale: f64,
    /// Whether joint limits are kept.
    pub bounded: bool,
    pub scratch: &'a mut Scratch,
}

impl Descent<'_> {
    pub fn remainder(&mut self, target: &Pose, x: &[f64]) -> Remainder {
        let tip = self.arm.tip_in_root(x, &mut self.scratch.axes);
        Remainder { linear: target.translation - tip.translation, angular: turn_between(tip.rotation, target.rotation) }
    }

    fn residual(&self, r: &Remainder) -> [f64; 6] {
        let l = r.linear / self.scale;
        let a = if self.task == Task::Position { Vec3::ZERO } else { r.angular };
        [l.x, l.y, l.z, a.x, a.y, a.z]
    }

    fn at_floor(&self, r: &Remainder) -> bool {
        r.position_m() <= FLOOR && (self.task == Task::Position || r.angle_rad() <= FLOOR)
    }

    /// Walks `x` downhill for at most `iterations` steps and returns what remains at the best point, which `x` then is.
    pub fn run(&mut self, target: &Pose, x: &mut [f64], iterations: usize) -> Remainder {
        self.clamp(x);
        let mut best = self.remainder(target, x);
        let mut e = self.residual(&best);
        let mut cost = squared(&e);
        let (mut damping, mut milestone) = (1e-1, (0, cost));
        for iteration in 0..iterations {
            if self.at_floor(&best) || !cost.is_finite() {
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
            self.linearize(x);
            for _ in 0..6 {
                if !self.step(x, &e, damping * cost + 1e-15) {
                    damping *= 10.0;
                    continue;
                }
                let trial = std::mem::take(&mut self.scratch.trial);
                let remainder = self.remainder(target, &trial);
                let trial_e = self.residual(&remainder);
                let trial_cost = squared(&trial_e);
                improved = trial_cost < cost;
                if improved {
                    x.copy_from_slice(&trial);
                    (best, e, cost) = (remainder, trial_e, trial_cost);
                }
                self.scratch.trial = trial;
                if improved {
                    damping = (damping * 0.25).max(1e-9);
                    break;
                }
                damping = (damping * 8.0).min(1e9);
            }
            if !improved {
                break;
            }
        }
        best
    }

    fn clamp(&self, x: &mut [f64]) {
        if !self.bounded {
            return;
        }
        for (value, variable) in x.iter_mut().zip(&self.arm.variables) {
            *value = value.max(variable.lower).min(variable.upper);
        }
    }

    /// Fills the weighted Jacobian at `x` and holds the joints that cannot move at all.
    fn linearize(&mut self, x: &[f64]) {
        let tip = self.arm.tip_in_root(x, &mut self.scratch.axes);
        self.arm.columns(tip.translation, &self.scratch.axes, &mut self.scratch.columns);
        for (i, column) in self.scratch.columns.iter_mut().enumerate() {
            for (row, value) in column.iter_mut().enumerate() {
                if row < 3 {
                    *value /= self.scale;
                } else if self.task == Task::Position {
                    *value = 0.0;
                }
            }
            let variable = &self.arm.variables[i];
            self.scratch.held[i] = self.bounded && variable.lower >= variable.upper;
        }
    }

    /// A step into `trial`, without the joints that would leave their range by it; false where there is none.
    fn step(&mut self, x: &[f64], e: &[f64; 6], lambda: f64) -> bool {
        // Every round but the last takes a joint out, so there are no more rounds than joints.
        for _ in 0..=x.len() {
            if !self.solve_for_step(e, lambda) {
                return false;
            }
            if !self.hold_what_presses(x) {
                break;
            }
        }
        self.apply_step(x)
    }

    /// `Δx = Jᵀ(J·Jᵀ + λ·1)⁻¹·e` over the joints that are not held.
    fn solve_for_step(&mut self, e: &[f64; 6], lambda: f64) -> bool {
        let mut a = [[0.0; 6]; 6];
        for column in self.free_columns() {
            for i in 0..6 {
                for j in 0..=i {
                    a[i][j] += column[i] * column[j];
                }
            }
        }
        for (i, row) in a.iter_mut().enumerate() {
            row[i] += lambda;
        }
        let Some(y) = solve_spd(a, *e) else { return false };
        let Scratch { columns, trial, held, .. } = &mut *self.scratch;
        for ((delta, column), held) in trial.iter_mut().zip(columns).zip(held) {
            *delta = if *held { 0.0 } else { column.iter().zip(y).map(|(c, y)| c * y).sum() };
        }
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

    fn free_columns(&self) -> impl Iterator<Item = &[f64; 6]> {
        self.scratch.columns.iter().zip(&self.scratch.held).filter(|(_, held)| !**held).map(|(column, _)| column)
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

fn squared(e: &[f64; 6]) -> f64 {
    e.iter().map(|v| v * v).sum()
}
