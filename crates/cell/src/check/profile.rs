//! How fast the guarded parts of a robot go in its program, and how far they go until they stand.

use std::collections::HashSet;
use std::rc::Rc;

use elbowroom_formats::FormatError;
use elbowroom_kinematics::{Chain, ChainState, LinkId};

use super::outline::Outline;
use crate::motion::{Plan, PlanStep, Point, plan};
use crate::{Cell, JointLimits};

/// A program is looked at in steps of this time (s), or finer.
const STEP_S: f64 = 0.004;
/// Fewest and most looks at one move.
const LOOKS: [f64; 2] = [32.0, 20_000.0];

/// A solid or a point that moves with a link.
#[derive(Debug, Clone)]
pub(super) struct Rider {
    pub link: LinkId,
    /// Its outline in the link's frame.
    pub outline: Outline,
}

/// What a program does to one rider.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Pace {
    /// Largest speed of any of its points, the programmed override in it, m/s.
    pub fastest_m_s: f64,
    /// Longest way of any of its points from the first deceleration to rest, m: v²/2a.
    pub braking_m: f64,
}

/// What a robot's program does.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Joint values at the beginning, rad or m.
    pub start: Vec<f64>,
    /// One per rider.
    pub paces: Vec<Pace>,
    /// Longest time from the first deceleration to rest, s.
    pub braking_s: f64,
}

impl Profile {
    /// Looks at the program of a robot (by index) in small steps.
    ///
    /// # Errors
    /// [`FormatError`] at the line of a step that cannot be done.
    pub fn of(cell: &Cell, robot: usize, riders: &[Rider]) -> Result<Self, FormatError> {
        let plan = plan(cell, robot, 1, &mut Vec::new())?;
        let mut profile =
            Self { start: plan.start.clone(), paces: vec![Pace::default(); riders.len()], braking_s: 0.0 };
        let chain = &cell.robots[robot].robot.chain;
        let mut look = Look { limits: &cell.robots[robot].limits, riders, chain, state: ChainState::new(chain) };
        let rate = cell.laws.laws.override_rate;
        let least_fall_s = if rate > 0.0 { 1.0 / rate } else { 0.0 };
        each_move(&plan, |programmed, step_s, points| {
            let moments: Vec<Moment> = points.iter().map(|p| look.at(p)).collect();
            profile.take(programmed, step_s, least_fall_s, &moments);
        });
        Ok(profile)
    }

    /// Takes in a move, looked at every `step_s`; the override takes `least_fall_s` from 1 to 0 at least.
    fn take(&mut self, programmed: f64, step_s: f64, least_fall_s: f64, moments: &[Moment]) {
        for (k, now) in moments.iter().enumerate() {
            let fall_s = now.stop_time.max(least_fall_s);
            self.braking_s = self.braking_s.max(programmed * fall_s);
            for (pace, speed) in self.paces.iter_mut().zip(&now.speeds) {
                pace.fastest_m_s = pace.fastest_m_s.max(speed * programmed);
                // At constant speed the override falls from the programmed one to 0: half of that on average.
                pace.braking_m = pace.braking_m.max(speed * programmed * programmed * fall_s / 2.0);
            }
            self.follow(programmed, step_s, least_fall_s, &moments[k..]);
        }
    }

    /// The way from the first of these moments to rest, along the program as it goes on: the stop time n falls by one second
    /// per second (`motion::Clock`), so that `∫ m du = n²/2` over the program's time u, m being the stop time at override 1.
    fn follow(&mut self, programmed: f64, step_s: f64, least_fall_s: f64, moments: &[Moment]) {
        let needed = (programmed * moments[0].stop_time).powi(2) / 2.0;
        let least_u = programmed * programmed * least_fall_s / 2.0;
        let (mut spent, mut u) = (0.0, 0.0);
        let mut ways = vec![0.0; self.paces.len()];
        for pair in moments.windows(2) {
            if spent >= needed && u >= least_u {
                break;
            }
            spent += f64::midpoint(pair[0].stop_time, pair[1].stop_time) * step_s;
            u += step_s;
            for ((way, a), b) in ways.iter_mut().zip(&pair[0].speeds).zip(&pair[1].speeds) {
                *way += f64::midpoint(*a, *b) * step_s;
            }
        }
        // The last step goes beyond rest; rounding may even have added a whole one.
        let beyond = if u > 0.0 { (needed / spent).max(least_u / u).min(1.0) } else { 1.0 };
        for (pace, way) in self.paces.iter_mut().zip(ways) {
            pace.braking_m = pace.braking_m.max(way * beyond);
        }
    }
}

