//! A path as straight segments with corners between them, and the speeds at the corners.

use super::blend::Blend;
use super::limits::{TimeParametrizationError, in_direction, validate};
use super::speed_profile::bisect_greatest;
use super::speed_ramp::SpeedRamp;
use elbowroom_kinematics::JointLimits;

/// Distance below which waypoints count as one, rad.
const SAME_POINT_RAD: f64 = 1e-9;

/// The segments of a path and the limits of the joints.
#[derive(Debug, Clone)]
pub(crate) struct PathSegments {
    pub(super) segments: Vec<Segment>,
    pub(super) end: Vec<f64>,
    limits: Vec<JointLimits>,
}

/// A straight segment.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub from: Vec<f64>,
    /// Unit vector.
    pub direction: Vec<f64>,
    pub length: f64,
    pub limits: JointLimits,
}

/// A corner before a segment (or an end, speed 0): its speed and the duration of its blend.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Corner {
    pub speed: f64,
    pub seconds: f64,
}

impl Corner {
    /// Distance from the corner to the beginning and the end of the blend.
    pub fn blend_distance(self) -> f64 {
        0.5 * self.speed * self.seconds
    }
}

impl PathSegments {
    /// Checks waypoints and limits; removes repeated waypoints.
    pub fn new<Q: AsRef<[f64]>>(waypoints: &[Q], limits: &[JointLimits]) -> Result<Self, TimeParametrizationError> {
        let (Some(first), Some(last)) = (waypoints.first(), waypoints.last()) else {
            return Err(TimeParametrizationError::Path);
        };
        let (mut from, end) = (first.as_ref(), last.as_ref().to_vec());
        validate(limits, from.len())?;
        let is_valid = |q: &Q| q.as_ref().len() == from.len() && q.as_ref().iter().all(|x| x.is_finite());
        if !waypoints.iter().all(is_valid) {
            return Err(TimeParametrizationError::Path);
        }
        let mut segments = Vec::with_capacity(waypoints.len());
        for to in &waypoints[1..] {
            let to = to.as_ref();
            let difference: Vec<f64> = to.iter().zip(from).map(|(b, a)| b - a).collect();
            let length = difference.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > SAME_POINT_RAD {
                let direction: Vec<f64> = difference.iter().map(|x| x / length).collect();
                let limits = in_direction(limits, &direction);
                segments.push(Segment { from: from.to_vec(), direction, length, limits });
                from = to;
            }
        }
        Ok(Self { segments, end, limits: limits.to_vec() })
    }

    /// Number of segments; corner `n` is before segment `n`, for `1..count`.
    pub fn count(&self) -> usize {
        self.segments.len()
    }

    /// Half of the shorter segment at a corner.
    pub fn max_blend_distance(&self, corner: usize) -> f64 {
        0.5 * self.segments[corner - 1].length.min(self.segments[corner].length)
    }

    /// The triangle that contains the blend at a corner: one point on each segment, and the corner.
    pub fn triangle(&self, corner: usize, blend_distance: f64) -> [Vec<f64>; 3] {
        let (a, b) = (&self.segments[corner - 1], &self.segments[corner]);
        [
            point_along(&b.from, &a.direction, -blend_distance),
            b.from.clone(),
            point_along(&b.from, &b.direction, blend_distance),
        ]
    }

    /// The corners at their largest speeds. `blend_distances[n]` is the largest distance from corner `n` at which its
    /// blend begins: 0 to stop there; entry 0 is not used.
    pub(super) fn corners(&self, blend_distances: &[f64]) -> Vec<Corner> {
        let mut corners = vec![Corner::default(); self.count() + 1];
        for n in 1..self.count() {
            corners[n] = self.corner(n, blend_distances.get(n).copied().unwrap_or(0.0).min(self.max_blend_distance(n)));
        }
        self.limit_corner_speeds(&mut corners);
        corners
    }

    /// A corner at its largest speed.
    fn corner(&self, n: usize, blend_distance: f64) -> Corner {
        if !(blend_distance > 0.0) {
            return Corner::default();
        }
        let top = self.segments[n - 1].limits.velocity.min(self.segments[n].limits.velocity);
        let speed =
            bisect_greatest(0.0, top, |speed| self.corner_at_speed(n, speed).blend_distance() <= blend_distance);
        self.corner_at_speed(n, speed)
    }

    fn corner_at_speed(&self, n: usize, speed: f64) -> Corner {
        let directions = [&self.segments[n - 1].direction[..], &self.segments[n].direction];
        Corner { speed, seconds: Blend::seconds(speed, directions, &self.limits) }
    }

    /// Reduces the speeds at corners until each segment is long enough for its change of speed: a forward pass, then a
    /// backward pass.
    fn limit_corner_speeds(&self, corners: &mut [Corner]) {
        let fits = |segment: &Segment, a: Corner, b: Corner| {
            SpeedRamp::new(a.speed, b.speed, segment.limits).distance()
                <= segment.length - a.blend_distance() - b.blend_distance()
        };
        for n in 0..self.count().saturating_sub(1) {
            let (a, b) = (corners[n], corners[n + 1]);
            if b.speed > a.speed {
                let segment = &self.segments[n];
                let speed =
                    bisect_greatest(a.speed, b.speed, |speed| fits(segment, a, self.corner_at_speed(n + 1, speed)));
                corners[n + 1] = if speed < b.speed { self.corner_at_speed(n + 1, speed) } else { b };
            }
        }
        for n in (1..self.count()).rev() {
            let (a, b) = (corners[n], corners[n + 1]);
            if a.speed > b.speed {
                let segment = &self.segments[n];
                let speed = bisect_greatest(b.speed, a.speed, |speed| fits(segment, self.corner_at_speed(n, speed), b));
                corners[n] = if speed < a.speed { self.corner_at_speed(n, speed) } else { a };
            }
        }
    }
}

pub(super) fn point_along(from: &[f64], direction: &[f64], far: f64) -> Vec<f64> {
    from.iter().zip(direction).map(|(x, d)| x + d * far).collect()
}
