//! A path before it is timed: straight legs, and corners between them with some room to round them.

use super::blend::Blend;
use super::leg::greatest;
use super::limits::{Along, MotionError, MotionLimits};
use super::ramp::Ramp;
use super::trajectory::Trajectory;

/// Waypoints nearer than this are one, rad.
const SAME: f64 = 1e-9;

/// A path's legs and what the joints may do.
#[derive(Debug, Clone)]
pub(crate) struct Legs {
    pub(super) stretches: Vec<Stretch>,
    pub(super) end: Vec<f64>,
    limits: MotionLimits,
}

/// One of them.
#[derive(Debug, Clone)]
pub(super) struct Stretch {
    pub from: Vec<f64>,
    /// Unit vector.
    pub direction: Vec<f64>,
    pub length: f64,
    pub limits: Along,
}

/// A corner before a leg (or an end, speed 0): how fast it is passed and how long the blend takes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Corner {
    pub speed: f64,
    pub seconds: f64,
}

impl Corner {
    /// How far from the corner the blend begins and ends.
    pub fn away(self) -> f64 {
        0.5 * self.speed * self.seconds
    }
}

impl Legs {
    /// Checks waypoints and limits. Waypoints that are the same count once.
    pub fn new<Q: AsRef<[f64]>>(waypoints: &[Q], limits: &MotionLimits) -> Result<Self, MotionError> {
        let (Some(first), Some(last)) = (waypoints.first(), waypoints.last()) else { return Err(MotionError::Path) };
        let (mut from, end) = (first.as_ref(), last.as_ref().to_vec());
        limits.validate(from.len())?;
        let sound = |q: &Q| q.as_ref().len() == from.len() && q.as_ref().iter().all(|x| x.is_finite());
        if !waypoints.iter().all(sound) {
            return Err(MotionError::Path);
        }
        let mut stretches = Vec::with_capacity(waypoints.len());
        for to in &waypoints[1..] {
            let to = to.as_ref();
            let way: Vec<f64> = to.iter().zip(from).map(|(b, a)| b - a).collect();
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > SAME {
                let direction: Vec<f64> = way.iter().map(|x| x / length).collect();
                let limits = limits.along(&direction);
                stretches.push(Stretch { from: from.to_vec(), direction, length, limits });
                from = to;
            }
        }
        Ok(Self { stretches, end, limits: limits.clone() })
    }

    /// Number of legs; corner `n` is the one before leg `n`, for `1..count`.
    pub fn count(&self) -> usize {
        self.stretches.len()
    }

    /// Half of the shorter leg at a corner.
    pub fn half(&self, corner: usize) -> f64 {
        0.5 * self.stretches[corner - 1].length.min(self.stretches[corner].length)
    }

    /// The triangle that holds the blend at a corner: a point of each leg and the corner between.
    pub fn triangle(&self, corner: usize, away: f64) -> [Vec<f64>; 3] {
        let (a, b) = (&self.stretches[corner - 1], &self.stretches[corner]);
        [along(&b.from, &a.direction, -away), b.from.clone(), along(&b.from, &b.direction, away)]
    }

    /// In time, as fast as it goes. `rooms[n]` is how far from corner `n` its blend may begin: 0 to stop there; entry 0 is
    /// not used.
    pub fn timed(self, rooms: &[f64]) -> Trajectory {
        let mut corners = vec![Corner::default(); self.count() + 1];
        for n in 1..self.count() {
            corners[n] = self.corner(n, rooms.get(n).copied().unwrap_or(0.0).min(self.half(n)));
        }
        self.slow_down(&mut corners);
        Trajectory::assemble(self, &corners)
    }

    /// The fastest that a corner can be passed.
    fn corner(&self, n: usize, room: f64) -> Corner {
        if !(room > 0.0) {
            return Corner::default();
        }
        let top = self.stretches[n - 1].limits.speed.min(self.stretches[n].limits.speed);
        let speed = greatest(0.0, top, |speed| self.passed(n, speed).away() <= room);
        self.passed(n, speed)
    }

    fn passed(&self, n: usize, speed: f64) -> Corner {
        let directions = [&self.stretches[n - 1].direction[..], &self.stretches[n].direction];
        Corner { speed, seconds: Blend::seconds(speed, directions, &self.limits) }
    }

    /// Makes corners slower until each leg is long enough for the change of speed on it: forth, then back.
    fn slow_down(&self, corners: &mut [Corner]) {
        let fits = |leg: &Stretch, a: Corner, b: Corner| {
            Ramp::new(a.speed, b.speed, leg.limits).distance() <= leg.length - a.away() - b.away()
        };
        for n in 0..self.count().saturating_sub(1) {
            let (a, b) = (corners[n], corners[n + 1]);
            if b.speed > a.speed {
                let leg = &self.stretches[n];
                let speed = greatest(a.speed, b.speed, |speed| fits(leg, a, self.passed(n + 1, speed)));
                corners[n + 1] = if speed < b.speed { self.passed(n + 1, speed) } else { b };
            }
        }
        for n in (1..self.count()).rev() {
            let (a, b) = (corners[n], corners[n + 1]);
            if a.speed > b.speed {
                let leg = &self.stretches[n];
                let speed = greatest(b.speed, a.speed, |speed| fits(leg, self.passed(n, speed), b));
                corners[n] = if speed < a.speed { self.passed(n, speed) } else { a };
            }
        }
    }
}

pub(super) fn along(from: &[f64], direction: &[f64], far: f64) -> Vec<f64> {
    from.iter().zip(direction).map(|(x, d)| x + d * far).collect()
}
