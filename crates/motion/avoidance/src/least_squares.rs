//! Weighted least squares with bounds and soft inequality constraints: small, convex, always solvable.
//!
//! `minimize ½·|x − t|² + ½·Σ wᵢ·ρ(aᵢ·x − bᵢ)²` within `lower ≤ x ≤ upper`, where ρ is the difference itself (equality) or its
//! negative part (inequality). The minimum is unique and depends continuously on the data, so the commanded motion does not
//! jump.
//!
//! The solver is Newton's method on the piecewise quadratic cost. With the constraints that are active at a point, the
//! cost is quadratic. An active-set method finds its minimum within the bounds (Stark and Parker 1995,
//! "Bounded-variable least squares"), and a line search follows the step as far as the true cost falls. If the same
//! constraints are active at its end, the end is the minimum.

use elbowroom_spatial::linalg::solve_spd_in_place;

/// Largest number of Newton steps; three to ten are usual.
const MAX_STEPS: usize = 100;
/// Slope of the cost that counts as 0, relative to the largest curvature.
const FLAT_SLOPE: f64 = 1e-13;
/// Step that counts as 0, relative to the unknown plus 1.
const SHORT_STEP: f64 = 1e-14;
/// Number of bisections of a line search: one per bit of a double's fraction.
const LINE_SEARCH_BISECTIONS: usize = 52;
/// Largest number of active-set steps per unknown, counting one extra unknown: each step frees an unknown at its bound.
const ACTIVE_SET_STEPS: usize = 8;

/// A soft constraint `a·x = b` or `a·x ≥ b`.
#[derive(Debug, Clone, PartialEq)]
pub struct SoftConstraint {
    /// One coefficient per unknown.
    pub a: Vec<f64>,
    /// Right-hand side.
    pub b: f64,
    /// Weight relative to `|x − t|²`, at least 0.
    pub weight: f64,
    /// True for an inequality, false for an equality.
    pub at_least: bool,
}

impl SoftConstraint {
    /// The residual at `x`; 0 if an inequality is satisfied.
    pub fn residual(&self, x: &[f64]) -> f64 {
        let residual = dot(&self.a, x) - self.b;
        if self.at_least { residual.min(0.0) } else { residual }
    }

    /// Whether the constraint adds to the cost at `x`.
    fn is_active(&self, x: &[f64]) -> bool {
        !self.at_least || dot(&self.a, x) < self.b
    }
}

/// Minimum of a quadratic cost, and the gradient there.
#[derive(Debug, Clone)]
struct QuadraticMinimum {
    x: Vec<f64>,
    gradient: Vec<f64>,
}

/// The solver and its workspace, allocated once for a number of unknowns and constraints.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    n: usize,
    constraints: Vec<SoftConstraint>,
    used: usize,
    /// Desired values t.
    pub desired: Vec<f64>,
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    /// Gradient and Hessian of the cost at the point.
    gradient: Vec<f64>,
    hessian: Vec<f64>,
    /// Gradient of the quadratic cost at 0.
    gradient_at_zero: Vec<f64>,
    /// Cholesky factor of the Hessian of the free unknowns, and (in `free_step`) the step of the free unknowns.
    factor: Vec<f64>,
    free_step: Vec<f64>,
    target: QuadraticMinimum,
    step: Vec<f64>,
    free: Vec<usize>,
    active: Vec<bool>,
}

impl LeastSquares {
    /// Creates a solver for `n` unknowns and at most `capacity` constraints.
    pub fn new(n: usize, capacity: usize) -> Self {
        let constraint = SoftConstraint { a: vec![0.0; n], b: 0.0, weight: 0.0, at_least: false };
        Self {
            n,
            constraints: vec![constraint; capacity],
            used: 0,
            desired: vec![0.0; n],
            lower: vec![f64::NEG_INFINITY; n],
            upper: vec![f64::INFINITY; n],
            gradient: vec![0.0; n],
            hessian: vec![0.0; n * n],
            gradient_at_zero: vec![0.0; n],
            factor: vec![0.0; n * n],
            free_step: vec![0.0; n],
            target: QuadraticMinimum { x: vec![0.0; n], gradient: vec![0.0; n] },
            step: vec![0.0; n],
            free: Vec::with_capacity(n),
            active: vec![false; capacity],
        }
    }

