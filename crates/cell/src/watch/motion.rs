//! A path being followed: where on it the arm is, how fast its time runs, and what lies ahead.

use elbowroom_cspace::{Grid, Table};
use elbowroom_planner::{MotionLimits, Path, Trajectory};

/// Deceleration left for a stop even where following the curve takes more, as a share of it.
const RESERVE: f64 = 0.1;
/// The curve is looked at so often per cell.
const PER_CELL: f64 = 4.0;
/// A stop is worked out in ticks, none shorter than this, seconds …
const BRAKE_STEP_S: f64 = 1e-4;
/// … and no more of them: a stop that takes longer counts as none.
const BRAKE_STEPS: usize = 100_000;

/// Where the map's joints are at an instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub q: [f64; 3],
    pub qd: [f64; 3],
    pub qdd: [f64; 3],
}

/// The state of a trajectory of the map's three joints.
pub(super) fn state_at(trajectory: &Trajectory, tau_s: f64) -> State {
    let state = trajectory.at(tau_s);
    let three = |values: &[f64]| [0, 1, 2].map(|i| values.get(i).copied().unwrap_or(f64::NAN));
    State { q: three(&state.q), qd: three(&state.qd), qdd: three(&state.qdd) }
}

/// A place on the way.
#[derive(Debug, Clone, Copy)]
struct Sample {
    tau_s: f64,
    q: [f64; 3],
    /// Way from the first sample, rad.
    far_rad: f64,
}

/// What lies ahead of the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ahead {
    /// Free to the end.
    Free,
    /// Free up to this far along the way.
    Blocked { far_rad: f64 },
    /// The arm is in a blocked cell; out of it at this time of the trajectory, and then free up to so far, or to the end.
    Inside { out_s: f64, then_far_rad: Option<f64> },
    /// The arm is in a blocked cell, and its way does not lead out of it.
    Lost,
}

/// A trajectory whose time may run more slowly than the clock.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    pub path: Path,
    trajectory: Trajectory,
    samples: Vec<Sample>,
    /// Time of the trajectory.
    pub tau_s: f64,
    /// How fast that runs, 0 to 1.
    pub rate: f64,
}

impl Motion {
    /// From `tau_s` on at a rate.
    pub fn new(path: Path, trajectory: Trajectory, tau_s: f64, rate: f64, grid: &Grid, limits: &MotionLimits) -> Self {
        let axes = grid.axes();
        let step = |i: usize| axes[i].step() / limits.velocity[i];
        let dt = (0..3).map(step).fold(f64::INFINITY, f64::min) / PER_CELL;
        let count = ((trajectory.seconds() - tau_s).max(0.0) / dt).ceil() as usize;
        let mut samples: Vec<Sample> = Vec::with_capacity(count + 1);
        for n in 0..=count {
            let tau_s = (tau_s + dt * n as f64).min(trajectory.seconds());
            let q = state_at(&trajectory, tau_s).q;
            let far_rad = samples.last().map_or(0.0, |s| s.far_rad + distance(s.q, q));
            samples.push(Sample { tau_s, q, far_rad });
        }
        Self { path, trajectory, samples, tau_s, rate }
    }

    /// Where the arm is, with derivatives by the trajectory's time.
    pub fn state(&self) -> State {
        state_at(&self.trajectory, self.tau_s)
    }

    /// Whether the end is reached.
    pub fn is_over(&self) -> bool {
        self.tau_s >= self.trajectory.seconds()
    }

    /// The leg that the arm is on, exactly; `None` in a rounded corner.
    pub fn leg(&self) -> Option<usize> {
        let q = self.state().q;
        let legs = self.path.waypoints.windows(2).enumerate();
        let near = |w: &[[f64; 3]]| distance_to_leg(q, w[0], w[1]) < 1e-9;
        legs.filter(|(_, w)| near(w)).map(|(n, _)| n).next_back()
    }

