//! Weighted least squares with bounds and soft inequalities: small, convex, always solvable.
//!
//! `minimize ½·|x − t|² + ½·Σ wᵢ·ρ(aᵢ·x − bᵢ)²` within `lower ≤ x ≤ upper`, where ρ is the difference itself ("equal") or its
//! negative part ("at least"). The minimum is unique and depends on the data without jumps: what makes a robot shake is
//! not here. Solved by a projected Newton method (Bertsekas 1982, "Projected Newton methods for optimization problems
//! with simple constraints").

/// Steps after which the best point so far has to do; some five to ten are usual.
const MOST_STEPS: usize = 60;
/// Projected gradient at which the point is the minimum, relative to the largest weight.
const ENOUGH: f64 = 1e-12;

/// A wish: `a·x` is to be `b`, or no less than it.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    /// One coefficient per unknown.
    pub a: Vec<f64>,
    /// What `a·x` is to be.
    pub b: f64,
    /// How much it counts beside `|x − t|²`, at least 0.
    pub weight: f64,
    /// More than `b` is as good.
    pub at_least: bool,
}

impl Wish {
    /// How far `x` is from it; 0 where "at least" is met.
    pub fn miss(&self, x: &[f64]) -> f64 {
        let miss = dot(&self.a, x) - self.b;
        if self.at_least { miss.min(0.0) } else { miss }
    }
}

/// The solver and its memory: for so many unknowns and wishes it does not allocate.
#[derive(Debug, Clone)]
pub struct LeastSquares {
    n: usize,
    wishes: Vec<Wish>,
    used: usize,
    /// Wanted values t.
    pub wanted: Vec<f64>,
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
    gradient: Vec<f64>,
    hessian: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
    free: Vec<usize>,
}

impl LeastSquares {
    /// For `n` unknowns and at most `most` wishes.
    pub fn new(n: usize, most: usize) -> Self {
        let wish = Wish { a: vec![0.0; n], b: 0.0, weight: 0.0, at_least: false };
        Self {
            n,
            wishes: vec![wish; most],
            used: 0,
            wanted: vec![0.0; n],
            lower: vec![f64::NEG_INFINITY; n],
            upper: vec![f64::INFINITY; n],
            gradient: vec![0.0; n],
            hessian: vec![0.0; n * n],
            step: vec![0.0; n],
            trial: vec![0.0; n],
            free: Vec::with_capacity(n),
        }
    }

    /// Forgets all wishes.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// The next wish to fill in; `None` where there is no room for another.
    pub fn wish(&mut self) -> Option<&mut Wish> {
        let wish = self.wishes.get_mut(self.used)?;
        self.used += 1;
        Some(wish)
    }

    /// The wishes so far.
    pub fn wishes(&self) -> &[Wish] {
        &self.wishes[..self.used]
    }

    /// Writes the minimum to `x`, which is also where the search begins. Returns false, with `x` within the bounds, where
    /// a number is not finite.
    pub fn solve(&mut self, x: &mut [f64]) -> bool {
        for j in 0..self.n {
            // Bounds that cross are as good as their middle.
            if self.lower[j] > self.upper[j] {
                let middle = f64::midpoint(self.lower[j], self.upper[j]);
                (self.lower[j], self.upper[j]) = (middle, middle);
            }
            x[j] = x[j].clamp(self.lower[j], self.upper[j]);
        }
        let scale = self.wishes().iter().map(|w| w.weight).fold(1.0, f64::max);
        for _ in 0..MOST_STEPS {
            self.linearize(x);
            let still = self.outside_pull(x);
            if !still.is_finite() {
                return false;
            }
            if still <= ENOUGH * scale || !self.newton() || !self.go(x) {
                break;
            }
        }
        x.iter().all(|v| v.is_finite())
    }

    fn cost(&self, x: &[f64]) -> f64 {
        let from_wanted: f64 = x.iter().zip(&self.wanted).map(|(x, t)| (x - t) * (x - t)).sum();
        let wishes: f64 = self.wishes().iter().map(|w| w.weight * w.miss(x).powi(2)).sum();
        0.5 * (from_wanted + wishes)
    }

    fn linearize(&mut self, x: &[f64]) {
        let n = self.n;
        self.hessian.fill(0.0);
        for j in 0..n {
            self.hessian[j * n + j] = 1.0;
            self.gradient[j] = x[j] - self.wanted[j];
        }
        for wish in &self.wishes[..self.used] {
            let miss = wish.miss(x);
            if wish.weight == 0.0 || (wish.at_least && miss == 0.0) {
                continue;
            }
            for j in 0..n {
                let pull = wish.weight * wish.a[j];
                self.gradient[j] += pull * miss;
                for k in 0..n {
                    self.hessian[j * n + k] += pull * wish.a[k];
                }
            }
        }
    }

    /// Largest gradient that bounds do not hold; also finds the unknowns that are free.
    fn outside_pull(&mut self, x: &[f64]) -> f64 {
        self.free.clear();
        let mut largest: f64 = 0.0;
        for j in 0..self.n {
            let g = self.gradient[j];
            let held = (x[j] <= self.lower[j] && g >= 0.0) || (x[j] >= self.upper[j] && g <= 0.0);
            if !held {
                self.free.push(j);
                largest = if g.is_nan() { f64::NAN } else { largest.max(g.abs()) };
            }
        }
        largest
    }

    /// The Newton step of the free unknowns, by Cholesky's decomposition.
    fn newton(&mut self) -> bool {
        let (n, m) = (self.n, self.free.len());
        self.step.fill(0.0);
        for i in 0..m {
            let row = self.free[i];
            for j in 0..=i {
                let column = self.free[j];
                let mut sum = self.hessian[row * n + column];
                for k in 0..j {
                    sum -= self.hessian[row * n + self.free[k]] * self.hessian[column * n + self.free[k]];
                }
                if i == j && !(sum > 0.0) {
                    return false;
                }
                // The lower triangle takes the factor: it is not read again before the next linearization.
                self.hessian[row * n + column] =
                    if i == j { sum.sqrt() } else { sum / self.hessian[column * n + column] };
            }
        }
        for i in 0..m {
            let row = self.free[i];
            let mut sum = -self.gradient[row];
            for k in 0..i {
                sum -= self.hessian[row * n + self.free[k]] * self.step[self.free[k]];
            }
            self.step[row] = sum / self.hessian[row * n + row];
        }
        for i in (0..m).rev() {
            let row = self.free[i];
            let mut sum = self.step[row];
            for k in i + 1..m {
                let below = self.free[k];
                sum -= self.hessian[below * n + row] * self.step[below];
            }
            self.step[row] = sum / self.hessian[row * n + row];
        }
        true
    }

    /// Goes along the step, bent at the bounds, as far as it gains; false where nothing is gained.
    fn go(&mut self, x: &mut [f64]) -> bool {
        let before = self.cost(x);
        let mut length = 1.0;
        for _ in 0..40 {
            let mut promised = 0.0;
            for j in 0..self.n {
                self.trial[j] = (x[j] + length * self.step[j]).clamp(self.lower[j], self.upper[j]);
                promised += self.gradient[j] * (self.trial[j] - x[j]);
            }
            let after = self.cost(&self.trial);
            if after <= before + 1e-4 * promised && after < before {
                x.copy_from_slice(&self.trial);
                return true;
            }
            length *= 0.5;
        }
        false
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