    /// Removes all constraints.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// Adds a constraint for the caller to fill in; `None` if the capacity is exhausted.
    pub fn add_constraint(&mut self) -> Option<&mut SoftConstraint> {
        let constraint = self.constraints.get_mut(self.used)?;
        self.used += 1;
        Some(constraint)
    }

    /// The constraints.
    pub fn constraints(&self) -> &[SoftConstraint] {
        &self.constraints[..self.used]
    }

    /// Writes the minimum to `x`, which is also the initial guess. Returns false, with `x` within the bounds, if a
    /// number is not finite.
    pub fn solve(&mut self, x: &mut [f64]) -> bool {
        for j in 0..self.n {
            // Crossing bounds are replaced by their mean.
            if self.lower[j] > self.upper[j] {
                let middle = f64::midpoint(self.lower[j], self.upper[j]);
                (self.lower[j], self.upper[j]) = (middle, middle);
            }
            x[j] = x[j].clamp(self.lower[j], self.upper[j]);
        }
        for _ in 0..MAX_STEPS {
            self.linearize(x);
            if !self.gradient.iter().chain(&self.hessian).all(|v| v.is_finite()) {
                return false;
            }
            self.minimize_quadratic(x);
            let is_full_step = self.line_search(x);
            let same_active = self.constraints().iter().zip(&self.active).all(|(c, active)| c.is_active(x) == *active);
            let is_short = self.step.iter().zip(x.iter()).all(|(d, x)| d.abs() <= SHORT_STEP * (1.0 + x.abs()));
            if (is_full_step && same_active) || is_short {
                break;
            }
        }
        true
    }

    /// Updates gradient, Hessian and active constraints at `x`.
    fn linearize(&mut self, x: &[f64]) {
        let n = self.n;
        self.hessian.fill(0.0);
        for j in 0..n {
            self.hessian[j * n + j] = 1.0;
            self.gradient[j] = x[j] - self.desired[j];
            self.gradient_at_zero[j] = -self.desired[j];
        }
        for (constraint, active) in self.constraints[..self.used].iter().zip(&mut self.active) {
            *active = constraint.is_active(x);
            if !*active || constraint.weight == 0.0 {
                continue;
            }
            let residual = constraint.residual(x);
            for j in 0..n {
                let weighted = constraint.weight * constraint.a[j];
                self.gradient[j] += weighted * residual;
                self.gradient_at_zero[j] -= weighted * constraint.b;
                for k in 0..n {
                    self.hessian[j * n + k] += weighted * constraint.a[k];
                }
            }
        }
    }

    /// Writes the minimum within the bounds of the quadratic cost at `x` to `target`.
    fn minimize_quadratic(&mut self, x: &[f64]) {
        let n = self.n;
        let max_curvature = (0..n).map(|j| self.hessian[j * n + j]).fold(1.0, f64::max);
        self.target.x.copy_from_slice(x);
        self.free.clear();
        self.free.extend((0..n).filter(|&j| x[j] > self.lower[j] && x[j] < self.upper[j]));
        for _ in 0..ACTIVE_SET_STEPS * (n + 1) {
            self.descend();
            // The unknown that reduces the cost most by leaving its bound becomes free.
            let gain = |j: usize| {
                let at_low = self.target.x[j] <= self.lower[j];
                let inward = if at_low { -self.target.gradient[j] } else { self.target.gradient[j] };
                if self.lower[j] < self.upper[j] { inward } else { 0.0 }
            };
            let bound = (0..n).filter(|j| !self.free.contains(j));
            let best = bound.map(|j| (gain(j), j)).max_by(|a, b| a.0.total_cmp(&b.0));
            match best.filter(|b| b.0 > FLAT_SLOPE * max_curvature) {
                Some((_, j)) => self.free.push(j),
                None => return,
            }
        }
    }

