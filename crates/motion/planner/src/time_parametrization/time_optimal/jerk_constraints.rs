//! Jerk constraints: limits of velocity, acceleration and jerk at collocation points of a path, in terms of the squared
//! speed.
//!
//! With `x = ṡ²`, `b = s̈` and `c = s⃛/ṡ`, the acceleration of a joint is `q″x + q′b`, and its jerk is
//! `√x·(q‴x + 3q″b + q′c)`. After division by √x, everything except the bound of the jerk is linear in (x, b, c).

use elbowroom_kinematics::JointLimits;
use std::ops::Range;

use super::super::limits::in_direction;
use super::blended_path::PathSection;
use super::limit_excess::Ratios;
use super::path_element::PathElement;
use super::path_grid::PathGrid;
use super::speed_spline::{LocalMap, SpeedSpline, apply, around};

/// At rest the jerk is constant: over a length s, `x = REST_FACTOR·(jerk²·s⁴)^(1/3)`.
const REST_FACTOR: f64 = 2.725_680_889_248_209;
/// Factor by which squared speeds may exceed the result of TOPP-RA, whose grid is another approximation.
const MOST_FACTOR: f64 = 1.1;
/// Fraction of a limit that the first profile uses.
const FIRST_SHARE: f64 = 0.95;

/// Coefficients of x and b in a joint's acceleration, divided by its limit.
pub(super) type AccelerationRow = [f64; 2];
/// Coefficients of x, b and c in a joint's jerk, divided by √x and its limit.
pub(super) type JerkRow = [f64; 3];

/// A point at which constraints are evaluated.
#[derive(Debug, Clone)]
pub(super) struct Collocation {
    /// Distance from the beginning of the interval.
    pub offset: f64,
    /// Weight in the duration, which is the sum of `weight/√x`.
    pub weight: f64,
    /// Reciprocal of the largest x.
    pub x_factor: f64,
    pub accelerations: Range<usize>,
    pub jerks: Range<usize>,
}

/// The collocation points of an interval.
#[derive(Debug, Clone)]
pub(super) struct IntervalPoints {
    pub index: usize,
    /// Map to x, b and c at the beginning of the interval.
    pub map: LocalMap,
    pub points: Range<usize>,
}

impl Collocation {
    /// Computes x, b and c from their values at the beginning of the interval.
    #[inline]
    pub fn at_offset(&self, [x, b, c]: [f64; 3]) -> [f64; 3] {
        [x + self.offset * (2.0 * b + self.offset * c), b + self.offset * c, c]
    }
}

/// All constraints of a section.
#[derive(Debug, Default)]
pub(super) struct JerkConstraints {
    pub intervals: Vec<IntervalPoints>,
    pub points: Vec<Collocation>,
    pub accelerations: Vec<AccelerationRow>,
    pub jerks: Vec<JerkRow>,
}

impl JerkConstraints {
    /// Limits jerk at both ends of each interval, as it jumps there; acceleration at the beginning of each interval,
    /// and in blends also in the middle.
    pub fn new(
        section: &PathSection,
        grid: &PathGrid,
        spline: &SpeedSpline,
        limits: &[JointLimits],
        most: &[f64],
    ) -> Self {
        let mut all = Self::default();
        let last = grid.intervals() - 1;
        for interval in 1..last {
            let element = &section.elements[grid.elements[interval] as usize];
            let (h, first) = (grid.spacing(interval), all.points.len());
            if element.is_straight() {
                all.add_straight(element, h, interval + 1 == last, limits);
            } else {
                let most = MOST_FACTOR * most[interval].max(most[interval + 1]);
                all.add_blend(element, grid.nodes[interval], h, most, limits);
            }
            let points = first..all.points.len();
            all.intervals.push(IntervalPoints { index: interval, map: spline.local_map(interval, 0.0), points });
        }
        let count = all.points.len();
        for (point, rest) in [(0, 0), (count - 1, last)] {
            let jerk = all.jerks[all.points[point].jerks.start][2].recip();
            let (s, point) = (grid.spacing(rest), &mut all.points[point]);
            point.x_factor = point.x_factor.max(1.0 / (REST_FACTOR * (jerk * jerk * s).cbrt() * s));
            point.weight += 3.0 * s;
        }
        all
    }

