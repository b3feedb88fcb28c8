//! Interior-point method: finds the speed spline of least duration under limits of velocity, acceleration and jerk.
//!
//! The method is primal-dual; all its iterates satisfy the constraints strictly. The only constraint that is not convex
//! is jerk: `|ℓ(x, b, c)| ≤ 1/√x`. Its right-hand side is convex, so the tangent at an iterate is a stronger
//! constraint. With this tangent, each step solves a convex problem (sequential convex programming) and stays
//! admissible. A step costs O(N), because the matrix is banded.

use super::banded_matrix::BandedMatrix;
use super::jerk_constraints::{AccelerationRow, Collocation, JerkConstraints, JerkRow};
use super::speed_spline::{LocalMap, apply, around};

/// Duality gap, as a fraction of the duration, at which the method ends.
const RELATIVE_GAP: f64 = 2e-2;
/// Change of the duration in a step, as a fraction, at which the method ends.
const RELATIVE_STEP: f64 = 6e-3;
const MAX_ITERATIONS: usize = 40;
/// Fraction of the distance to the nearest constraint that a step covers.
const TO_BOUNDARY: f64 = 0.99;

/// Slacks of one or two bounds (their reciprocals), multipliers, and the multipliers' steps.
#[derive(Debug, Clone, Copy)]
struct Multiplier<const N: usize> {
    dual: [f64; N],
    inverse: [f64; N],
    step: [f64; N],
}

/// Initial multipliers of a barrier, and the sum of multipliers times slacks.
#[derive(Debug, Clone, Copy, Default)]
struct Gap {
    first: Option<f64>,
    sum: f64,
}

impl<const N: usize> Multiplier<N> {
    const NEW: Self = Self { dual: [0.0; N], inverse: [0.0; N], step: [0.0; N] };

    /// Sets the slacks; returns the weights `dual / slack` in the matrix.
    #[inline]
    fn set_slacks(&mut self, slacks: [f64; N], gap: &mut Gap) -> [f64; N] {
        // One division for two slacks.
        let inverse = 1.0 / slacks.iter().product::<f64>();
        let mut weights = [0.0; N];
        for i in 0..N {
            self.inverse[i] = if N == 2 { slacks[1 - i] * inverse } else { inverse };
            if let Some(barrier) = gap.first {
                self.dual[i] = barrier * self.inverse[i];
            }
            gap.sum += self.dual[i] * slacks[i];
            weights[i] = self.dual[i] * self.inverse[i];
        }
        weights
    }

    /// Sets the multipliers' steps for a step of the slacks; returns the largest fractions of slack and multiplier that
    /// are used up.
    #[inline]
    fn set_step(&mut self, slack_steps: [f64; N], barrier: f64, used: &mut [f64; 2]) {
        for i in 0..N {
            let relative = slack_steps[i] * self.inverse[i];
            self.step[i] = barrier * self.inverse[i] - self.dual[i] * (1.0 + relative);
            if -relative > used[0] {
                used[0] = -relative;
            }
            if -self.step[i] > used[1] * self.dual[i] {
                used[1] = -self.step[i] / self.dual[i];
            }
        }
    }

    fn advance(&mut self, share: f64) {
        for i in 0..N {
            self.dual[i] += share * self.step[i];
        }
    }
}

/// Gradients and matrix of one point with respect to x, b and c.
#[derive(Debug, Default)]
struct LocalSystem {
    /// Gradient of the duration.
    objective: [f64; 3],
    /// Gradient of the barrier.
    barrier: [f64; 3],
    matrix: [[f64; 3]; 3],
}

/// The method's state.
#[derive(Debug)]
pub(super) struct InteriorPoint<'c> {
    constraints: &'c JerkConstraints,
    coefficients: Vec<f64>,
    positive: Vec<Multiplier<1>>,
    speed: Vec<Multiplier<1>>,
    /// From above and below.
    acceleration: Vec<Multiplier<2>>,
    jerk: Vec<Multiplier<2>>,
    /// Derivative of 1/√x at each point.
    root_slopes: Vec<f64>,
    matrix: BandedMatrix,
    /// Gradients of the duration and of the barrier.
    gradients: Vec<[f64; 2]>,
    seconds: f64,
    gap: Gap,
}

