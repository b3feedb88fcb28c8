//! Statistics over runs without avoidance and with it.

use elbowroom_avoidance::{AvoiderState, EscapeState};
use elbowroom_cell::Cell;
use elbowroom_sim::{RobotTrack, Sample};

use super::comparison::RunComparison;

/// Fraction of its largest speed below which a joint counts as stationary.
const STATIONARY_SHARE: f64 = 1e-4;

/// Times of a step of avoidance, one entry per run, µs.
#[derive(Default)]
struct StepTimes {
    median: Vec<f64>,
    p99: Vec<f64>,
    longest: Vec<f64>,
}

/// Regions that the monitor guarded while the robot evaded.
#[derive(Default)]
struct RegionStops {
    /// Number of runs in which a region was entered.
    entered: usize,
    /// Number of runs in which the monitor stopped the robot off its path at a region.
    stopped: usize,
    longest_s: f64,
}

/// Motion of the joints.
struct JointMotion {
    /// Largest excess over a joint's speed (as a fraction of it) and over its limit (rad).
    over: [f64; 2],
    least_reversal_s: f64,
}

impl Default for JointMotion {
    fn default() -> Self {
        Self { over: [0.0; 2], least_reversal_s: f64::INFINITY }
    }
}

/// Figures of the runs so far.
#[derive(Default)]
pub struct Statistics {
    runs: usize,
    hit_off: usize,
    hit_on: usize,
    resolved: usize,
    moving: usize,
    unfinished: usize,
    extra_s: Vec<f64>,
    travel: Vec<f64>,
    nearest_m: Vec<f64>,
    steps: StepTimes,
    /// Number of runs in which the robot followed an escape.
    escaped: usize,
    joints: JointMotion,
    plans: [usize; 2],
    regions: RegionStops,
    /// Whether to print the states of the robot before a collision.
    show: bool,
}

/// Override below which the robot counts as stopped.
const STOPPED_OVERRIDE: f64 = 1e-3;

/// Longest time (s) for which the monitor stopped a robot at a region while it was off its path.
fn longest_stop_s(track: &RobotTrack, tick_s: f64) -> f64 {
    let (mut longest_s, mut stopped_s): (f64, f64) = (0.0, 0.0);
    let avoidance = track.avoidance.iter().flat_map(|a| &a.samples);
    for (sample, a) in track.samples.iter().zip(avoidance) {
        let is_stopped =
            a.path_deviation_s > 0.0 && sample.region.is_some() && sample.speed_override < STOPPED_OVERRIDE;
        stopped_s = if is_stopped { stopped_s + tick_s } else { 0.0 };
        longest_s = longest_s.max(stopped_s);
    }
    longest_s
}

impl Statistics {
    /// Creates empty statistics. `show`: whether to print the states of the robot before a collision.
    pub fn new(show: bool) -> Self {
        Self { show, ..Self::default() }
    }

    /// Formats a line about the runs so far.
    pub fn progress(&self) -> String {
        format!("{} runs: {} collide without, {} with", self.runs, self.hit_off, self.hit_on)
    }

    /// Adds a run, and prints a line if it hits or does not finish.
    pub fn add(&mut self, cell: &Cell, RunComparison { number, off, on }: &RunComparison) {
        self.runs += 1;
        let (without, with) = (&off.robots[0], &on.robots[0]);
        let (hit_off, hit_on) = (!without.collisions.is_empty(), !with.collisions.is_empty());
        self.hit_off += usize::from(hit_off);
        self.hit_on += usize::from(hit_on);
        if let Some(first) = with.collisions.first() {
            println!("run {number}: {} hits {} at {:.3} s, {} without avoidance", first.a, first.b, first.t_s, hit_off);
            if self.show {
                show(with, first.t_s);
            }
        }
        if !with.finished {
            println!("run {number}: not finished after {:.1} s", on.duration_s);
            if self.show {
                show(with, on.duration_s);
            }
            self.unfinished += 1;
        }
        let stop_s = longest_stop_s(with, on.tick_s);
        self.regions.entered += usize::from(on.regions.iter().any(|region| region.entered));
        self.regions.stopped += usize::from(stop_s > 0.0);
        self.regions.longest_s = self.regions.longest_s.max(stop_s);
        let Some(track) = &with.avoidance else { return };
        if hit_off && !hit_on && with.finished {
            self.resolved += 1;
            self.moving += usize::from(!track.samples.iter().any(|s| s.state == AvoiderState::Waiting));
        }
        if !hit_on && with.finished {
            self.extra_s.push(on.duration_s - off.duration_s);
            self.travel.push(travel(with) / travel(without));
        }
        self.nearest_m.push(track.samples.iter().map(|s| s.nearest_m).fold(f64::INFINITY, f64::min));
        self.steps.median.push(track.step_ns.p50 as f64 / 1e3);
        self.steps.p99.push(track.step_ns.p99 as f64 / 1e3);
        self.steps.longest.push(track.step_ns.max as f64 / 1e3);
        self.escaped += usize::from(track.samples.iter().any(|s| s.escape == EscapeState::Escaping));
        self.plans[0] += track.plans.len();
        self.plans[1] += track.plans.iter().filter(|p| p.search_s.is_some()).count();
        self.limits(cell, with, on.tick_s);
    }