    /// Looks along the curve from where the arm is.
    pub fn ahead(&self, table: &Table, grid: &Grid) -> Ahead {
        let blocked = |q: [f64; 3]| grid.cell(q).is_none_or(|cell| table.is_blocked(cell));
        let here = self.samples.partition_point(|s| s.tau_s <= self.tau_s);
        let rest = &self.samples[here..];
        let first = |from: usize| rest[from..].iter().position(|s| blocked(s.q)).map(|n| n + from);
        let before = |n: usize| self.samples[(here + n).saturating_sub(1)].far_rad;
        if blocked(self.state().q) {
            let Some(out) = rest.iter().position(|s| !blocked(s.q)) else { return Ahead::Lost };
            return Ahead::Inside { out_s: rest[out].tau_s, then_far_rad: first(out).map(before) };
        }
        first(0).map_or(Ahead::Free, |n| Ahead::Blocked { far_rad: before(n) })
    }

    /// How far along the way the arm is, rad.
    pub fn far_rad(&self) -> f64 {
        let here = self.samples.partition_point(|s| s.tau_s <= self.tau_s).saturating_sub(1);
        self.samples.get(here).map_or(0.0, |s| s.far_rad + distance(s.q, self.state().q))
    }

    /// The trajectory's time so far along the way.
    pub fn time_at(&self, far_rad: f64) -> f64 {
        let n = self.samples.partition_point(|s| s.far_rad <= far_rad).saturating_sub(1);
        self.samples.get(n).map_or(self.tau_s, |s| s.tau_s)
    }

    /// Points of the curve from the present to a time, few on straight stretches: no point of it between two is farther
    /// than `within_rad` from the straight way.
    pub fn points(&self, until_s: f64, within_rad: f64) -> Vec<[f64; 3]> {
        let from = self.samples.partition_point(|s| s.tau_s <= self.tau_s);
        let to = self.samples.partition_point(|s| s.tau_s <= until_s).max(from);
        let curve: Vec<[f64; 3]> =
            std::iter::once(self.state().q).chain(self.samples[from..to].iter().map(|s| s.q)).collect();
        let mut kept = vec![curve[0]];
        let mut start = 0;
        for end in 2..curve.len() {
            let on_chord = |q: &[f64; 3]| distance_to_leg(*q, curve[start], curve[end]) <= within_rad;
            if !curve[start + 1..end].iter().all(on_chord) {
                start = end - 1;
                kept.push(curve[start]);
            }
        }
        kept.extend(curve.last().filter(|_| curve.len() > 1));
        kept
    }

    /// Where the trajectory's time stands after braking from (`tau_s`, `rate`) in ticks of `dt`; infinity where no end of
    /// that is in sight, or `dt` is no number.
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

    /// What the state would be after `dt` seconds, towards a rate: time and rate.
    pub fn after(&self, dt: f64, wanted: f64, stop: [f64; 3], accelerate: [f64; 3]) -> (f64, f64) {
        let state = self.state();
        let fall = change_of_rate(&state, self.rate, stop, -1.0);
        let rise = change_of_rate(&state, self.rate, accelerate, 1.0);
        let rate = wanted.clamp((self.rate - fall * dt).max(0.0), self.rate + rise * dt).clamp(0.0, 1.0);
        ((self.tau_s + dt * f64::midpoint(self.rate, rate)).min(self.trajectory.seconds()), rate)
    }
}

/// How fast the rate σ may fall (`way` −1) or rise (1), 1/s: with `q̇ = q′σ` and `q̈ = q″σ² + q′σ̇`, `|q̈| ≤ a` leaves
/// `|σ̇| ≤ (a − way·sign(q′)·q″σ²) / |q′|` per joint: where the curve itself speeds up there is more room to brake.
fn change_of_rate(state: &State, rate: f64, most: [f64; 3], way: f64) -> f64 {
    let square = rate * rate;
    let of = |i: usize| {
        let speed = state.qd[i].abs();
        let taken = way * state.qd[i].signum() * state.qdd[i] * square;
        if speed < 1e-12 { f64::INFINITY } else { (most[i] - taken).max(RESERVE * most[i]) / speed }
    };
    // A finite rate keeps 0 · ∞ out of the products.
    (0..3).map(of).fold(1e6, f64::min)
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

pub(super) fn distance_to_leg(q: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let way = [0, 1, 2].map(|i| b[i] - a[i]);
    let square: f64 = way.iter().map(|x| x * x).sum();
    let along: f64 = (0..3).map(|i| (q[i] - a[i]) * way[i]).sum();
    let t = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(q, [0, 1, 2].map(|i| a[i] + way[i] * t))
}
