//! Time along a program: slowed by the override, never faster than the joints can follow, never backwards.

use super::{Geometry, Plan, PlanStep, Point};
use crate::JointLimits;

/// Acceleration left for speeding up again even where following the curve takes more, as a share of it.
const RESERVE: f64 = 0.1;
/// How often the end of a tick is looked at while the robot brakes.
const LOOKS: u32 = 4;
/// In the first moments of a move its direction is taken from this time, s: at rest there is none.
const AHEAD_S: f64 = 0.05;

/// Where a robot is in its plan.
#[derive(Debug)]
pub struct Clock {
    plan: Plan,
    limits: Vec<JointLimits>,
    step: usize,
    /// Time in the step at override 1, s; for a wait, time waited.
    time: f64,
    /// dτ/dt: how fast the program's time runs, 0..1.
    rate: f64,
    /// dσ/dt of the last advance, 1/s.
    rate_change: f64,
    programmed: f64,
    here: Point,
    intent: Vec<f64>,
    switches: Vec<(usize, bool)>,
    held: bool,
}

impl Clock {
    /// At the start of a plan.
    pub fn new(plan: Plan, limits: Vec<JointLimits>) -> Self {
        let programmed = plan.speed_override;
        let here =
            Point { first: vec![0.0; plan.start.len()], second: vec![0.0; plan.start.len()], q: plan.start.clone() };
        let mut clock = Self {
            plan,
            limits,
            step: 0,
            time: 0.0,
            rate: 0.0,
            rate_change: 0.0,
            programmed,
            intent: here.first.clone(),
            here,
            switches: Vec::new(),
            held: false,
        };
        clock.pass_instants();
        clock.look();
        // A program begins at full rate: its own time law starts from rest.
        clock.rate = clock.programmed;
        clock
    }

    /// Joint values now, with derivatives by the program's time (that is, at override 1).
    pub fn point(&self) -> &Point {
        &self.here
    }

    /// Joint velocities that the program asks for at override 1, rad/s or m/s. Where a move is about to begin from rest,
    /// those shortly after its begin: a monitor that knows directions must see where the robot wants to go.
    pub fn intent(&self) -> &[f64] {
        &self.intent
    }

