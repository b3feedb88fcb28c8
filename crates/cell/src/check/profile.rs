//! How fast the guarded parts of a robot go in its program, and how far they go until they stand.

use std::collections::HashSet;
use std::rc::Rc;

use elbowroom_formats::FormatError;
use elbowroom_kinematics::{Chain, ChainState, LinkId};

use super::outline::Outline;
use super::thickness::{Braking, Lateness, thickness};
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
    /// Thickness of the warning zone from which all of its points stop in time, m.
    pub needed_m: f64,
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

/// How the robot obeys.
#[derive(Debug, Clone, Copy)]
struct Obedience {
    lateness: Lateness,
    /// The override falls by no more than this per second; infinite for no limit.
    rate: f64,
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
        let obedience = Obedience {
            lateness: lateness(cell),
            rate: Some(cell.laws.laws.override_rate).filter(|r| *r > 0.0).unwrap_or(f64::INFINITY),
        };
        let mut courses = Vec::new();
        each_move(&plan, obedience.lateness.late_s, |programmed, step_s, points| {
            let moments = points.iter().map(|p| look.at(p)).collect();
            courses.push(Course { programmed, step_s, moments });
        });
        profile.take(obedience, &courses);
        Ok(profile)
    }

    /// Takes in the moves. The largest speeds come first: what a zone needs depends on them.
    fn take(&mut self, obedience: Obedience, courses: &[Course]) {
        for course in courses {
            for now in &course.moments {
                let fall_s = now.stop_time.max(1.0 / obedience.rate);
                self.braking_s = self.braking_s.max(course.programmed * fall_s);
                for (pace, speed) in self.paces.iter_mut().zip(&now.speeds) {
                    pace.fastest_m_s = pace.fastest_m_s.max(speed * course.programmed);
                }
            }
        }
        for course in courses {
            for from in 0..course.moments.len() {
                for (rider, pace) in self.paces.iter_mut().enumerate() {
                    pace.take(obedience, course, from, rider);
                }
            }
        }
    }
}

impl Pace {
    /// The robot is told to stop at the moment `from` of a course.
    fn take(&mut self, obedience: Obedience, course: &Course, from: usize, rider: usize) {
        let lasting_s = obedience.lateness.lasting_s();
        let steady = course.steady(obedience.rate, lasting_s, from, rider);
        let (way_m, course) = course.follow(obedience.rate, lasting_s, from, rider);
        let braking = Braking {
            way_m: steady.way_m.max(course.way_m),
            speed_m_s: steady.speed_m_s.max(course.speed_m_s),
            peak_m: steady.peak_m.max(course.peak_m),
        };
        self.braking_m = self.braking_m.max(steady.way_m).max(way_m);
        self.needed_m = thickness(self.needed_m, &braking, self.fastest_m_s, obedience.lateness);
    }
}

/// How late the robots of a cell obey: one tick until the monitor sees where they are, and the reaction time.
pub(super) fn lateness(cell: &Cell) -> Lateness {
    Lateness { late_s: cell.tick_s + cell.laws.obeyed_after_s, tick_s: cell.tick_s }
}

/// A move, looked at every `step_s`.
struct Course {
    programmed: f64,
    step_s: f64,
    moments: Vec<Moment>,
}

impl Course {
    /// Braking from a moment, as if its speed were kept: the override falls from the programmed one to 0, half of that on
    /// average.
    fn steady(&self, rate: f64, lasting_s: f64, from: usize, rider: usize) -> Braking {
        let now = &self.moments[from];
        let speed_m_s = now.speeds[rider] * self.programmed;
        let way_m = speed_m_s * self.programmed * now.stop_time.max(1.0 / rate) / 2.0;
        let late_m = speed_m_s * lasting_s;
        let peak_m = if late_m < 2.0 * way_m { way_m + late_m * late_m / (4.0 * way_m) } else { late_m };
        Braking { way_m, speed_m_s, peak_m }
    }

    /// The way from a moment to rest, along the program as it goes on, and what it needs.
    ///
    /// The stop time n falls by one second per second (`motion::Clock`), so that `∫ m du = n²/2` over the program's time u, m
    /// being the stop time at override 1. A program that slows down by itself is followed: the override never rises.
    fn follow(&self, rate: f64, lasting_s: f64, from: usize, rider: usize) -> (f64, Braking) {
        let moments = &self.moments[from..];
        let stop_time = self.programmed * moments[0].stop_time;
        let all = stop_time * stop_time / 2.0;
        // Half of the square of the override, which is what falls evenly.
        let mut left = self.programmed * self.programmed / 2.0;
        let (mut spent, mut way) = (0.0, 0.0);
        let mut braking =
            Braking { way_m: 0.0, speed_m_s: 0.0, peak_m: lasting_s * moments[0].speeds[rider] * self.programmed };
        for (a, b) in moments.iter().zip(&moments[1..]) {
            if left <= 0.0 && spent >= all {
                break;
            }
            let (mean, speed) = (f64::midpoint(a.stop_time, b.stop_time), a.speeds[rider].max(b.speeds[rider]));
            if spent < all {
                braking.speed_m_s = braking.speed_m_s.max(speed * stop_time / b.stop_time.min(a.stop_time).max(1e-9));
            }
            let now = left;
            left = fallen(left, a.stop_time, b.stop_time, self.step_s, rate);
            let share = if left > 0.0 { 1.0 } else { now.max(0.0) / (now - left).max(f64::MIN_POSITIVE) };
            let stretch = f64::midpoint(a.speeds[rider], b.speeds[rider]) * self.step_s;
            way += stretch * share.min(1.0);
            braking.peak_m = braking.peak_m.max(way + lasting_s * speed * (2.0 * left.max(0.0)).sqrt());
            spent += mean * self.step_s;
            if spent <= all {
                braking.way_m = braking.way_m.max(way * all / spent.max(f64::MIN_POSITIVE));
            }
        }
        braking.way_m = braking.way_m.max(way);
        (way, braking)
    }
}

