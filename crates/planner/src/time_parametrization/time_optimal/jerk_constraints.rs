//! Jerk constraints: limits of velocity, acceleration and jerk at collocation points of a path, in terms of the squared speed.
//!
//! With `x = ṡ²`, `b = s̈` and `c = s⃛/ṡ`, the acceleration of a joint is `q″x + q′b`, and its jerk
//! `√x·(q‴x + 3q″b + q′c)`: divided by √x, all but the bound of the jerk is linear in (x, b, c).

use super::super::limits::KinematicLimits;
use super::blended_path::PathSection;
use super::path_element::PathElement;
use super::path_grid::PathGrid;
use super::speed_spline::{LocalMap, SpeedSpline, apply};

/// At rest the jerk is constant: over a length s, `x = REST_FACTOR·(jerk²·s⁴)^(1/3)`.
const REST_FACTOR: f64 = 2.725_680_889_248_209;
/// Share of a limit that the first profile uses.
const FIRST_SHARE: f64 = 0.8;

/// A joint's coefficients of acceleration and jerk, each divided by its limit.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointRow {
    /// By x and b.
    pub acceleration: [f64; 2],
    /// By x, b and c.
    pub jerk: [f64; 3],
}

/// A point at which constraints are evaluated.
#[derive(Debug, Clone)]
pub(super) struct Collocation {
    pub interval: usize,
    pub map: LocalMap,
    /// Duration is the sum of `weight/√x`.
    pub weight: f64,
    pub x_max: f64,
    pub rows: std::ops::Range<usize>,
}

/// All constraints of a section.
#[derive(Debug, Default)]
pub(super) struct JerkConstraints {
    pub points: Vec<Collocation>,
    pub rows: Vec<JointRow>,
}

impl JerkConstraints {
    /// The middle of each interval of a blend, both ends of those of straight segments.
    pub fn new(section: &PathSection, grid: &PathGrid, spline: &SpeedSpline, limits: &KinematicLimits) -> Self {
        let mut all = Self::default();
        let last = grid.intervals() - 1;
        for interval in 1..last {
            let element = &section.elements[grid.elements[interval] as usize];
            let h = grid.spacing(interval);
            if element.is_straight() {
                all.add_straight(element, interval, h, spline, limits);
            } else {
                let middle = 0.5 * (grid.nodes[interval] + grid.nodes[interval + 1]);
                all.add_blend(element, middle, interval, h, spline, limits);
            }
        }
        let count = all.points.len();
        for (point, rest) in [(0, 0), (count - 1, last)] {
            let jerk = all.rows[all.points[point].rows.start].jerk[2].recip();
            let (s, point) = (grid.spacing(rest), &mut all.points[point]);
            point.x_max = point.x_max.min(REST_FACTOR * (jerk * jerk * s).cbrt() * s);
            point.weight += 3.0 * s;
        }
        all
    }

    fn add_straight(
        &mut self,
        element: &PathElement,
        interval: usize,
        h: f64,
        spline: &SpeedSpline,
        limits: &KinematicLimits,
    ) {
        let along = limits.in_direction(&element.direction);
        let row = JointRow { acceleration: [0.0, along.acceleration.recip()], jerk: [0.0, 0.0, along.jerk.recip()] };
        for share in [0.0, 1.0] {
            self.rows.push(row);
            let rows = self.rows.len() - 1..self.rows.len();
            let map = spline.local_map(interval, share);
            self.points.push(Collocation { interval, map, weight: 0.5 * h, x_max: along.speed * along.speed, rows });
        }
    }

