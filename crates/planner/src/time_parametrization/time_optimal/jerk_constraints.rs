//! Jerk constraints: limits of velocity, acceleration and jerk at collocation points of a path, in terms of the squared speed.
//!
//! With `x = ṡ²`, `b = s̈` and `c = s⃛/ṡ`, the acceleration of a joint is `q″x + q′b`, and its jerk
//! `√x·(q‴x + 3q″b + q′c)`: divided by √x, all but the bound of the jerk is linear in (x, b, c).

use std::ops::Range;

use super::super::limits::KinematicLimits;
use super::blended_path::PathSection;
use super::path_element::PathElement;
use super::path_grid::PathGrid;
use super::speed_spline::{LocalMap, SpeedSpline, apply};

/// At rest the jerk is constant: over a length s, `x = REST_FACTOR·(jerk²·s⁴)^(1/3)`.
const REST_FACTOR: f64 = 2.725_680_889_248_209;
/// Share of a limit that the first profile uses.
const FIRST_SHARE: f64 = 0.8;

/// A joint's acceleration by x and b, divided by its limit.
pub(super) type AccelerationRow = [f64; 2];
/// A joint's jerk by x, b and c, divided by √x and its limit.
pub(super) type JerkRow = [f64; 3];

/// A point at which constraints are evaluated.
#[derive(Debug, Clone)]
pub(super) struct Collocation {
    pub interval: usize,
    pub map: LocalMap,
    /// Duration is the sum of `weight/√x`.
    pub weight: f64,
    pub x_max: f64,
    pub accelerations: Range<usize>,
    pub jerks: Range<usize>,
}

/// All constraints of a section.
#[derive(Debug, Default)]
pub(super) struct JerkConstraints {
    pub points: Vec<Collocation>,
    pub accelerations: Vec<AccelerationRow>,
    pub jerks: Vec<JerkRow>,
}

impl JerkConstraints {
    /// On straight segments both ends of each interval; in blends its beginning for acceleration, its middle for jerk.
    pub fn new(section: &PathSection, grid: &PathGrid, spline: &SpeedSpline, limits: &KinematicLimits) -> Self {
        let mut all = Self::default();
        let last = grid.intervals() - 1;
        for interval in 1..last {
            let element = &section.elements[grid.elements[interval] as usize];
            let h = grid.spacing(interval);
            if element.is_straight() {
                all.add_straight(element, interval, h, spline, limits);
            } else {
                all.add_blend(element, interval, grid.nodes[interval], h, spline, limits);
            }
        }
        let count = all.points.len();
        for (point, rest) in [(0, 0), (count - 1, last)] {
            let jerk = all.jerks[all.points[point].jerks.start][2].recip();
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
        for share in [0.0, 1.0] {
            let first = self.rows();
            self.accelerations.push([0.0, along.acceleration.recip()]);
            self.jerks.push([0.0, 0.0, along.jerk.recip()]);
            self.add_point(interval, spline.local_map(interval, share), 0.5 * h, along.speed * along.speed, first);
        }
    }

    fn add_blend(
        &mut self,
        element: &PathElement,
        interval: usize,
        s: f64,
        h: f64,
        spline: &SpeedSpline,
        limits: &KinematicLimits,
    ) {
        for (share, weight) in [(0.0, 0.5), (0.5, 0.0), (1.0, 0.5)] {
            let first = self.rows();
            let mut x_max = f64::INFINITY;
            for joint in 0..limits.velocity.len() {
                let [v, a, j] = [limits.velocity[joint], limits.acceleration[joint], limits.jerk[joint]];
                let [_, p, c, d] = element.at(s + share * h, joint);
                x_max = x_max.min((v / p).powi(2)).min(a / c.abs());
                if share < 1.0 {
                    self.accelerations.push([c / a, p / a]);
                }
                if share != 0.5 {
                    self.jerks.push([d / j, 3.0 * c / j, p / j]);
                }
            }
            self.add_point(interval, spline.local_map(interval, share), weight * h, x_max, first);
        }
    }

    /// Numbers of rows of acceleration and jerk.
    fn rows(&self) -> [usize; 2] {
        [self.accelerations.len(), self.jerks.len()]
    }

    /// A point with all rows from `first` on.
    fn add_point(&mut self, interval: usize, map: LocalMap, weight: f64, x_max: f64, first: [usize; 2]) {
        let [accelerations, jerks] = [first[0]..self.rows()[0], first[1]..self.rows()[1]];
        self.points.push(Collocation { interval, map, weight, x_max, accelerations, jerks });
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
        for row in &self.accelerations[point.accelerations.clone()] {
            factor = factor.min(FIRST_SHARE / (row[0] * x + row[1] * b).abs());
        }
        for row in &self.jerks[point.jerks.clone()] {
            let jerk = x.sqrt() * (row[0] * x + row[1] * b + row[2] * c);
            factor = factor.min((FIRST_SHARE / jerk.abs()).powi(2).cbrt());
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