/// What is left of half of the square of the override after a step (s, at override 1) in which the stop time goes from `a` to
/// `b`: the slower of braking and of a limited rate counts.
fn fallen(left: f64, a: f64, b: f64, step_s: f64, rate: f64) -> f64 {
    let braked = if b > 1e-9 { (a * a * left - f64::midpoint(a, b) * step_s) / (b * b) } else { f64::NEG_INFINITY };
    let limited = if rate.is_finite() { left - rate * step_s } else { f64::NEG_INFINITY };
    left.min(braked.max(limited))
}

/// Shows every move of a plan at equal steps of time, at override 1: the override that counts, the step (s), the points. What
/// is repeated is shown once. Where the programmed override falls before a move, the larger one counts still: the robot
/// hears of it `late_s` after.
fn each_move(plan: &Plan, late_s: f64, mut show: impl FnMut(f64, f64, &[Point])) {
    let mut programmed = plan.speed_override;
    let mut before = programmed;
    let mut seen = HashSet::new();
    for step in &plan.steps {
        let counts = programmed.max(before);
        let (key, duration): (*const (), f64) = match step {
            PlanStep::Override(o) => {
                programmed = *o;
                continue;
            }
            PlanStep::Wait(s) if *s > late_s => {
                before = programmed;
                continue;
            }
            PlanStep::Move(m) => (Rc::as_ptr(m).cast(), m.duration()),
            PlanStep::Play(p) => (Rc::as_ptr(p).cast(), p.duration()),
            _ => continue,
        };
        before = programmed;
        if seen.insert((key, counts.to_bits())) {
            let (step_s, times) = instants(duration);
            show(counts, step_s, &times.filter_map(|t| point_at(step, t)).collect::<Vec<_>>());
        }
    }
}

fn point_at(step: &PlanStep, time_s: f64) -> Option<Point> {
    match step {
        PlanStep::Move(m) => Some(m.at(time_s)),
        PlanStep::Play(p) => Some(p.at(time_s)),
        _ => None,
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

    const LATE: Lateness = Lateness { late_s: 0.002, tick_s: 0.002 };

    fn profile(programmed: f64, rate: f64, moments: &[(f64, f64)]) -> Profile {
        let moments = moments.iter().map(|m| Moment { stop_time: m.0, speeds: vec![m.1] }).collect();
        let mut profile = Profile { start: Vec::new(), paces: vec![Pace::default()], braking_s: 0.0 };
        profile.take(Obedience { lateness: LATE, rate }, &[Course { programmed, step_s: 0.01, moments }]);
        profile
    }

    #[test]
    fn a_steady_joint_needs_half_of_its_stop_time() {
        // 2 m/s, stop time 0.25 s: v²/2a = 0.25 m.
        let steady = [(0.25, 2.0); 100];
        let close = |p: &Profile, way: f64| assert!((p.paces[0].braking_m - way).abs() < 1e-12, "{p:?}");
        close(&profile(1.0, f64::INFINITY, &steady), 0.25);
        close(&profile(0.5, f64::INFINITY, &steady), 0.0625);
        close(&profile(1.0, 2.0, &steady), 0.5);
        assert_eq!(profile(0.5, f64::INFINITY, &steady).paces[0].fastest_m_s, 1.0);
    }

    #[test]
    fn a_point_that_grows_faster_while_it_brakes_goes_farther() {
        // Its speed grows while the slowest joint, which says how long the robot brakes, keeps its own.
        let moments: Vec<_> = (0..200).map(|i| if i < 10 { (0.25, 1.0) } else { (0.25, 2.0) }).collect();
        let pace = profile(1.0, f64::INFINITY, &moments[..30]).paces[0];
        assert!(pace.braking_m > 0.125 && pace.needed_m > pace.braking_m, "{pace:?}");
    }

    #[test]
    fn an_override_never_rises_while_the_robot_brakes() {
        // The slowest joint comes to its end: the override keeps what it has fallen to.
        let (slow, fast) = (0.25, 0.05);
        assert_eq!(fallen(0.1, slow, fast, 0.01, f64::INFINITY), 0.1);
        assert!(fallen(0.1, fast, slow, 0.01, f64::INFINITY) < 0.0);
    }
}