/// Finds the fastest coefficients, starting from coefficients that satisfy all constraints strictly.
pub(super) fn fastest(constraints: &JerkConstraints, coefficients: Vec<f64>) -> Vec<f64> {
    let mut state = InteriorPoint::new(constraints, coefficients);
    let mut steps = Vec::new();
    let mut last_share = 0.0;
    for iteration in 0..MAX_ITERATIONS {
        state.assemble(iteration == 0);
        let centring = if last_share > 0.8 { 0.1 } else { 0.4 };
        let barrier = centring * state.gap.sum / state.count() as f64;
        steps.clear();
        steps.extend(state.gradients.iter().map(|[t, b]| barrier * b - t));
        if !state.matrix.solve(&mut steps) || !steps.iter().all(|x| x.is_finite()) {
            break;
        }
        let used = state.multiplier_steps(&steps, barrier);
        let [primal, dual] = used.map(|used| (TO_BOUNDARY / used).min(1.0));
        let change: f64 = primal * state.gradients.iter().zip(&steps).map(|(g, p)| g[0] * p).sum::<f64>();
        state.advance(&steps, primal, dual);
        if state.gap.sum < RELATIVE_GAP * state.seconds && change.abs() < RELATIVE_STEP * state.seconds {
            break;
        }
        last_share = primal.min(dual);
    }
    state.coefficients
}

impl<'c> InteriorPoint<'c> {
    fn new(constraints: &'c JerkConstraints, coefficients: Vec<f64>) -> Self {
        Self {
            constraints,
            positive: vec![Multiplier::NEW; coefficients.len()],
            speed: vec![Multiplier::NEW; constraints.points.len()],
            acceleration: vec![Multiplier::NEW; constraints.accelerations.len()],
            jerk: vec![Multiplier::NEW; constraints.jerks.len()],
            root_slopes: vec![0.0; constraints.points.len()],
            matrix: BandedMatrix::default(),
            gradients: Vec::new(),
            seconds: 0.0,
            gap: Gap::default(),
            coefficients,
        }
    }

    /// Number of constraints.
    fn count(&self) -> usize {
        self.positive.len() + self.speed.len() + 2 * (self.acceleration.len() + self.jerk.len())
    }

    /// Computes gradients and matrix at the iterate. In the first call, sets the multipliers to those of a barrier.
    fn assemble(&mut self, is_first: bool) {
        self.matrix.clear(self.coefficients.len());
        self.gradients.clear();
        self.gradients.resize(self.coefficients.len(), [0.0; 2]);
        let first = is_first.then(|| self.constraints.duration(&self.coefficients) / self.count() as f64);
        let mut gap = Gap { first, sum: 0.0 };
        self.seconds = 0.0;
        for (i, multiplier) in self.positive.iter_mut().enumerate() {
            let [weight] = multiplier.set_slacks([self.coefficients[i]], &mut gap);
            self.matrix.rows[i][0] += weight;
            self.gradients[i][1] += multiplier.inverse[0];
        }
        for interval in &self.constraints.intervals {
            let begin = apply(&interval.map, around(&self.coefficients, interval.index));
            let mut system = LocalSystem::default();
            for n in interval.points.clone() {
                let point = &self.constraints.points[n];
                let local = self.assemble_point(n, point, point.at_offset(begin), &mut gap);
                system.add_shifted(&local, point.offset);
            }
            system.add_to(&interval.map, interval.index, &mut self.matrix, &mut self.gradients);
        }
        self.gap = gap;
    }

    /// Gradients and matrix of a point with respect to its own x, b and c.
    #[inline]
    fn assemble_point(&mut self, n: usize, point: &Collocation, y: [f64; 3], gap: &mut Gap) -> LocalSystem {
        let mut local = LocalSystem::default();
        let root = 1.0 / y[0].sqrt();
        let inverse = root * root;
        let slope = -0.5 * root * inverse;
        self.root_slopes[n] = slope;
        self.seconds += point.weight * root;
        local.objective[0] = point.weight * slope;
        let [weight] = self.speed[n].set_slacks([1.0 - y[0] * point.x_factor], gap);
        local.matrix[0][0] = 0.75 * point.weight * root * inverse * inverse + weight * point.x_factor * point.x_factor;
        local.barrier[0] = -self.speed[n].inverse[0] * point.x_factor;
        let rows = self.constraints.accelerations[point.accelerations.clone()].iter();
        for (row, multiplier) in rows.zip(&mut self.acceleration[point.accelerations.clone()]) {
            let a = row[0] * y[0] + row[1] * y[1];
            let weights = multiplier.set_slacks([1.0 - a, 1.0 + a], gap);
            local.add_acceleration(row, weights, multiplier.inverse);
        }
        let rows = self.constraints.jerks[point.jerks.clone()].iter();
        for (row, multiplier) in rows.zip(&mut self.jerk[point.jerks.clone()]) {
            let j = row[0] * y[0] + row[1] * y[1] + row[2] * y[2];
            let weights = multiplier.set_slacks([root - j, root + j], gap);
            local.add_jerk(row, weights, multiplier.inverse, slope);
        }
        local
    }

