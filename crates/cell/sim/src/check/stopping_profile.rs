//! Speeds of the guarded volumes of a robot during its program, and their stopping distances.

use std::collections::HashSet;
use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_kinematics::JointLimits;
use elbowroom_kinematics::TrajectoryPoint;
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_robot::RobotId;

use super::sphere_swept_hull::SphereSweptHull;
use super::thickness::{Braking, ResponseDelay, thickness};
use crate::motion::{GripAction, HeldObjects, PlanStep, ProgramPlan};

/// Largest sampling step of programs, s.
const STEP_S: f64 = 0.004;
/// Smallest and largest number of samples of one move.
const SAMPLES: [f64; 2] = [32.0, 20_000.0];

/// A solid or a point that moves with a link.
#[derive(Debug, Clone)]
pub(super) struct LinkSolid {
    pub link: LinkId,
    /// Its bound in the link's frame.
    pub hull: SphereSweptHull,
    /// The grip, if the solid is an object. The object counts while it is held.
    pub grip: Option<GripAction>,
}

/// Speeds and stopping distances of one volume.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct StoppingProfile {
    /// Largest speed of any of its points, the programmed override included, m/s.
    pub fastest_m_s: f64,
    /// Longest distance of any of its points from the first deceleration to rest, m: v²/2a.
    pub braking_m: f64,
    /// Thickness of the warning zone from which all of its points stop in time, m.
    pub needed_m: f64,
}

/// Speeds and stopping distances of a robot's program.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Joint values at the beginning, rad or m.
    pub start: Vec<f64>,
    /// One per volume.
    pub stopping_profiles: Vec<StoppingProfile>,
    /// Longest time from the first deceleration to rest, s.
    pub braking_s: f64,
}

/// Delay and rate limit of the override.
#[derive(Debug, Clone, Copy)]
struct OverrideResponse {
    response_delay: ResponseDelay,
    /// Largest decrease of the override per second; infinite for no limit.
    rate: f64,
}

impl Profile {
    /// Samples the planned program of a robot.
    pub fn of(cell: &Cell, robot: RobotId, plan: &ProgramPlan, solids: &[LinkSolid]) -> Self {
        let mut profile = Self {
            start: plan.start.clone(),
            stopping_profiles: vec![StoppingProfile::default(); solids.len()],
            braking_s: 0.0,
        };
        let chain = &cell.robots[robot.0].robot.chain;
        let mut sampler =
            MoveSampler { limits: &cell.robots[robot.0].limits, solids, chain, state: ChainState::new(chain) };
        let response = OverrideResponse {
            response_delay: response_delay(cell),
            rate: Some(cell.monitoring.laws.override_rate).filter(|r| *r > 0.0).unwrap_or(f64::INFINITY),
        };
        let mut moves = Vec::new();
        for_each_move(plan, response.response_delay.delay_s, |programmed, step_s, points, held| {
            let samples = points.iter().map(|p| sampler.at(p, held)).collect();
            moves.push(SampledMove { programmed, step_s, samples });
        });
        profile.add_moves(response, &moves);
        profile
    }

    /// Adds moves. The largest speeds are computed first: the needed thickness depends on them.
    fn add_moves(&mut self, response: OverrideResponse, moves: &[SampledMove]) {
        for sampled in moves {
            for now in &sampled.samples {
                let fall_s = now.stop_time.max(1.0 / response.rate);
                self.braking_s = self.braking_s.max(sampled.programmed * fall_s);
                for (stopping, speed) in self.stopping_profiles.iter_mut().zip(&now.speeds) {
                    stopping.fastest_m_s = stopping.fastest_m_s.max(speed * sampled.programmed);
                }
            }
        }
        for sampled in moves {
            for from in 0..sampled.samples.len() {
                for (solid, stopping) in self.stopping_profiles.iter_mut().enumerate() {
                    stopping.add_stop(response, sampled, from, solid);
                }
            }
        }
    }
}

impl StoppingProfile {
    /// Adds a stop that begins at the sample `from` of a move.
    fn add_stop(&mut self, response: OverrideResponse, sampled: &SampledMove, from: usize, solid: usize) {
        let headway_s = response.response_delay.headway_s();
        let steady = sampled.braking_at_constant_speed(response.rate, headway_s, from, solid);
        let (distance_m, along_program) = sampled.braking_along_program(response.rate, headway_s, from, solid);
        let braking = Braking {
            distance_m: steady.distance_m.max(along_program.distance_m),
            speed_m_s: steady.speed_m_s.max(along_program.speed_m_s),
            peak_m: steady.peak_m.max(along_program.peak_m),
        };
        self.braking_m = self.braking_m.max(steady.distance_m).max(distance_m);
        self.needed_m = thickness(self.needed_m, &braking, self.fastest_m_s, response.response_delay);
    }
}

