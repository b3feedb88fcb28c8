//! Blended paths: a polyline in joint space whose corners are replaced by smooth curves.

use super::super::limits::TimeParametrizationError;
use super::corner_blend::CornerBlend;
use super::path_element::PathElement;

/// Distance below which waypoints count as one, rad (m).
const SAME_POINT: f64 = 1e-9;
/// Difference below which directions count as equal: the waypoint between them is removed.
const SAME_DIRECTION: f64 = 1e-9;
/// Sum below which directions count as opposite: the motion rests there.
const OPPOSITE_DIRECTION: f64 = 1e-6;
/// Number of times that a refused blend is halved before the motion rests at the corner.
const MAX_HALVINGS: i32 = 24;
/// Fraction of a segment below which its straight stretch is omitted.
const NO_STRETCH: f64 = 1e-9;

/// A path of straight segments and corner blends, from rest to rest.
///
/// The tangent and its derivative by the path position are continuous except where the motion rests.
#[derive(Debug, Clone)]
pub struct BlendedPath {
    pub(super) sections: Vec<PathSection>,
    pub(super) start: Vec<f64>,
    pub(super) end: Vec<f64>,
}

/// A part of a path from rest to rest. Its first and last elements are straight.
#[derive(Debug, Clone)]
pub(super) struct PathSection {
    pub elements: Vec<PathElement>,
    pub length: f64,
}

/// A straight segment.
struct Leg<'q> {
    /// Index of the leg's first waypoint.
    waypoint: usize,
    from: &'q [f64],
    /// Unit vector.
    direction: Vec<f64>,
    length: f64,
}

impl<'q> Leg<'q> {
    fn new(waypoint: usize, from: &'q [f64], to: &[f64]) -> Self {
        let difference: Vec<f64> = to.iter().zip(from).map(|(b, a)| b - a).collect();
        let length = norm(difference.iter().copied());
        Self { waypoint, from, direction: difference.iter().map(|x| x / length).collect(), length }
    }
}

impl BlendedPath {
    /// Replaces the corners of a polyline by blends.
    ///
    /// Each blend begins and ends half a segment from its corner. Until `is_free` accepts the blend, this distance is
    /// halved, down to 10⁻⁷ of the first. The motion rests where the path turns back by 180 degrees, and at corners
    /// without an accepted blend.
    ///
    /// Positions are in rad (m for prismatic joints). Waypoints within 10⁻⁹ of the previous one, or without a change of
    /// direction, are removed.
    ///
    /// # Errors
    /// [`TimeParametrizationError::Path`]: there are no waypoints, or one is not finite or has another number of
    /// values.
    pub fn new<Q: AsRef<[f64]>>(
        waypoints: &[Q],
        mut is_free: impl FnMut(&CornerBlend) -> bool,
    ) -> Result<Self, TimeParametrizationError> {
        let legs = legs(waypoints)?;
        let distances: Vec<f64> = (1..legs.len()).map(|n| blend_distance(&legs[n - 1..=n], &mut is_free)).collect();
        let ends = [waypoints.first(), waypoints.last()].map(|q| q.map_or(Vec::new(), |q| q.as_ref().to_vec()));
        let [start, end] = ends;
        Ok(Self { sections: sections(&legs, &distances), start, end })
    }

    /// Number of corners at which the motion rests.
    pub fn stops(&self) -> usize {
        self.sections.len().saturating_sub(1)
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.start.len()
    }

    /// Length of the polyline that remains and of the blends' legs: the Euclidean norm over all joints, rad (m).
    pub fn length(&self) -> f64 {
        self.sections.iter().map(|s| s.length).sum()
    }
}

fn norm(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|x| x * x).sum::<f64>().sqrt()
}

/// Checks waypoints and connects different ones; a leg that continues in the direction of the previous leg prolongs it.
fn legs<Q: AsRef<[f64]>>(waypoints: &[Q]) -> Result<Vec<Leg<'_>>, TimeParametrizationError> {
    let first = waypoints.first().ok_or(TimeParametrizationError::Path)?.as_ref();
    let is_valid = |q: &Q| q.as_ref().len() == first.len() && q.as_ref().iter().all(|x| x.is_finite());
    if !waypoints.iter().all(is_valid) {
        return Err(TimeParametrizationError::Path);
    }
    let mut legs: Vec<Leg> = Vec::new();
    let (mut from, mut index) = (first, 0);
    for (n, to) in waypoints.iter().enumerate().skip(1) {
        let to = to.as_ref();
        let leg = Leg::new(index, from, to);
        if leg.length <= SAME_POINT {
            continue;
        }
        if !leg.length.is_finite() {
            return Err(TimeParametrizationError::Path);
        }
        (from, index) = (to, n);
        match legs.last_mut() {
            Some(last) if differ(&last.direction, &leg.direction, -1.0) < SAME_DIRECTION => {
                *last = Leg::new(last.waypoint, last.from, to);
            }
            _ => legs.push(leg),
        }
    }
    Ok(legs)
}

/// Norm of `a + sign·b`.
fn differ(a: &[f64], b: &[f64], sign: f64) -> f64 {
    norm(a.iter().zip(b).map(|(a, b)| a + sign * b))
}

/// The largest accepted blend distance at the corner between two legs; 0 to rest there.
fn blend_distance(legs: &[Leg], is_free: &mut impl FnMut(&CornerBlend) -> bool) -> f64 {
    let [a, b] = legs else { return 0.0 };
    if differ(&a.direction, &b.direction, 1.0) < OPPOSITE_DIRECTION {
        return 0.0;
    }
    let most = 0.5 * a.length.min(b.length);
    let halves = (0..=MAX_HALVINGS).map(|n| most * 0.5_f64.powi(n));
    let mut blends = halves.map(|distance| CornerBlend {
        waypoint: b.waypoint,
        corner: b.from,
        before: &a.direction,
        after: &b.direction,
        distance,
    });
    blends.find(|blend| is_free(blend)).map_or(0.0, |blend| blend.distance)
}

/// `distances[n]` is the blend distance between legs n and n + 1.
fn sections(legs: &[Leg], distances: &[f64]) -> Vec<PathSection> {
    let mut sections = Vec::new();
    let mut elements: Vec<PathElement> = Vec::new();
    let mut position = 0.0;
    for (n, leg) in legs.iter().enumerate() {
        let before = if n > 0 { distances[n - 1] } else { 0.0 };
        let after = distances.get(n).copied().unwrap_or(0.0);
        let length = leg.length - before - after;
        if length > NO_STRETCH * leg.length {
            elements.push(element(leg, before, position, length, Vec::new()));
            position += length;
        }
        if after > 0.0 {
            let turn = legs[n + 1].direction.iter().zip(&leg.direction).map(|(v, u)| v - u).collect();
            elements.push(element(leg, leg.length - after, position, 2.0 * after, turn));
            position += 2.0 * after;
        } else {
            sections.push(PathSection { elements: std::mem::take(&mut elements), length: position });
            position = 0.0;
        }
    }
    sections
}

/// An element that begins on a leg.
fn element(leg: &Leg, offset: f64, begin: f64, length: f64, turn: Vec<f64>) -> PathElement {
    let from = leg.from.iter().zip(&leg.direction).map(|(q, d)| q + d * offset).collect();
    PathElement { begin, length, from, direction: leg.direction.clone(), turn }
}
