//! A move with its time law.

use elbowroom_kinematics::JointLimits;
use elbowroom_kinematics::TrajectoryPoint;
use rsruckig::prelude::*;

use super::MovePath;

/// A move with its path and duration.
#[derive(Debug)]
pub struct Segment {
    geometry: MovePath,
    law: TimeLaw,
    /// Fraction of the programmed speed that the joint limits permit, 0..1.
    pub speed_share: f64,
    /// Largest fraction of any joint's top speed that the time law may use, 0..1.
    pub joint_share: f64,
}

#[derive(Debug)]
enum TimeLaw {
    Rest,
    Ruckig(Box<Trajectory<1>>),
}

/// Largest first, second and third time derivatives of s.
#[derive(Debug, Clone, Copy)]
struct PathLimits {
    velocity: f64,
    acceleration: f64,
    jerk: f64,
}

impl Segment {
    /// Times a path within all joint limits.
    ///
    /// `speed` is the fraction of each joint's speed, `path_rate` the largest programmed ds/dt (TCP speed over length;
    /// infinite for none).
    ///
    /// Joint limits become limits of s by the chain rule, with the largest derivatives on the path:
    /// `|q′|ṡ ≤ v`, `|q′|s̈ + |q″|ṡ² ≤ a`, `|q′|s⃛ + 3|q″|ṡs̈ + |q‴|ṡ³ ≤ j`.
    ///
    /// # Errors
    /// Error of the time law's library.
    pub fn new(geometry: MovePath, limits: &[JointLimits], speed: f64, path_rate: f64) -> Result<Self, RuckigError> {
        let samples = geometry.samples();
        let Some((bounds, share)) = bounds(&samples, limits, speed, path_rate) else {
            return Ok(Self { geometry, law: TimeLaw::Rest, speed_share: 1.0, joint_share: 0.0 });
        };
        let mut otg = Ruckig::<1, ThrowErrorHandler>::new(None, 0.001);
        let mut input = InputParameter::new(None);
        input.target_position[0] = 1.0;
        input.max_velocity[0] = bounds.velocity;
        input.max_acceleration[0] = bounds.acceleration;
        input.max_jerk[0] = bounds.jerk;
        let mut trajectory = Trajectory::new(None);
        otg.calculate(&input, &mut trajectory)?;
        let shares = |point: &TrajectoryPoint| {
            let share = point.dq.iter().zip(limits).map(|(dq, limit)| dq.abs() * bounds.velocity / limit.velocity);
            share.fold(0.0, f64::max)
        };
        let joint_share = samples.iter().map(shares).fold(0.0, f64::max);
        Ok(Self { geometry, law: TimeLaw::Ruckig(Box::new(trajectory)), speed_share: share, joint_share })
    }

    /// Duration at override 1, s.
    pub fn duration(&self) -> f64 {
        match &self.law {
            TimeLaw::Rest => 0.0,
            TimeLaw::Ruckig(t) => t.get_duration(),
        }
    }

    /// Joint values at time `t` (s, at override 1), with time derivatives.
    pub fn at(&self, t: f64) -> TrajectoryPoint {
        let (s, v, a) = self.parameter(t);
        let mut point = self.geometry.at(s);
        for (dq, ddq) in point.dq.iter_mut().zip(&mut point.ddq) {
            *ddq = *ddq * v * v + *dq * a;
            *dq *= v;
        }
        point
    }

    fn parameter(&self, t: f64) -> (f64, f64, f64) {
        let TimeLaw::Ruckig(trajectory) = &self.law else { return (1.0, 0.0, 0.0) };
        if t >= trajectory.get_duration() {
            return (1.0, 0.0, 0.0);
        }
        let [mut s, mut v, mut a] = [[0.0]; 3].map(DataArrayOrVec::Stack);
        trajectory.at_time(t.max(0.0), &mut Some(&mut s), &mut Some(&mut v), &mut Some(&mut a), &mut None, &mut None);
        (s[0].clamp(0.0, 1.0), v[0].max(0.0), a[0])
    }

    /// Joint values at the end.
    pub fn end(&self) -> Vec<f64> {
        self.geometry.end()
    }

    /// The path.
    pub fn geometry(&self) -> &MovePath {
        &self.geometry
    }
}

/// The limits of s, and the fraction of the programmed rate that remains; `None` without motion.
fn bounds(
    samples: &[TrajectoryPoint],
    limits: &[JointLimits],
    speed: f64,
    path_rate: f64,
) -> Option<(PathLimits, f64)> {
    let joints = limits.len();
    let largest = |f: &dyn Fn(&TrajectoryPoint, usize) -> f64, j: usize| {
        samples.iter().fold(0.0_f64, |m, p| m.max(f(p, j).abs()))
    };
    let first: Vec<f64> = (0..joints).map(|j| largest(&|p, j| p.dq[j], j)).collect();
    let second: Vec<f64> = (0..joints).map(|j| largest(&|p, j| p.ddq[j], j)).collect();
    let third: Vec<f64> = (0..joints).map(|j| largest_change(samples, j)).collect();
    if first.iter().all(|f| *f < 1e-12) {
        return None;
    }
    let least = |f: &dyn Fn(usize) -> f64| (0..joints).map(f).filter(|v| !v.is_nan()).fold(f64::INFINITY, f64::min);
    let joint_rate = least(&|j| limits[j].velocity * speed / first[j]);
    // Half of acceleration and a quarter of jerk may be used for following the curve; a joint move needs none.
    let curve_rate = least(&|j| (limits[j].acceleration / (2.0 * second[j])).sqrt());
    let jerk_rate = least(&|j| (limits[j].jerk / (4.0 * third[j])).cbrt());
    let velocity = path_rate.min(joint_rate).min(curve_rate).min(jerk_rate);
    let acceleration = least(&|j| (limits[j].acceleration - second[j] * velocity * velocity) / first[j]);
    let acceleration = acceleration.min(least(&|j| limits[j].jerk / (4.0 * 3.0 * second[j] * velocity)));
    let jerk = least(&|j| {
        let spent = 3.0 * second[j] * velocity * acceleration + third[j] * velocity.powi(3);
        (limits[j].jerk - spent) / first[j]
    });
    let share = if path_rate.is_finite() { (velocity / path_rate).min(1.0) } else { 1.0 };
    Some((PathLimits { velocity, acceleration, jerk }, share))
}

/// |q‴| from the change of q″ between samples at equal steps of s.
fn largest_change(samples: &[TrajectoryPoint], j: usize) -> f64 {
    let steps = (samples.len() - 1) as f64;
    samples.windows(2).fold(0.0_f64, |m, w| m.max((w[1].ddq[j] - w[0].ddq[j]).abs() * steps))
}