/// Delay of the robots of a cell: one tick until the monitor sees their state, and the reaction time.
pub(super) fn response_delay(cell: &Cell) -> ResponseDelay {
    ResponseDelay { delay_s: cell.timing.tick_s + cell.monitoring.reaction_delay_s, tick_s: cell.timing.tick_s }
}

/// A move, sampled every `step_s`.
struct SampledMove {
    programmed: f64,
    step_s: f64,
    samples: Vec<MoveSample>,
}

impl SampledMove {
    /// Braking from a sample at constant joint velocity: the override falls from the programmed value to 0 and is half
    /// of that value on average.
    fn braking_at_constant_speed(&self, rate: f64, headway_s: f64, from: usize, solid: usize) -> Braking {
        let now = &self.samples[from];
        let speed_m_s = now.speeds[solid] * self.programmed;
        let distance_m = speed_m_s * self.programmed * now.stop_time.max(1.0 / rate) / 2.0;
        let delay_m = speed_m_s * headway_s;
        let peak_m =
            if delay_m < 2.0 * distance_m { distance_m + delay_m * delay_m / (4.0 * distance_m) } else { delay_m };
        Braking { distance_m, speed_m_s, peak_m }
    }

    /// Distance from a sample to rest along the program, and the braking that it needs.
    ///
    /// The stop time n falls by one second per second (`motion::ProgramClock`), so `∫ m du = n²/2` over the program's
    /// time u, with the stop time m at override 1. If the program decelerates by itself, the robot follows it: the
    /// override never rises.
    fn braking_along_program(&self, rate: f64, headway_s: f64, from: usize, solid: usize) -> (f64, Braking) {
        let samples = &self.samples[from..];
        let stop_time = self.programmed * samples[0].stop_time;
        let all = stop_time * stop_time / 2.0;
        // Half of the square of the override falls linearly.
        let mut left = self.programmed * self.programmed / 2.0;
        let (mut spent, mut distance) = (0.0, 0.0);
        let mut braking =
            Braking { distance_m: 0.0, speed_m_s: 0.0, peak_m: headway_s * samples[0].speeds[solid] * self.programmed };
        for (a, b) in samples.iter().zip(&samples[1..]) {
            if left <= 0.0 && spent >= all {
                break;
            }
            let (mean, speed) = (f64::midpoint(a.stop_time, b.stop_time), a.speeds[solid].max(b.speeds[solid]));
            if spent < all {
                braking.speed_m_s = braking.speed_m_s.max(speed * stop_time / b.stop_time.min(a.stop_time).max(1e-9));
            }
            let now = left;
            left = remaining_half_square(left, a.stop_time, b.stop_time, self.step_s, rate);
            let share = if left > 0.0 { 1.0 } else { now.max(0.0) / (now - left).max(f64::MIN_POSITIVE) };
            let step_m = f64::midpoint(a.speeds[solid], b.speeds[solid]) * self.step_s;
            distance += step_m * share.min(1.0);
            braking.peak_m = braking.peak_m.max(distance + headway_s * speed * (2.0 * left.max(0.0)).sqrt());
            spent += mean * self.step_s;
            if spent <= all {
                braking.distance_m = braking.distance_m.max(distance * all / spent.max(f64::MIN_POSITIVE));
            }
        }
        braking.distance_m = braking.distance_m.max(distance);
        (distance, braking)
    }
}

/// The remaining half square of the override after a step (s, at override 1) in which the stop time changes from `a` to
/// `b`, limited by the braking and by the rate limit, whichever is slower.
fn remaining_half_square(left: f64, a: f64, b: f64, step_s: f64, rate: f64) -> f64 {
    let braked = if b > 1e-9 { (a * a * left - f64::midpoint(a, b) * step_s) / (b * b) } else { f64::NEG_INFINITY };
    let limited = if rate.is_finite() { left - rate * step_s } else { f64::NEG_INFINITY };
    left.min(braked.max(limited))
}

/// Calls `visit` for every move of a plan, with its override, its sampling step (s), its samples and what the robot
/// holds.
///
/// Samples are at equal steps of time at override 1. Repeated moves are visited once. If the programmed override falls
/// before a move, the larger value still applies, because the robot reacts `delay_s` later.
fn for_each_move(plan: &ProgramPlan, delay_s: f64, mut visit: impl FnMut(f64, f64, &[TrajectoryPoint], &HeldObjects)) {
    let mut programmed = plan.speed_override;
    let mut before = programmed;
    let mut visited = HashSet::new();
    let mut held = HeldObjects::default();
    for step in &plan.steps {
        let effective = programmed.max(before);
        let (key, duration): (*const (), f64) = match step {
            PlanStep::Override(o) => {
                programmed = *o;
                continue;
            }
            PlanStep::Wait(s) if *s > delay_s => {
                before = programmed;
                continue;
            }
            PlanStep::Grip(action) => {
                held.apply(action);
                // The same moves count again, with something else in the hand.
                visited.clear();
                continue;
            }
            PlanStep::Move(m) => (Arc::as_ptr(m).cast(), m.duration()),
            PlanStep::Play(p) | PlanStep::Planned { play: p, .. } => (Arc::as_ptr(p).cast(), p.duration()),
            _ => continue,
        };
        before = programmed;
        if visited.insert((key, effective.to_bits())) {
            let (step_s, times) = sample_times(duration);
            visit(effective, step_s, &times.filter_map(|t| point_at(step, t)).collect::<Vec<_>>(), &held);
        }
    }
}