    /// Moves the target to the minimum over the free unknowns; an unknown that reaches a bound is fixed there.
    fn descend(&mut self) {
        for _ in 0..=self.n {
            self.update_target_gradient();
            if self.free.is_empty() || !self.newton() {
                return;
            }
            let mut length = 1.0;
            let mut blocked = None;
            for (place, &j) in self.free.iter().enumerate() {
                let bound = if self.step[j] > 0.0 { self.upper[j] } else { self.lower[j] };
                let to_bound = (bound - self.target.x[j]) / self.step[j];
                if self.step[j] != 0.0 && to_bound < length {
                    (length, blocked) = (to_bound.max(0.0), Some((place, j, bound)));
                }
            }
            for &j in &self.free {
                self.target.x[j] = (self.target.x[j] + length * self.step[j]).clamp(self.lower[j], self.upper[j]);
            }
            let Some((place, j, bound)) = blocked else {
                self.update_target_gradient();
                return;
            };
            self.target.x[j] = bound;
            self.free.swap_remove(place);
        }
    }

    /// Updates the gradient of the quadratic cost at the target.
    fn update_target_gradient(&mut self) {
        let n = self.n;
        for j in 0..n {
            let product: f64 = (0..n).map(|k| self.hessian[j * n + k] * self.target.x[k]).sum();
            self.target.gradient[j] = self.gradient_at_zero[j] + product;
        }
    }

    /// Newton step of the free unknowns from the target, by Cholesky decomposition; false if it does not exist.
    fn newton(&mut self) -> bool {
        let (n, m) = (self.n, self.free.len());
        self.step.fill(0.0);
        for i in 0..m {
            for j in 0..=i {
                self.factor[i * n + j] = self.hessian[self.free[i] * n + self.free[j]];
            }
            self.free_step[i] = -self.target.gradient[self.free[i]];
        }
        if !solve_spd_in_place(&mut self.factor, n, &mut self.free_step[..m]) {
            return false;
        }
        for (&j, step) in self.free.iter().zip(&self.free_step) {
            self.step[j] = *step;
        }
        true
    }

    /// Moves `x` towards the target as far as the true cost falls; returns whether this is the full step.
    fn line_search(&mut self, x: &mut [f64]) -> bool {
        for j in 0..self.n {
            self.step[j] = self.target.x[j] - x[j];
        }
        let (mut low, mut high) = (0.0, 1.0);
        if self.slope_along(x, 1.0) > 0.0 {
            // The slope along the line increases: bisection of its zero down to rounding.
            for _ in 0..LINE_SEARCH_BISECTIONS {
                let middle = f64::midpoint(low, high);
                if self.slope_along(x, middle) > 0.0 { high = middle } else { low = middle }
            }
        } else {
            low = 1.0;
        }
        for j in 0..self.n {
            let to = if low == 1.0 { self.target.x[j] } else { x[j] + low * self.step[j] };
            x[j] = to.clamp(self.lower[j], self.upper[j]);
            self.step[j] *= low;
        }
        low == 1.0
    }

    /// Slope of the true cost at a fraction of the step.
    fn slope_along(&self, x: &[f64], fraction: f64) -> f64 {
        let own: f64 = (0..self.n).map(|j| (x[j] + fraction * self.step[j] - self.desired[j]) * self.step[j]).sum();
        let constraints = self.constraints().iter().filter(|c| c.weight > 0.0).map(|c| {
            let along = dot(&c.a, &self.step);
            let residual = dot(&c.a, x) - c.b + fraction * along;
            c.weight * along * if c.at_least { residual.min(0.0) } else { residual }
        });
        own + constraints.sum::<f64>()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