    /// The next interval begins with the acceleration that this one ends with, unless it is the last.
    fn add_straight(&mut self, element: &PathElement, h: f64, is_last: bool, limits: &[JointLimits]) {
        let along = in_direction(limits, &element.direction);
        for share in [0.0, 1.0] {
            let first = self.rows();
            if share == 0.0 || is_last {
                self.accelerations.push([0.0, along.acceleration.recip()]);
            }
            self.jerks.push([0.0, 0.0, along.jerk.recip()]);
            self.add_point(share * h, 0.5 * h, along.velocity * along.velocity, first);
        }
    }

    fn add_blend(&mut self, element: &PathElement, s: f64, h: f64, most: f64, limits: &[JointLimits]) {
        for (share, weight) in [(0.0, 0.5), (0.5, 0.0), (1.0, 0.5)] {
            let first = self.rows();
            let derivatives = (0..limits.len()).map(|joint| element.at(s + share * h, joint));
            let mut x_max = f64::INFINITY;
            for (joint, [_, p, c, d]) in derivatives.enumerate() {
                let [v, a, j] = [limits[joint].velocity, limits[joint].acceleration, limits[joint].jerk];
                x_max = x_max.min((v / p).powi(2)).min(a / c.abs());
                if share < 1.0 {
                    self.accelerations.push([c / a, p / a]);
                }
                if share != 0.5 {
                    self.jerks.push([d / j, 3.0 * c / j, p / j]);
                }
            }
            let b_max = leave_out_slack_accelerations(&mut self.accelerations, first[0], most);
            if share != 0.5 {
                leave_out_slack_jerks(&mut self.jerks, first[1], most, b_max);
            }
            self.add_point(share * h, weight * h, x_max, first);
        }
    }

    /// Makes the constraints of each interval of the grid stronger by the given ratios.
    pub fn tighten(&mut self, ratios: &[Ratios]) {
        for interval in &self.intervals {
            let [v, a, j] = ratios[interval.index].map(|ratio| ratio.max(1.0));
            for point in &mut self.points[interval.points.clone()] {
                point.x_factor *= v * v;
                self.accelerations[point.accelerations.clone()].iter_mut().flatten().for_each(|x| *x *= a);
                self.jerks[point.jerks.clone()].iter_mut().flatten().for_each(|x| *x *= j);
            }
        }
    }

    /// Number of rows of acceleration and of jerk.
    fn rows(&self) -> [usize; 2] {
        [self.accelerations.len(), self.jerks.len()]
    }

    /// Adds a point with all rows from `first` on.
    fn add_point(&mut self, offset: f64, weight: f64, x_max: f64, first: [usize; 2]) {
        let [accelerations, jerks] = [first[0]..self.rows()[0], first[1]..self.rows()[1]];
        self.points.push(Collocation { offset, weight, x_factor: x_max.recip(), accelerations, jerks });
    }

    /// Computes coefficients that satisfy all constraints strictly: a profile that keeps the limit of jerk at every
    /// constant speed, slowed down as a whole. `most` is the largest squared speed at each node under limits of
    /// velocity and acceleration.
    pub fn feasible_coefficients(
        &self,
        section: &PathSection,
        grid: &PathGrid,
        limits: &[JointLimits],
        most: &[f64],
    ) -> Vec<f64> {
        let x = slow_profile(section, grid, limits, most);
        self.made_feasible(x.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect())
    }

    /// Reduces coefficients by one factor until all constraints are satisfied strictly.
    pub fn made_feasible(&self, mut coefficients: Vec<f64>) -> Vec<f64> {
        let factor = self.largest_factor(&coefficients);
        for x in &mut coefficients {
            *x *= factor;
        }
        coefficients
    }

    /// All points with x, b and c.
    fn states(&self, coefficients: &[f64]) -> impl Iterator<Item = (&Collocation, [f64; 3])> {
        self.intervals.iter().flat_map(move |interval| {
            let begin = apply(&interval.map, around(coefficients, interval.index));
            self.points[interval.points.clone()].iter().map(move |point| (point, point.at_offset(begin)))
        })
    }

    /// An approximation of the duration.
    pub fn duration(&self, coefficients: &[f64]) -> f64 {
        self.states(coefficients).map(|(point, [x, ..])| point.weight / x.sqrt()).sum()
    }

