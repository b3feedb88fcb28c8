//! Weighted least squares with bounds and soft inequalities: small, convex, always solvable.
//!
//! `minimize ½·|x − t|² + ½·Σ wᵢ·ρ(aᵢ·x − bᵢ)²` within `lower ≤ x ≤ upper`, where ρ is the difference itself ("equal") or its
//! negative part ("at least"). The minimum is unique and depends on the data without jumps: what makes a robot shake is
//! not here.
//!
//! Newton's method on the piecewise quadratic cost: with the wishes that are missed at a point the cost is quadratic; its
//! minimum within the bounds is found by active sets (Stark and Parker 1995, "Bounded-variable least squares"), and the way
//! there is gone as far as the true cost falls. Where the same wishes are missed at its end it is the minimum.

/// Steps after which the best point so far has to do; three to ten are usual.
const MOST_STEPS: usize = 100;
/// Slope of the cost that is rounding, relative to the largest curvature.
const FLAT: f64 = 1e-13;

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
    /// Slope and curvature of the cost at the point.
    gradient: Vec<f64>,
    hessian: Vec<f64>,
    /// The slope that the quadratic cost would have at 0.
    at_zero: Vec<f64>,
    factor: Vec<f64>,
    /// The minimum of the quadratic cost, and the slope there.
    target: Vec<f64>,
    slope: Vec<f64>,
    step: Vec<f64>,
    free: Vec<usize>,
    missed: Vec<bool>,
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
            at_zero: vec![0.0; n],
            factor: vec![0.0; n * n],
            target: vec![0.0; n],
            slope: vec![0.0; n],
            step: vec![0.0; n],
            free: Vec::with_capacity(n),
            missed: vec![false; most],
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
        for _ in 0..MOST_STEPS {
            self.linearize(x);
            if !self.gradient.iter().chain(&self.hessian).all(|v| v.is_finite()) {
                return false;
            }
            self.minimize_quadratic(x);
            let whole = self.go(x);
            let same = self.wishes().iter().zip(&self.missed).all(|(w, m)| counts(w, x) == *m);
            let short = self.step.iter().zip(x.iter()).all(|(d, x)| d.abs() <= 1e-14 * (1.0 + x.abs()));
            if (whole && same) || short {
                break;
            }
        }
        true
    }

    /// Slope and curvature at `x`, and which wishes make them.
    fn linearize(&mut self, x: &[f64]) {
        let n = self.n;
        self.hessian.fill(0.0);
        for j in 0..n {
            self.hessian[j * n + j] = 1.0;
            self.gradient[j] = x[j] - self.wanted[j];
            self.at_zero[j] = -self.wanted[j];
        }
        for (wish, missed) in self.wishes[..self.used].iter().zip(&mut self.missed) {
            *missed = counts(wish, x);
            if !*missed || wish.weight == 0.0 {
                continue;
            }
            let miss = wish.miss(x);
            for j in 0..n {
                let pull = wish.weight * wish.a[j];
                self.gradient[j] += pull * miss;
                self.at_zero[j] -= pull * wish.b;
                for k in 0..n {
                    self.hessian[j * n + k] += pull * wish.a[k];
                }
            }
        }
    }

    /// The minimum within the bounds of the quadratic cost at `x`, in `target`.
    fn minimize_quadratic(&mut self, x: &[f64]) {
        let n = self.n;
        let steepest = (0..n).map(|j| self.hessian[j * n + j]).fold(1.0, f64::max);
        self.target.copy_from_slice(x);
        self.free.clear();
        self.free.extend((0..n).filter(|&j| x[j] > self.lower[j] && x[j] < self.upper[j]));
        for _ in 0..8 * n + 8 {
            self.descend();
            // Whoever would gain most by leaving its bound is let go.
            let gain = |j: usize| {
                let at_low = self.target[j] <= self.lower[j];
                let inward = if at_low { -self.slope[j] } else { self.slope[j] };
                if self.lower[j] < self.upper[j] { inward } else { 0.0 }
            };
            let held = (0..n).filter(|j| !self.free.contains(j));
            let best = held.map(|j| (gain(j), j)).max_by(|a, b| a.0.total_cmp(&b.0));
            match best.filter(|b| b.0 > FLAT * steepest) {
                Some((_, j)) => self.free.push(j),
                None => return,
            }
        }
    }

    /// Goes to the minimum over the free unknowns; those that meet a bound on the way stay there.
    fn descend(&mut self) {
        for _ in 0..=self.n {
            self.slope_at_target();
            if self.free.is_empty() || !self.newton() {
                return;
            }
            let mut length = 1.0;
            let mut blocked = None;
            for (place, &j) in self.free.iter().enumerate() {
                let bound = if self.step[j] > 0.0 { self.upper[j] } else { self.lower[j] };
                let room = (bound - self.target[j]) / self.step[j];
                if self.step[j] != 0.0 && room < length {
                    (length, blocked) = (room.max(0.0), Some((place, j, bound)));
                }
            }
            for &j in &self.free {
                self.target[j] = (self.target[j] + length * self.step[j]).clamp(self.lower[j], self.upper[j]);
            }
            let Some((place, j, bound)) = blocked else {
                self.slope_at_target();
                return;
            };
            self.target[j] = bound;
            self.free.swap_remove(place);
        }
    }

    /// Slope of the quadratic cost at the target.
    fn slope_at_target(&mut self) {
        let n = self.n;
        for j in 0..n {
            let curve: f64 = (0..n).map(|k| self.hessian[j * n + k] * self.target[k]).sum();
            self.slope[j] = self.at_zero[j] + curve;
        }
    }

    /// The Newton step of the free unknowns from the target, by Cholesky's decomposition.
    fn newton(&mut self) -> bool {
        let (n, m) = (self.n, self.free.len());
        self.step.fill(0.0);
        for i in 0..m {
            for j in 0..=i {
                let mut sum = self.hessian[self.free[i] * n + self.free[j]];
                for k in 0..j {
                    sum -= self.factor[i * n + k] * self.factor[j * n + k];
                }
                if i == j && !(sum > 0.0) {
                    return false;
                }
                self.factor[i * n + j] = if i == j { sum.sqrt() } else { sum / self.factor[j * n + j] };
            }
        }
        for i in 0..m {
            let mut sum = -self.slope[self.free[i]];
            for k in 0..i {
                sum -= self.factor[i * n + k] * self.step[self.free[k]];
            }
            self.step[self.free[i]] = sum / self.factor[i * n + i];
        }
        for i in (0..m).rev() {
            let mut sum = self.step[self.free[i]];
            for k in i + 1..m {
                sum -= self.factor[k * n + i] * self.step[self.free[k]];
            }
            self.step[self.free[i]] = sum / self.factor[i * n + i];
        }
        true
    }

    /// Goes towards the target as far as the true cost falls; true where that is all the way.
    fn go(&mut self, x: &mut [f64]) -> bool {
        for j in 0..self.n {
            self.step[j] = self.target[j] - x[j];
        }
        let (mut low, mut high) = (0.0, 1.0);
        if self.slope_along(x, 1.0) > 0.0 {
            // The slope along a line rises: halved until the place where it is none is known to a rounding.
            for _ in 0..52 {
                let middle = f64::midpoint(low, high);
                if self.slope_along(x, middle) > 0.0 { high = middle } else { low = middle }
            }
        } else {
            low = 1.0;
        }
        for j in 0..self.n {
            let to = if low == 1.0 { self.target[j] } else { x[j] + low * self.step[j] };
            x[j] = to.clamp(self.lower[j], self.upper[j]);
            self.step[j] *= low;
        }
        low == 1.0
    }

    /// Slope of the true cost along the step, at a share of it.
    fn slope_along(&self, x: &[f64], share: f64) -> f64 {
        let own: f64 = (0..self.n).map(|j| (x[j] + share * self.step[j] - self.wanted[j]) * self.step[j]).sum();
        let wishes = self.wishes().iter().filter(|w| w.weight > 0.0).map(|w| {
            let along = dot(&w.a, &self.step);
            let miss = dot(&w.a, x) - w.b + share * along;
            w.weight * along * if w.at_least { miss.min(0.0) } else { miss }
        });
        own + wishes.sum::<f64>()
    }
}

/// True where the wish adds to the cost at `x`, or is just about to.
fn counts(wish: &Wish, x: &[f64]) -> bool {
    !wish.at_least || dot(&wish.a, x) < wish.b
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