    /// Joint velocities now, rad/s or m/s.
    pub fn velocity(&self) -> impl Iterator<Item = f64> + '_ {
        self.here.first.iter().map(|v| v * self.rate)
    }

    /// Joint accelerations now.
    pub fn acceleration(&self) -> impl Iterator<Item = f64> + '_ {
        let (square, change) = (self.rate * self.rate, self.rate_change);
        self.here.first.iter().zip(&self.here.second).map(move |(v, a)| a * square + v * change)
    }

    /// How fast the program's time runs, 0..1.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The override that the program asks for, 0..1.
    pub fn programmed_override(&self) -> f64 {
        self.programmed
    }

    /// The step that is under way, and the time in it (s, at override 1; for a wait, time waited).
    pub fn place(&self) -> (usize, f64) {
        (self.step, self.time)
    }

    /// True after the last step.
    pub fn finished(&self) -> bool {
        self.step >= self.plan.steps.len()
    }

    /// True while a move is under way.
    pub fn moving(&self) -> bool {
        matches!(self.plan.steps.get(self.step), Some(PlanStep::Move(_) | PlanStep::Play(_)))
    }

    /// True while the program waits.
    pub fn waiting(&self) -> bool {
        matches!(self.plan.steps.get(self.step), Some(PlanStep::Wait(_)))
    }

    /// Where the joint move that is under way ends; `None` where every point of what is under way counts.
    pub fn end_of_joint_move(&self) -> Option<Vec<f64>> {
        match self.plan.steps.get(self.step) {
            Some(PlanStep::Move(m)) if matches!(m.geometry(), Geometry::Joint { .. }) => Some(m.end()),
            _ => None,
        }
    }

    /// Goes to the end of the joint move at once: the robot is brought there on another way. What follows begins with the
    /// next [`Clock::advance`] that is not [held](Clock::hold).
    pub fn skip_move(&mut self) {
        let Some(PlanStep::Move(m)) = self.plan.steps.get(self.step) else { return };
        (self.time, self.rate, self.rate_change) = (m.duration(), 0.0, 0.0);
        self.look();
    }

    /// Region switches since the last call: index of the region, on or off.
    pub fn take_switches(&mut self) -> Vec<(usize, bool)> {
        std::mem::take(&mut self.switches)
    }

    /// Goes on for `dt` seconds under the override `wanted`.
    pub fn advance(&mut self, dt: f64, wanted: f64) {
        let wanted = wanted.clamp(0.0, 1.0);
        let next =
            if wanted < self.rate { self.braked(dt, wanted) } else { wanted.min(self.rate + self.largest_rise() * dt) };
        let mean = f64::midpoint(self.rate, next);
        self.rate_change = (next - self.rate) / dt;
        self.rate = next;
        let duration = match self.plan.steps.get(self.step) {
            None => return,
            Some(PlanStep::Wait(s)) => {
                self.time += dt;
                *s
            }
            Some(PlanStep::Move(m)) => {
                self.time += dt * mean;
                m.duration()
            }
            Some(PlanStep::Play(p)) => {
                self.time += dt * mean;
                p.duration()
            }
            Some(_) => 0.0,
        };
        if self.time >= duration - 1e-12 {
            if self.held {
                (self.time, self.rate, self.rate_change) = (duration, 0.0, 0.0);
            } else {
                self.end_step(duration);
            }
        }
        self.look();
    }

    /// While held, no step ends: the robot is not where its program has it, and what comes next must not begin.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
    }

    /// The end is met exactly: steps meet at rest.
    fn end_step(&mut self, duration: f64) {
        self.time = duration;
        self.look();
        self.step += 1;
        self.time = 0.0;
        self.pass_instants();
    }

    /// The rate after braking for `dt` seconds, not below `wanted`.
    ///
    /// The robot brakes along its path: its stop time, the longest that any joint needs to come to rest by itself, falls by a
    /// second per second. A program that speeds up meanwhile makes its time fall faster; one that slows down harder by itself
    /// is followed.
    fn braked(&self, dt: f64, wanted: f64) -> f64 {
        let left = self.stop_time(&self.here.first) * self.rate - dt;
        if left <= 0.0 {
            return wanted;
        }
        let mut rate = self.rate;
        for _ in 0..LOOKS {
            let ahead = self.point_at(self.time + dt * f64::midpoint(self.rate, rate));
            let stop_time = ahead.map_or(0.0, |p| self.stop_time(&p.first));
            let fits = if stop_time * rate > left { left / stop_time } else { rate };
            if fits >= rate {
                break;
            }
            rate = fits;
        }
        rate.max(wanted)
    }

    /// The longest time that any joint needs to come to rest from these velocities, s.
    fn stop_time(&self, velocity: &[f64]) -> f64 {
        velocity.iter().zip(&self.limits).fold(0.0, |most, (v, l)| f64::max(most, v.abs() / l.stop))
    }

    /// Where a time (s) of the step under way is; `None` where nothing moves.
    fn point_at(&self, time: f64) -> Option<Point> {
        match self.plan.steps.get(self.step) {
            Some(PlanStep::Move(m)) => Some(m.at(time)),
            Some(PlanStep::Play(p)) => Some(p.at(time)),
            _ => None,
        }
    }

    /// How fast the rate may rise now, 1/s.
    ///
    /// With `q̇ = q′σ` and `q̈ = q″σ² + q′σ̇`, `|q̈| ≤ a` leaves `σ̇ ≤ (a − |q″|σ²) / |q′|` per joint.
    fn largest_rise(&self) -> f64 {
        let square = self.rate * self.rate;
        let mut rise = f64::INFINITY;
        for ((first, second), l) in self.here.first.iter().zip(&self.here.second).zip(&self.limits) {
            let speed = first.abs();
            if speed >= 1e-12 {
                rise = rise.min((l.acceleration - second.abs() * square).max(RESERVE * l.acceleration) / speed);
            }
        }
        // A finite rate keeps 0 · ∞ out of the products.
        rise.min(1e9)
    }

    /// Does the steps that take no time.
    fn pass_instants(&mut self) {
        loop {
            match self.plan.steps.get(self.step) {
                Some(PlanStep::Switch { region, active }) => self.switches.push((*region, *active)),
                Some(PlanStep::Override(o)) => self.programmed = *o,
                Some(PlanStep::Move(m)) if m.duration() <= 0.0 => {}
                Some(PlanStep::Wait(s)) if *s <= 0.0 => {}
                _ => return,
            }
            self.step += 1;
        }
    }

    fn look(&mut self) {
        let point = self.point_at(self.time);
        let moves = point.is_some();
        if let Some(point) = point {
            self.here = point;
        } else {
            self.here.first.fill(0.0);
            self.here.second.fill(0.0);
        }
        self.intent.clone_from(&self.here.first);
        let duration = match self.plan.steps.get(self.step) {
            Some(PlanStep::Move(m)) => m.duration(),
            Some(PlanStep::Play(p)) => p.duration(),
            _ => 0.0,
        };
        let ahead = AHEAD_S.min(duration / 2.0);
        if moves && self.time < ahead {
            self.intent = self.point_at(ahead).map_or_else(Vec::new, |p| p.first);
        }
    }
}