    /// Largest factor, at most 1, by which the squared speed may be multiplied.
    fn largest_factor(&self, coefficients: &[f64]) -> f64 {
        // Fractions of the limits of speed and acceleration, and the squared fraction of the limit of jerk.
        let (mut most, mut jerk): (f64, f64) = (FIRST_SHARE, FIRST_SHARE * FIRST_SHARE);
        for (point, [x, b, c]) in self.states(coefficients) {
            most = most.max(x * point.x_factor);
            for row in &self.accelerations[point.accelerations.clone()] {
                most = most.max((row[0] * x + row[1] * b).abs());
            }
            for row in &self.jerks[point.jerks.clone()] {
                jerk = jerk.max(x * (row[0] * x + row[1] * b + row[2] * c).powi(2));
            }
        }
        (FIRST_SHARE / most).min((FIRST_SHARE * FIRST_SHARE / jerk).cbrt())
    }
}

/// Removes rows of acceleration, from index `from` on, that another row implies while the squared speed is at most
/// `most`; returns the largest `|b|`.
fn leave_out_slack_accelerations(rows: &mut Vec<AccelerationRow>, from: usize, most: f64) -> f64 {
    let Some(&[c, p]) = rows[from..].iter().max_by(|r, s| r[1].abs().total_cmp(&s[1].abs())) else {
        return f64::INFINITY;
    };
    retain_from(rows, from, |row| {
        let ratio = row[1] / p;
        ratio.abs() == 1.0 || !(ratio.abs() + (row[0] - ratio * c).abs() * most < 1.0)
    });
    (1.0 + c.abs() * most) / p.abs()
}

/// Removes rows of jerk, from index `from` on, that another row implies while the squared speed is at most `most`.
fn leave_out_slack_jerks(rows: &mut Vec<JerkRow>, from: usize, most: f64, b_max: f64) {
    let Some(&[d, c, p]) = rows[from..].iter().max_by(|r, s| r[2].abs().total_cmp(&s[2].abs())) else { return };
    retain_from(rows, from, |row| {
        let ratio = row[2] / p;
        let rest = (row[0] - ratio * d).abs() * most + (row[1] - ratio * c).abs() * b_max;
        ratio.abs() == 1.0 || !(ratio.abs() + rest * most.sqrt() < 1.0)
    });
}

/// `Vec::retain` for the rows from index `from` on.
fn retain_from<T: Copy>(rows: &mut Vec<T>, from: usize, keep: impl Fn(&T) -> bool) {
    let mut kept = from;
    for index in from..rows.len() {
        if keep(&rows[index]) {
            rows[kept] = rows[index];
            kept += 1;
        }
    }
    rows.truncate(kept);
}

/// Squared speeds at the nodes: half of `most`, and at most the speed that constant jerk reaches from either side.
fn slow_profile(section: &PathSection, grid: &PathGrid, limits: &[JointLimits], most: &[f64]) -> Vec<f64> {
    let jerks: Vec<[f64; 2]> = section.elements.iter().map(|e| path_jerk(e, limits)).collect();
    let of = |interval: usize| jerks[grid.elements[interval] as usize];
    let mut x: Vec<f64> = most.iter().map(|x| 0.5 * x).collect();
    for n in 0..grid.intervals() {
        let [_, cap] = of(n);
        (x[n], x[n + 1]) = (x[n].min(cap), x[n + 1].min(cap));
    }
    let reached = |x: f64, scale: f64, h: f64| {
        let root = (x / scale).sqrt();
        let s = root * root.sqrt() + h;
        scale * s * s.cbrt()
    };
    for n in 0..grid.intervals() {
        x[n + 1] = x[n + 1].min(reached(x[n], of(n)[0], grid.spacing(n)));
    }
    for n in (0..grid.intervals()).rev() {
        x[n] = x[n].min(reached(x[n + 1], of(n)[0], grid.spacing(n)));
    }
    x
}

/// Two properties of an element: the factor of s^(4/3) in the squared speed after a length s from rest, and the largest
/// squared speed that is constant over the element.
fn path_jerk(element: &PathElement, limits: &[JointLimits]) -> [f64; 2] {
    let along = |direction: f64, limit: f64| limit / direction.abs();
    let [mut jerk, mut x] = [f64::INFINITY; 2];
    for (joint, JointLimits { jerk: limit, .. }) in limits.iter().enumerate() {
        let turn = element.turn.get(joint).copied().unwrap_or(0.0);
        let tangent = element.direction[joint];
        jerk = jerk.min(along(tangent.abs().max((tangent + turn).abs()), *limit));
        x = x.min((along(6.0 * turn, *limit) * element.length.powi(2)).powi(2).cbrt());
    }
    [REST_FACTOR * (jerk * jerk).cbrt(), x]
}
