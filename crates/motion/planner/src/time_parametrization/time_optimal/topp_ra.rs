//! Time-optimal path parametrization by reachability analysis (TOPP-RA) under limits of velocity and acceleration.
//!
//! H. Pham, Q.-C. Pham: *A New Approach to Time-Optimal Path Parameterization Based on Reachability Analysis*, IEEE
//! With `x = ṡ²` and `u = s̈`, constant over an interval, constraints are linear in (u, x). The backward pass computes
//! the controllable sets; they are intervals from 0, because rest is always admissible. The forward pass uses the
//! largest `u` that stays in these sets.

use super::super::limits::in_direction;
use super::blended_path::PathSection;
use super::limit_excess::Ratios;
use super::path_grid::PathGrid;
use elbowroom_kinematics::JointLimits;

/// Largest number of Newton steps for the largest controllable `x`: each step leaves one line of a polygon.
const MAX_STEPS: usize = 64;

/// `−1 ≤ u·a + x·b ≤ 1`, see [`control_range`].
#[derive(Debug, Clone, Copy)]
struct Row {
    a: f64,
    b: f64,
}

/// The constraints of all intervals of a grid.
#[derive(Debug, Default)]
pub(super) struct ReachabilityAnalysis {
    rows: Vec<Row>,
    /// Index of the first row of each interval, then the number of rows.
    first: Vec<usize>,
    /// Largest `x` at each node by velocity and by constraints that do not depend on `u`.
    x_max: Vec<f64>,
}

/// A bound of `u` that is linear in x.
#[derive(Debug, Clone, Copy)]
struct Bound {
    intercept: f64,
    slope: f64,
}

impl Bound {
    fn at(self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }
}

impl ReachabilityAnalysis {
    /// The largest squared speed at each node of the grid, from rest to rest.
    pub fn squared_speeds(&self, grid: &PathGrid) -> Vec<f64> {
        let count = grid.intervals();
        let mut controllable = vec![0.0; count + 1];
        for n in (0..count).rev() {
            controllable[n] = greatest_controllable(self.of(n), grid.spacing(n), controllable[n + 1], self.x_max[n]);
        }
        let mut x = vec![0.0; count + 1];
        for n in 0..count {
            let spacing = grid.spacing(n);
            let [low, high] = control_range(self.of(n), spacing, controllable[n + 1], x[n]);
            let u = high.at(x[n]).max(low.at(x[n]));
            x[n + 1] = (x[n] + 2.0 * spacing * u).clamp(0.0, controllable[n + 1]);
        }
        x
    }

    /// Makes the constraints of each interval stronger by the given ratios.
    pub fn tighten(&mut self, ratios: &[Ratios]) {
        for (n, [v, a, _]) in ratios.iter().enumerate() {
            for row in &mut self.rows[self.first[n]..self.first[n + 1]] {
                *row = Row { a: row.a * a.max(1.0), b: row.b * a.max(1.0) };
            }
            for x in &mut self.x_max[n..=n + 1] {
                *x /= v.max(1.0).powi(2);
            }
        }
    }

    pub fn new(section: &PathSection, grid: &PathGrid, limits: &[JointLimits]) -> Self {
        let mut all = Self { x_max: vec![f64::INFINITY; grid.nodes.len()], ..Self::default() };
        for n in 0..grid.intervals() {
            all.first.push(all.rows.len());
            let element = &section.elements[grid.elements[n] as usize];
            if element.is_straight() {
                let along = in_direction(limits, &element.direction);
                for x in &mut all.x_max[n..=n + 1] {
                    *x = x.min(along.velocity * along.velocity);
                }
                all.rows.push(Row { a: 1.0 / along.acceleration, b: 0.0 });
                continue;
            }
            let h = grid.spacing(n);
            for joint in 0..limits.len() {
                let [v, a] = [limits[joint].velocity, limits[joint].acceleration];
                for share in [0.0, 0.5, 1.0] {
                    let [_, p, c, _] = element.at(grid.nodes[n] + share * h, joint);
                    // At that point, x is greater by 2·share·h·u.
                    all.rows.push(Row { a: (p + 2.0 * share * h * c) / a, b: c / a });
                    if share != 0.5 {
                        let x = &mut all.x_max[n + share as usize];
                        *x = x.min((v / p).powi(2)).min(a / c.abs());
                    }
                }
            }
        }
        all.first.push(all.rows.len());
        all
    }

    fn of(&self, interval: usize) -> &[Row] {
        &self.rows[self.first[interval]..self.first[interval + 1]]
    }
}

/// The active bounds of `u` at a squared speed, such that the next squared speed is in `0..=next`.
fn control_range(rows: &[Row], spacing: f64, next: f64, x: f64) -> [Bound; 2] {
    let slope = -0.5 / spacing;
    let mut low = Bound { intercept: 0.0, slope };
    let mut high = Bound { intercept: -next * slope, slope };
    let [mut most, mut least] = [low.at(x), high.at(x)];
    for row in rows {
        let (inverse, slope) = (1.0 / row.a.abs(), -row.b / row.a);
        let [below, above] = [-inverse, inverse].map(|intercept| Bound { intercept, slope });
        if below.at(x) > most {
            (low, most) = (below, below.at(x));
        }
        if above.at(x) < least {
            (high, least) = (above, above.at(x));
        }
    }
    [low, high]
}

/// The largest squared speed from which some `u` leads into `0..=next`. The width of the range of `u` is concave in x,
/// so Newton's method from above ends at its root.
fn greatest_controllable(rows: &[Row], spacing: f64, next: f64, x_max: f64) -> f64 {
    let mut x = x_max;
    for _ in 0..MAX_STEPS {
        let [low, high] = control_range(rows, spacing, next, x);
        if high.at(x) >= low.at(x) {
            return x;
        }
        // Computed without a difference from x, which may be greater by many powers of ten.
        let root = (high.intercept - low.intercept) / (low.slope - high.slope);
        if !(root >= 0.0 && root < x) {
            return x;
        }
        x = root;
    }
    x
}
