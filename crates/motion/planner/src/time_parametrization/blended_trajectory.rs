//! Trajectories along straight segments with blended corners.

use elbowroom_kinematics::{JointTrajectory, TrajectoryPoint, TrajectoryRow};

use super::blend::Blend;
use super::limits::TimeParametrizationError;
use super::segments::{Corner, PathSegments, point_along};
use super::speed_profile::SpeedProfile;

/// Rounding error in a number of periods that is ignored.
const PERIOD_ROUNDING: f64 = 1e-9;

/// A path with a time parametrization: at rest at both ends, with continuous velocity and acceleration and limited
/// jerk.
#[derive(Debug, Clone)]
pub struct BlendedTrajectory {
    path: PathSegments,
    phases: Vec<Phase>,
    seconds: f64,
}

/// The motion along a segment or a blend.
#[derive(Debug, Clone)]
struct Phase {
    /// Time at which the phase begins, s.
    begin: f64,
    /// Whether the joints are at rest when the phase begins.
    starts_at_rest: bool,
    /// Time in the phase per time of the trajectory, at most 1.
    time_scale: f64,
    kind: PhaseKind,
}

#[derive(Debug, Clone, Copy)]
enum PhaseKind {
    /// Motion along segment `n`, from `blend_distance` after its corner.
    Straight { n: usize, blend_distance: f64, profile: SpeedProfile },
    /// Motion along the blend before segment `n`.
    Blend { n: usize, corner: Corner },
}

/// The element of the path at an instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PathElement {
    /// A segment, counted from 0.
    Segment(usize),
    /// The corner before a segment.
    Corner(usize),
}

impl BlendedTrajectory {
    /// The fastest trajectory along a path. `blend_distances[n]` is the largest distance from corner `n` at which its blend
    /// begins: 0 to stop there; entry 0 is not used.
    pub(crate) fn new(path: PathSegments, blend_distances: &[f64]) -> Self {
        let corners = path.corners(blend_distances);
        let (mut phases, mut now) = (Vec::new(), 0.0);
        let mut add = |kind: PhaseKind, starts_at_rest: bool, seconds: f64| {
            phases.push(Phase { begin: now, starts_at_rest, time_scale: 1.0, kind });
            now += seconds;
        };
        for (n, s) in path.segments.iter().enumerate() {
            let (a, b) = (corners[n], corners[n + 1]);
            if n > 0 && a.seconds > 0.0 && a.speed > 0.0 {
                add(PhaseKind::Blend { n, corner: a }, false, a.seconds);
            }
            let profile = SpeedProfile::new(
                (s.length - a.blend_distance() - b.blend_distance()).max(0.0),
                a.speed,
                b.speed,
                s.limits,
            );
            add(
                PhaseKind::Straight { n, blend_distance: a.blend_distance(), profile },
                a.speed == 0.0,
                profile.seconds(),
            );
        }
        Self { path, phases, seconds: now }
    }

    /// Duration, s.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Number of corners at which the trajectory stops.
    pub fn stops(&self) -> usize {
        self.phases.iter().skip(1).filter(|p| p.starts_at_rest).count()
    }

    /// State of the joints `t` seconds after the start. Before the start the first state, after the end (and for NaN)
    /// the last.
    pub fn at(&self, t: f64) -> TrajectoryPoint {
        let joints = self.path.end.len();
        if self.phases.is_empty() || !(t < self.seconds) {
            return TrajectoryPoint::at_rest(self.path.end.clone());
        }
        let phase = &self.phases[self.phase(t)];
        let (since, time_scale) = ((t - phase.begin).max(0.0) * phase.time_scale, phase.time_scale);
        let scaled = |v: &[f64], factor: f64| v.iter().map(|x| x * factor).collect();
        match phase.kind {
            PhaseKind::Straight { n, blend_distance, ref profile } => {
                let [s, v, a] = profile.at(since);
                let segment = &self.path.segments[n];
                TrajectoryPoint {
                    q: point_along(&segment.from, &segment.direction, blend_distance + s),
                    dq: scaled(&segment.direction, v * time_scale),
                    ddq: scaled(&segment.direction, a * time_scale * time_scale),
                }
            }
            PhaseKind::Blend { n, corner } => {
                let (before, after) = (&self.path.segments[n - 1].direction, &self.path.segments[n].direction);
                let blend = Blend { before, after, speed: corner.speed, seconds: corner.seconds };
                let from = point_along(&self.path.segments[n].from, before, -corner.blend_distance());
                let mut state = TrajectoryPoint::at_rest(from);
                for i in 0..joints {
                    let [q, dq, ddq] = blend.at(since, i);
                    state.q[i] += q;
                    (state.dq[i], state.ddq[i]) = (dq * time_scale, ddq * time_scale * time_scale);
                }
                state
            }
        }
    }

