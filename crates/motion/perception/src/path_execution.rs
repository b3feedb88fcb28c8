//! A trajectory in execution: progress, time scaling, and validation of the rest.

use elbowroom_cspace::{Grid, OccupancyBitmap};
use elbowroom_planner::{KinematicLimits, Path, Trajectory};

/// Smallest share of the deceleration that remains for braking along a curve.
const RESERVE: f64 = 0.1;
/// Samples of the curve per grid cell.
const SAMPLES_PER_CELL: f64 = 4.0;
/// Smallest step of the braking simulation, seconds.
const BRAKE_STEP_S: f64 = 1e-4;
/// Most steps of the braking simulation; a longer stop counts as none.
const BRAKE_STEPS: usize = 100_000;
/// The arm is on a straight segment within this distance, rad: above rounding, below the deviation of a blended corner.
const ON_SEGMENT_RAD: f64 = 1e-9;
/// A joint that is slower than this along the curve, rad/s, does not limit the rate.
const MIN_JOINT_SPEED_RAD_S: f64 = 1e-12;
/// Largest change of the rate, 1/s: finite, because 0 · ∞ is not a number.
const MAX_CHANGE_OF_RATE: f64 = 1e6;

/// Values and derivatives of the map's joints at an instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanarState {
    pub q: [f64; 3],
    pub qd: [f64; 3],
    pub qdd: [f64; 3],
}

/// The state of a trajectory of the map's three joints.
pub(super) fn state_at(trajectory: &Trajectory, tau_s: f64) -> PlanarState {
    let state = trajectory.at(tau_s);
    let three = |values: &[f64]| [0, 1, 2].map(|i| values.get(i).copied().unwrap_or(f64::NAN));
    PlanarState { q: three(&state.q), qd: three(&state.qd), qdd: three(&state.qdd) }
}

/// A sample of the curve.
#[derive(Debug, Clone, Copy)]
struct CurveSample {
    tau_s: f64,
    q: [f64; 3],
    /// Arc length from the first sample, rad.
    arc_rad: f64,
}

/// Whether the rest of the curve is free, corners blended as they are executed. [`PathStatus`](elbowroom_planner::PathStatus)
/// says the same of the straight segments of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum CurveStatus {
    /// Free to the end.
    Free,
    /// Free up to this arc length.
    BlockedAt { arc_rad: f64 },
    /// The arm is in a blocked cell and leaves it at this time of the trajectory; then free up to this arc length, or
    /// to the end.
    StartBlocked { exit_s: f64, then_arc_rad: Option<f64> },
    /// The arm is in a blocked cell, and the path does not leave it.
    NoExit,
}

/// A trajectory with time scaling.
#[derive(Debug, Clone)]
pub(super) struct PathExecution {
    pub path: Path,
    trajectory: Trajectory,
    samples: Vec<CurveSample>,
    /// Time along the trajectory.
    pub tau_s: f64,
    /// Time scaling rate, 0 to 1.
    pub rate: f64,
}

impl PathExecution {
    /// Execution of a trajectory from the time `tau_s` on, at a rate.
    pub fn new(
        path: Path,
        trajectory: Trajectory,
        tau_s: f64,
        rate: f64,
        grid: &Grid,
        limits: &KinematicLimits,
    ) -> Self {
        let axes = grid.axes();
        let step = |i: usize| axes[i].step() / limits.velocity[i];
        let dt = (0..3).map(step).fold(f64::INFINITY, f64::min) / SAMPLES_PER_CELL;
        let count = ((trajectory.seconds() - tau_s).max(0.0) / dt).ceil() as usize;
        let mut samples: Vec<CurveSample> = Vec::with_capacity(count + 1);
        for n in 0..=count {
            let tau_s = (tau_s + dt * n as f64).min(trajectory.seconds());
            let q = state_at(&trajectory, tau_s).q;
            let arc_rad = samples.last().map_or(0.0, |s| s.arc_rad + distance(s.q, q));
            samples.push(CurveSample { tau_s, q, arc_rad });
        }
        Self { path, trajectory, samples, tau_s, rate }
    }

    /// Current state, with derivatives by the trajectory's time.
    pub fn state(&self) -> PlanarState {
        state_at(&self.trajectory, self.tau_s)
    }

    /// True where the end is reached.
    pub fn is_finished(&self) -> bool {
        self.tau_s >= self.trajectory.seconds()
    }

    /// The straight segment that the arm is on; `None` in a blended corner.
    pub fn segment(&self) -> Option<usize> {
        let q = self.state().q;
        let segments = self.path.waypoints.windows(2).enumerate();
        let is_on = |w: &[[f64; 3]]| distance_to_segment(q, w[0], w[1]) < ON_SEGMENT_RAD;
        segments.filter(|(_, w)| is_on(w)).map(|(n, _)| n).next_back()
    }