fn point_at(step: &PlanStep, time_s: f64) -> Option<TrajectoryPoint> {
    match step {
        PlanStep::Move(m) => Some(m.at(time_s)),
        PlanStep::Play(p) | PlanStep::Planned { play: p, .. } => Some(p.at(time_s)),
        _ => None,
    }
}

fn sample_times(duration_s: f64) -> (f64, impl Iterator<Item = f64>) {
    let count = (duration_s / STEP_S).ceil().clamp(SAMPLES[0], SAMPLES[1]) as usize;
    (duration_s / count as f64, (0..=count).map(move |i| duration_s * i as f64 / count as f64))
}

/// One sample of a move at override 1.
struct MoveSample {
    /// Stop time of the slowest joint, s.
    stop_time: f64,
    /// Largest speed of any point of each volume, m/s.
    speeds: Vec<f64>,
}

struct MoveSampler<'a> {
    limits: &'a [JointLimits],
    solids: &'a [LinkSolid],
    chain: &'a Chain,
    state: ChainState,
}

impl MoveSampler<'_> {
    fn at(&mut self, point: &TrajectoryPoint, held: &HeldObjects) -> MoveSample {
        self.state.q.copy_from_slice(&point.q);
        self.state.qd.copy_from_slice(&point.dq);
        self.chain.forward_motion(&mut self.state);
        let speed = |r: &LinkSolid| {
            if r.grip.as_ref().is_some_and(|grip| !held.actions().contains(grip)) {
                return 0.0;
            }
            r.hull.fastest(&self.state.link_in_root(r.link), &self.state.link_motion(r.link))
        };
        let stop_times = point.dq.iter().zip(self.limits).map(|(v, l)| v.abs() / l.stop);
        MoveSample { stop_time: stop_times.fold(0.0, f64::max), speeds: self.solids.iter().map(speed).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DELAY: ResponseDelay = ResponseDelay { delay_s: 0.002, tick_s: 0.002 };

    fn profile(programmed: f64, rate: f64, samples: &[(f64, f64)]) -> Profile {
        let samples = samples.iter().map(|m| MoveSample { stop_time: m.0, speeds: vec![m.1] }).collect();
        let mut profile =
            Profile { start: Vec::new(), stopping_profiles: vec![StoppingProfile::default()], braking_s: 0.0 };
        profile.add_moves(
            OverrideResponse { response_delay: DELAY, rate },
            &[SampledMove { programmed, step_s: 0.01, samples }],
        );
        profile
    }

    #[test]
    fn a_steady_joint_needs_half_of_its_stop_time() {
        // 2 m/s, stop time 0.25 s: v²/2a = 0.25 m.
        let steady = [(0.25, 2.0); 100];
        let close =
            |p: &Profile, distance: f64| assert!((p.stopping_profiles[0].braking_m - distance).abs() < 1e-12, "{p:?}");
        close(&profile(1.0, f64::INFINITY, &steady), 0.25);
        close(&profile(0.5, f64::INFINITY, &steady), 0.0625);
        close(&profile(1.0, 2.0, &steady), 0.5);
        assert_eq!(profile(0.5, f64::INFINITY, &steady).stopping_profiles[0].fastest_m_s, 1.0);
    }

    #[test]
    fn a_point_that_speeds_up_while_braking_needs_more_distance() {
        // The speed rises while the slowest joint, which determines the stop time, keeps its speed.
        let samples: Vec<_> = (0..200).map(|i| if i < 10 { (0.25, 1.0) } else { (0.25, 2.0) }).collect();
        let stopping = profile(1.0, f64::INFINITY, &samples[..30]).stopping_profiles[0];
        assert!(stopping.braking_m > 0.125 && stopping.needed_m > stopping.braking_m, "{stopping:?}");
    }

    #[test]
    fn an_override_never_rises_while_the_robot_brakes() {
        // The slowest joint reaches its end: the override stays.
        let (slow, fast) = (0.25, 0.05);
        assert_eq!(remaining_half_square(0.1, slow, fast, 0.01, f64::INFINITY), 0.1);
        assert!(remaining_half_square(0.1, fast, slow, 0.01, f64::INFINITY) < 0.0);
    }
}