    fn phase(&self, t: f64) -> usize {
        self.phases.partition_point(|p| p.begin <= t).saturating_sub(1)
    }

    /// The element of the path at an instant.
    pub(crate) fn element_at(&self, t: f64) -> Option<PathElement> {
        self.phases.get(self.phase(t)).map(|p| match p.kind {
            PhaseKind::Straight { n, .. } => PathElement::Segment(n),
            PhaseKind::Blend { n, .. } => PathElement::Corner(n),
        })
    }

    /// Slows the trajectory down slightly, so that it rests only at multiples of a period (s): samples at these times
    /// then include every corner at which it stops. Each part from rest to rest takes less than a period longer.
    ///
    /// # Errors
    /// The period is not a finite number above 0.
    pub fn aligned_to_ticks(mut self, period: f64) -> Result<Self, TimeParametrizationError> {
        validate_period(period)?;
        let ends: Vec<f64> = self.phases.iter().skip(1).map(|p| p.begin).chain([self.seconds]).collect();
        let mut ticks = 0.0;
        let mut from = 0;
        while from < self.phases.len() {
            let rest =
                (from + 1..self.phases.len()).find(|&n| self.phases[n].starts_at_rest).unwrap_or(self.phases.len());
            let (begin, seconds) = (self.phases[from].begin, ends[rest - 1] - self.phases[from].begin);
            let count = periods(seconds, period).max(1.0);
            let time_scale = (seconds / (count * period)).min(1.0);
            for phase in &mut self.phases[from..rest] {
                phase.begin = ticks * period + (phase.begin - begin) / time_scale;
                phase.time_scale = time_scale;
            }
            ticks += count;
            from = rest;
        }
        self.seconds = ticks * period;
        Ok(self)
    }

    /// Positions (rad) at every period (s) from 0 to the end. With linear interpolation between them, no joint is faster
    /// than its limit.
    ///
    /// # Errors
    /// The period is not a finite number above 0.
    pub fn samples(&self, period: f64) -> Result<JointTrajectory, TimeParametrizationError> {
        sampled(self.seconds, period, |t| self.at(t).q)
    }
}

/// Most rows of a motion: hours at the ticks of controllers.
const MAX_ROWS: usize = 5_000_000;

/// Samples at every period (s) from 0 to a duration (s); the last sample is at the end, which `q` returns for infinity.
pub(super) fn sampled(
    seconds: f64,
    period: f64,
    q: impl Fn(f64) -> Vec<f64>,
) -> Result<JointTrajectory, TimeParametrizationError> {
    validate_period(period)?;
    let count = periods(seconds, period).max(0.0) as usize;
    if count >= MAX_ROWS {
        return Err(TimeParametrizationError::Rows { seconds, period_s: period, most: MAX_ROWS });
    }
    let row = |k: usize| {
        let t_s = k as f64 * period;
        TrajectoryRow { t_s, q: q(if k == count { f64::INFINITY } else { t_s }) }
    };
    Ok(JointTrajectory::new((0..=count).map(row).collect()))
}

/// Number of periods, rounded up; a rounding error above a whole number is ignored.
pub(super) fn periods(seconds: f64, period: f64) -> f64 {
    (seconds / period - PERIOD_ROUNDING).ceil()
}

pub(super) fn validate_period(period: f64) -> Result<(), TimeParametrizationError> {
    if period.is_finite() && period > 0.0 { Ok(()) } else { Err(TimeParametrizationError::Period(period)) }
}