    fn add_blend(
        &mut self,
        element: &PathElement,
        s: f64,
        interval: usize,
        h: f64,
        spline: &SpeedSpline,
        limits: &KinematicLimits,
    ) {
        let first = self.rows.len();
        let mut x_max = f64::INFINITY;
        for (joint, (a, j)) in limits.acceleration.iter().zip(&limits.jerk).enumerate() {
            let [_, p, c, d] = element.at(s, joint);
            x_max = x_max.min((limits.velocity[joint] / p).powi(2)).min(a / c.abs());
            self.rows.push(JointRow { acceleration: [c / a, p / a], jerk: [d / j, 3.0 * c / j, p / j] });
        }
        let (map, rows) = (spline.local_map(interval, 0.5), first..self.rows.len());
        self.points.push(Collocation { interval, map, weight: h, x_max, rows });
    }

    /// Coefficients that satisfy all constraints strictly: a profile that keeps the jerk's limit at every constant speed, made
    /// slower as a whole. `most` is the greatest squared speed at each node, under limits of velocity and acceleration.
    pub fn feasible_coefficients(
        &self,
        section: &PathSection,
        grid: &PathGrid,
        limits: &KinematicLimits,
        most: &[f64],
    ) -> Vec<f64> {
        let x = slow_profile(section, grid, limits, most);
        let mut coefficients: Vec<f64> = x.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let factor = self.points.iter().map(|point| self.largest_factor(point, &coefficients)).fold(1.0, f64::min);
        for x in &mut coefficients {
            *x *= factor;
        }
        coefficients
    }

    /// By which factor the squared speed may be multiplied at a point.
    fn largest_factor(&self, point: &Collocation, coefficients: &[f64]) -> f64 {
        let [x, b, c] = apply(&point.map, &coefficients[point.interval - 1..=point.interval + 1]);
        let mut factor = FIRST_SHARE * point.x_max / x;
        for row in &self.rows[point.rows.clone()] {
            let acceleration = row.acceleration[0] * x + row.acceleration[1] * b;
            let jerk = x.sqrt() * (row.jerk[0] * x + row.jerk[1] * b + row.jerk[2] * c);
            factor = factor.min(FIRST_SHARE / acceleration.abs()).min((FIRST_SHARE / jerk.abs()).powi(2).cbrt());
        }
        factor
    }
}

/// Squared speeds at the nodes: half of the most, and no faster than constant jerk reaches from either side.
fn slow_profile(section: &PathSection, grid: &PathGrid, limits: &KinematicLimits, most: &[f64]) -> Vec<f64> {
    let jerks: Vec<[f64; 2]> = section.elements.iter().map(|e| path_jerk(e, limits)).collect();
    let of = |interval: usize| jerks[grid.elements[interval] as usize];
    let mut x: Vec<f64> = most.iter().map(|x| 0.5 * x).collect();
    for n in 0..grid.intervals() {
        let [_, cap] = of(n);
        (x[n], x[n + 1]) = (x[n].min(cap), x[n + 1].min(cap));
    }
    let reached = |x: f64, jerk: f64, h: f64| {
        let s = (x / (REST_FACTOR * (jerk * jerk).cbrt())).powf(0.75) + h;
        REST_FACTOR * (jerk * jerk * s).cbrt() * s
    };
    for n in 0..grid.intervals() {
        x[n + 1] = x[n + 1].min(reached(x[n], of(n)[0], grid.spacing(n)));
    }
    for n in (0..grid.intervals()).rev() {
        x[n] = x[n].min(reached(x[n + 1], of(n)[0], grid.spacing(n)));
    }
    x
}

/// Greatest `s⃛` at rest, and greatest squared speed that is constant over an element.
fn path_jerk(element: &PathElement, limits: &KinematicLimits) -> [f64; 2] {
    let along = |direction: f64, limit: f64| limit / direction.abs();
    let [mut jerk, mut x] = [f64::INFINITY; 2];
    for (joint, limit) in limits.jerk.iter().enumerate() {
        let turn = element.turn.get(joint).copied().unwrap_or(0.0);
        let tangent = element.direction[joint];
        jerk = jerk.min(along(tangent.abs().max((tangent + turn).abs()), *limit));
        x = x.min((along(6.0 * turn, *limit) * element.length.powi(2)).powi(2).cbrt());
    }
    [jerk, x]
}