/// Shows every move of a plan at equal steps of time, at override 1: the programmed override, the step (s), the points. What
/// is repeated is shown once.
fn each_move(plan: &Plan, mut show: impl FnMut(f64, f64, &[Point])) {
    let mut programmed = plan.speed_override;
    let mut seen = HashSet::new();
    for step in &plan.steps {
        match step {
            PlanStep::Override(o) => programmed = *o,
            PlanStep::Move(m) if seen.insert((Rc::as_ptr(m).cast::<()>(), programmed.to_bits())) => {
                let (step_s, times) = instants(m.duration());
                show(programmed, step_s, &times.map(|t| m.at(t)).collect::<Vec<_>>());
            }
            PlanStep::Play(p) if seen.insert((Rc::as_ptr(p).cast::<()>(), programmed.to_bits())) => {
                let (step_s, times) = instants(p.duration());
                show(programmed, step_s, &times.map(|t| p.at(t)).collect::<Vec<_>>());
            }
            _ => {}
        }
    }
}

fn instants(duration_s: f64) -> (f64, impl Iterator<Item = f64>) {
    let count = (duration_s / STEP_S).ceil().clamp(LOOKS[0], LOOKS[1]) as usize;
    (duration_s / count as f64, (0..=count).map(move |i| duration_s * i as f64 / count as f64))
}

/// One instant of a move at override 1.
struct Moment {
    /// What the slowest joint needs by itself to stop, s.
    stop_time: f64,
    /// Largest speed of any point of each rider, m/s.
    speeds: Vec<f64>,
}

struct Look<'a> {
    limits: &'a [JointLimits],
    riders: &'a [Rider],
    chain: &'a Chain,
    state: ChainState,
}

impl Look<'_> {
    fn at(&mut self, point: &Point) -> Moment {
        self.state.q.copy_from_slice(&point.q);
        self.state.qd.copy_from_slice(&point.first);
        self.chain.forward_motion(&mut self.state);
        let speed = |r: &Rider| r.outline.fastest(&self.state.link_in_root(r.link), &self.state.link_motion(r.link));
        let stop_times = point.first.iter().zip(self.limits).map(|(v, l)| v.abs() / l.stop);
        Moment { stop_time: stop_times.fold(0.0, f64::max), speeds: self.riders.iter().map(speed).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(programmed: f64, least_fall_s: f64, moments: &[(f64, f64)]) -> Profile {
        let moments: Vec<_> = moments.iter().map(|m| Moment { stop_time: m.0, speeds: vec![m.1] }).collect();
        let mut profile = Profile { start: Vec::new(), paces: vec![Pace::default()], braking_s: 0.0 };
        profile.take(programmed, 0.01, least_fall_s, &moments);
        profile
    }

    #[test]
    fn a_steady_joint_needs_half_of_its_stop_time() {
        // 2 m/s, stop time 0.25 s: v²/2a = 0.25 m.
        let steady = [(0.25, 2.0); 100];
        let close = |p: &Profile, way: f64| assert!((p.paces[0].braking_m - way).abs() < 1e-12, "{p:?}");
        close(&profile(1.0, 0.0, &steady), 0.25);
        close(&profile(0.5, 0.0, &steady), 0.0625);
        close(&profile(1.0, 0.5, &steady), 0.5);
        assert_eq!(profile(0.5, 0.0, &steady).paces[0].fastest_m_s, 1.0);
    }

    #[test]
    fn a_point_that_grows_faster_while_it_brakes_goes_farther() {
        // The slowest joint gives way to one that brakes hard: the program's time runs on.
        let moments: Vec<_> = (0..200).map(|i| if i < 10 { (0.25, 1.0) } else { (0.05, 2.0) }).collect();
        assert!(profile(1.0, 0.0, &moments).paces[0].braking_m > 0.25);
    }
}