    /// Computes the steps of all multipliers; returns the largest fractions of slacks and multipliers that a full step
    /// uses up.
    fn multiplier_steps(&mut self, steps: &[f64], barrier: f64) -> [f64; 2] {
        let mut used = [0.0; 2];
        for (multiplier, step) in self.positive.iter_mut().zip(steps) {
            multiplier.set_step([*step], barrier, &mut used);
        }
        for interval in &self.constraints.intervals {
            let begin = apply(&interval.map, around(steps, interval.index));
            for n in interval.points.clone() {
                let point = &self.constraints.points[n];
                let dy = point.at_offset(begin);
                self.speed[n].set_step([-dy[0] * point.x_factor], barrier, &mut used);
                let rows = self.constraints.accelerations[point.accelerations.clone()].iter();
                for (row, multiplier) in rows.zip(&mut self.acceleration[point.accelerations.clone()]) {
                    let a = row[0] * dy[0] + row[1] * dy[1];
                    multiplier.set_step([-a, a], barrier, &mut used);
                }
                let root_step = self.root_slopes[n] * dy[0];
                let rows = self.constraints.jerks[point.jerks.clone()].iter();
                for (row, multiplier) in rows.zip(&mut self.jerk[point.jerks.clone()]) {
                    let j = row[0] * dy[0] + row[1] * dy[1] + row[2] * dy[2];
                    multiplier.set_step([root_step - j, root_step + j], barrier, &mut used);
                }
            }
        }
        used
    }

    fn advance(&mut self, steps: &[f64], primal: f64, dual: f64) {
        for (x, step) in self.coefficients.iter_mut().zip(steps) {
            *x += primal * step;
        }
        self.positive.iter_mut().chain(&mut self.speed).for_each(|m| m.advance(dual));
        self.acceleration.iter_mut().chain(&mut self.jerk).for_each(|m| m.advance(dual));
    }
}

impl LocalSystem {
    /// Adds the system of a point at an offset from this system's point: its x is `x + 2·offset·b + offset²·c`, and so
    /// on.
    #[inline]
    fn add_shifted(&mut self, other: &Self, offset: f64) {
        let (twice, square) = (2.0 * offset, offset * offset);
        let shift = |v: [f64; 3]| [v[0], v[1] + twice * v[0], v[2] + offset * v[1] + square * v[0]];
        let (objective, barrier) = (shift(other.objective), shift(other.barrier));
        let m = &other.matrix;
        // Columns, then rows.
        let rows = [[m[0][0], m[1][0], m[2][0]], [m[1][0], m[1][1], m[2][1]], [m[2][0], m[2][1], m[2][2]]].map(shift);
        for i in 0..3 {
            self.objective[i] += objective[i];
            self.barrier[i] += barrier[i];
            let column = shift([rows[0][i], rows[1][i], rows[2][i]]);
            for k in i..3 {
                self.matrix[k][i] += column[k];
            }
        }
    }

    #[inline]
    fn add_acceleration(&mut self, [x, b]: &AccelerationRow, weights: [f64; 2], [up, down]: [f64; 2]) {
        let weight = weights[0] + weights[1];
        self.barrier[0] += (down - up) * x;
        self.barrier[1] += (down - up) * b;
        self.matrix[0][0] += weight * x * x;
        self.matrix[1][0] += weight * x * b;
        self.matrix[1][1] += weight * b * b;
    }

    #[inline]
    /// `slope` is the derivative of 1/√x.
    fn add_jerk(&mut self, row: &JerkRow, weights: [f64; 2], [up, down]: [f64; 2], slope: f64) {
        let (weight, skew) = (weights[0] + weights[1], slope * (weights[1] - weights[0]));
        self.barrier[0] += slope * (up + down);
        self.matrix[0][0] += slope * slope * weight + skew * row[0];
        for i in 0..3 {
            self.barrier[i] += (down - up) * row[i];
            self.matrix[i][0] += skew * row[i];
            for k in 0..=i {
                self.matrix[i][k] += weight * row[i] * row[k];
            }
        }
    }

    /// Converts the system from x, b and c to the coefficients around an interval, and adds it.
    fn add_to(&self, map: &LocalMap, interval: usize, matrix: &mut BandedMatrix, gradients: &mut [[f64; 2]]) {
        let m = &self.matrix;
        let full = [[m[0][0], m[1][0], m[2][0]], [m[1][0], m[1][1], m[2][1]], [m[2][0], m[2][1], m[2][2]]];
        let mut product = [[0.0; 3]; 3];
        for (i, row) in full.iter().enumerate() {
            for k in 0..3 {
                product[i][k] = row[0] * map[0][k] + row[1] * map[1][k] + row[2] * map[2][k];
            }
        }
        for i in 0..3 {
            let index = interval - 1 + i;
            let column = [map[0][i], map[1][i], map[2][i]];
            for k in 0..=i {
                matrix.rows[index][i - k] +=
                    column[0] * product[0][k] + column[1] * product[1][k] + column[2] * product[2][k];
            }
            gradients[index][0] +=
                self.objective[0] * column[0] + self.objective[1] * column[1] + self.objective[2] * column[2];
            gradients[index][1] +=
                self.barrier[0] * column[0] + self.barrier[1] * column[1] + self.barrier[2] * column[2];
        }
    }
}