    /// Validates the curve from the current state on.
    pub fn curve_status(&self, occupancy: &OccupancyBitmap, grid: &Grid) -> CurveStatus {
        let blocked = |q: [f64; 3]| grid.cell(q).is_none_or(|cell| occupancy.is_blocked(cell));
        let here = self.samples.partition_point(|s| s.tau_s <= self.tau_s);
        let rest = &self.samples[here..];
        let first = |from: usize| rest[from..].iter().position(|s| blocked(s.q)).map(|n| n + from);
        let before = |n: usize| self.samples[(here + n).saturating_sub(1)].arc_rad;
        if blocked(self.state().q) {
            let Some(exit) = rest.iter().position(|s| !blocked(s.q)) else { return CurveStatus::NoExit };
            return CurveStatus::StartBlocked { exit_s: rest[exit].tau_s, then_arc_rad: first(exit).map(before) };
        }
        first(0).map_or(CurveStatus::Free, |n| CurveStatus::BlockedAt { arc_rad: before(n) })
    }

    /// Arc length from the first sample to the current state, rad.
    pub fn arc_rad(&self) -> f64 {
        let here = self.samples.partition_point(|s| s.tau_s <= self.tau_s).saturating_sub(1);
        self.samples.get(here).map_or(0.0, |s| s.arc_rad + distance(s.q, self.state().q))
    }

    /// Time of the trajectory at an arc length.
    pub fn time_at(&self, arc_rad: f64) -> f64 {
        let n = self.samples.partition_point(|s| s.arc_rad <= arc_rad).saturating_sub(1);
        self.samples.get(n).map_or(self.tau_s, |s| s.tau_s)
    }

    /// Points of the curve from now to `until_s`, thinned on straight stretches: no point of the curve is farther than
    /// `within_rad` from the polyline.
    pub fn points(&self, until_s: f64, within_rad: f64) -> Vec<[f64; 3]> {
        let from = self.samples.partition_point(|s| s.tau_s <= self.tau_s);
        let to = self.samples.partition_point(|s| s.tau_s <= until_s).max(from);
        let curve: Vec<[f64; 3]> =
            std::iter::once(self.state().q).chain(self.samples[from..to].iter().map(|s| s.q)).collect();
        let mut kept = vec![curve[0]];
        let mut start = 0;
        for end in 2..curve.len() {
            let on_chord = |q: &[f64; 3]| distance_to_segment(*q, curve[start], curve[end]) <= within_rad;
            if !curve[start + 1..end].iter().all(on_chord) {
                start = end - 1;
                kept.push(curve[start]);
            }
        }
        kept.extend(curve.last().filter(|_| curve.len() > 1));
        kept
    }

    /// Time of the trajectory after braking from (`tau_s`, `rate`) in ticks of `dt`; infinite where the stop takes too
    /// long or `dt` is NaN.
    pub fn stops_at(&self, mut tau_s: f64, mut rate: f64, stop: [f64; 3], dt: f64) -> f64 {
        if dt.is_nan() {
            return f64::INFINITY;
        }
        let dt = dt.max(BRAKE_STEP_S);
        for _ in 0..BRAKE_STEPS {
            if rate <= 0.0 {
                return tau_s;
            }
            let next = (rate - change_of_rate(&state_at(&self.trajectory, tau_s), rate, stop, -1.0) * dt).max(0.0);
            tau_s += dt * f64::midpoint(rate, next);
            rate = next;
        }
        f64::INFINITY
    }

    /// Time and rate after `dt` seconds towards a rate.
    pub fn after(&self, dt: f64, target_rate: f64, stop: [f64; 3], accelerate: [f64; 3]) -> (f64, f64) {
        let state = self.state();
        let fall = change_of_rate(&state, self.rate, stop, -1.0);
        let rise = change_of_rate(&state, self.rate, accelerate, 1.0);
        let rate = target_rate.clamp((self.rate - fall * dt).max(0.0), self.rate + rise * dt).clamp(0.0, 1.0);
        ((self.tau_s + dt * f64::midpoint(self.rate, rate)).min(self.trajectory.seconds()), rate)
    }
}

/// How fast the rate σ may fall (`sign` −1) or rise (1), 1/s: with `q̇ = q′σ` and `q̈ = q″σ² + q′σ̇`, `|q̈| ≤ a` leaves
/// `|σ̇| ≤ (a − sign·sign(q′)·q″σ²) / |q′|` per joint: where the curve itself accelerates, more deceleration is
/// available.
fn change_of_rate(state: &PlanarState, rate: f64, most: [f64; 3], sign: f64) -> f64 {
    let square = rate * rate;
    let of = |i: usize| {
        let speed = state.qd[i].abs();
        let taken = sign * state.qd[i].signum() * state.qdd[i] * square;
        if speed < MIN_JOINT_SPEED_RAD_S { f64::INFINITY } else { (most[i] - taken).max(RESERVE * most[i]) / speed }
    };
    (0..3).map(of).fold(MAX_CHANGE_OF_RATE, f64::min)
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

pub(super) fn distance_to_segment(q: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let segment = [0, 1, 2].map(|i| b[i] - a[i]);
    let square: f64 = segment.iter().map(|x| x * x).sum();
    let along: f64 = (0..3).map(|i| (q[i] - a[i]) * segment[i]).sum();
    let t = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(q, [0, 1, 2].map(|i| a[i] + segment[i] * t))
}