    fn limits(&mut self, cell: &Cell, track: &RobotTrack, tick_s: f64) {
        let robot = &cell.robots[0];
        let chain = &robot.robot.chain;
        let (lower, upper) = (chain.lower(), chain.upper());
        for j in 0..robot.limits.len() {
            let (mut sign, mut reversed_s) = (0.0, f64::NEG_INFINITY);
            let off_path = track.avoidance.iter().flat_map(|a| &a.samples).map(|a| a.path_deviation_s > 0.0);
            for (w, off_path) in track.samples.windows(2).zip(off_path.skip(1)) {
                let v = (w[1].q[j] - w[0].q[j]) / tick_s;
                self.joints.over[0] = self.joints.over[0].max(v.abs() / robot.limits[j].velocity - 1.0);
                self.joints.over[1] = self.joints.over[1].max(w[1].q[j] - upper[j]).max(lower[j] - w[1].q[j]);
                // Reversals of the program itself do not count.
                if !off_path {
                    (sign, reversed_s) = (0.0, f64::NEG_INFINITY);
                } else if v.abs() > STATIONARY_SHARE * robot.limits[j].velocity {
                    if sign * v < 0.0 {
                        self.joints.least_reversal_s = self.joints.least_reversal_s.min(w[1].t_s - reversed_s);
                        reversed_s = w[1].t_s;
                    }
                    sign = v.signum();
                }
            }
        }
    }

    /// Prints the figures of all runs.
    pub fn print(&mut self) {
        let at = |v: &mut Vec<f64>, share: f64| {
            v.sort_by(f64::total_cmp);
            v.get(((v.len() as f64 * share) as usize).min(v.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
        };
        let three = |v: &mut Vec<f64>| [at(v, 0.5), at(v, 0.9), at(v, 1.0)];
        println!("{} runs: {} collide without avoidance, {} with it", self.runs, self.hit_off, self.hit_on);
        let hit = self.hit_off.max(1) as f64;
        println!(
            "of those that collide without avoidance: {} ({:.1} %) complete with it, {} ({:.1} %) without waiting; \
             {} of all not completed",
            self.resolved,
            100.0 * self.resolved as f64 / hit,
            self.moving,
            100.0 * self.moving as f64 / hit,
            self.unfinished
        );
        let [extra, travel, nearest] = [&mut self.extra_s, &mut self.travel, &mut self.nearest_m].map(three);
        println!("extra time, s: median {:.2}, 90 % {:.2}, most {:.2}", extra[0], extra[1], extra[2]);
        println!("joint travel, times: median {:.2}, 90 % {:.2}, most {:.2}", travel[0], travel[1], travel[2]);
        println!("nearest, m: least {:.4}, median {:.3}", at(&mut self.nearest_m, 0.0), nearest[0]);
        println!(
            "over a joint's speed by {:.1e}, over a limit by {:.1e} rad",
            self.joints.over[0], self.joints.over[1]
        );
        println!("shortest time between two reversals of a joint: {:.3} s", self.joints.least_reversal_s);
        println!("replanning attempts: {}, found: {}", self.plans[0], self.plans[1]);
        println!(
            "step, us: median of the runs' medians {:.0}, largest median {:.0}; 99th percentile: median {:.0}, largest \
             {:.0}; longest {:.0}",
            at(&mut self.steps.median, 0.5),
            at(&mut self.steps.median, 1.0),
            at(&mut self.steps.p99, 0.5),
            at(&mut self.steps.p99, 1.0),
            at(&mut self.steps.longest, 1.0)
        );
        println!("runs with an escape: {}", self.escaped);
        println!(
            "runs that entered a region: {}; stopped off the path at one: {}, longest {:.2} s",
            self.regions.entered, self.regions.stopped, self.regions.longest_s
        );
    }
}

/// Prints the states of the robot in the last second.
fn show(track: &RobotTrack, until_s: f64) {
    let Some(avoidance) = &track.avoidance else { return };
    let last = |t: f64| t > until_s - 1.5 && t < until_s + 0.1;
    let both = track.samples.iter().zip(&avoidance.samples).filter(|(s, _)| last(s.t_s));
    for (sample, a) in both.step_by(10) {
        println!(
            "  {:.3} {:9} {:9} nearest {:.3} size {:.2} deviation {:.3} rate {:.2} q {:.3?}",
            sample.t_s,
            a.state.name(),
            format!("{:?}", a.escape),
            a.nearest_m,
            a.size,
            a.path_deviation_s,
            a.rate,
            sample.q
        );
    }
    println!("  plans {:?}", avoidance.plans);
}

/// Sums the motion of all joints.
fn travel(track: &RobotTrack) -> f64 {
    let step = |w: &[Sample]| w[1].q.iter().zip(&w[0].q).map(|(a, b)| (a - b).abs()).sum::<f64>();
    track.samples.windows(2).map(step).sum()
}
