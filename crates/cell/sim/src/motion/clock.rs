//! Execution of a program in time: scaled by the override, within the joints' decelerations, never backwards.

use std::sync::Arc;

use elbowroom_cell::PathPlanner;
use elbowroom_cell::trajectory::Playback;
use elbowroom_kinematics::JointLimits;
use elbowroom_kinematics::TrajectoryPoint;
use elbowroom_robot::ObjectId;

use super::instant_steps::{InstantSteps, RegionSwitch};
use super::{GripAction, MovePath, PlanStep, ProgramPlan};
use crate::replanning::{ExecutedMotion, PathAhead, PlannedGoal, SAMPLE_S};

/// Smallest fraction of the acceleration that is kept for speeding up along a curve.
const RESERVE: f64 = 0.1;
/// Iterations for the state at the end of a braking tick.
const SAMPLES: u32 = 4;
/// Speed below which a joint is at rest, rad/s or m/s.
const REST_SPEED: f64 = 1e-9;
/// Time ahead from which the intended velocity is taken at the start of a move from rest, s.
const LOOKAHEAD_S: f64 = 0.05;

/// Largest fraction of any joint's top speed that a step uses.
fn joint_share(step: &PlanStep, limits: &[JointLimits]) -> f64 {
    match step {
        PlanStep::Move(m) => m.joint_share,
        PlanStep::Play(play) | PlanStep::Planned { play, .. } => {
            let share = |(joint, limit): (usize, &JointLimits)| play.fastest(joint).0 / limit.velocity;
            limits.iter().enumerate().map(share).fold(0.0, f64::max)
        }
        _ => 0.0,
    }
}

/// Position of a robot in its program.
#[derive(Debug)]
pub struct ProgramClock {
    plan: ProgramPlan,
    limits: Vec<JointLimits>,
    step: usize,
    path_number: u64,
    /// Time in the step at override 1, s; in a wait, time waited.
    time: f64,
    /// dτ/dt: rate of the program's time, 0..1.
    rate: f64,
    /// Change of the rate in the last advance, 1/s.
    rate_change: f64,
    programmed: f64,
    here: TrajectoryPoint,
    intent: Vec<f64>,
    /// Largest fraction of any joint's top speed over all steps.
    speed_share: f64,
    executed: InstantSteps,
    held: bool,
    /// True if a recording that begins in motion starts with the next advance.
    joins: bool,
}

impl ProgramClock {
    /// Starts a program.
    pub fn new(plan: ProgramPlan, limits: Vec<JointLimits>) -> Self {
        let programmed = plan.speed_override;
        let here = TrajectoryPoint::at_rest(plan.start.clone());
        let fastest = plan.steps.iter().map(|step| joint_share(step, &limits)).fold(0.0, f64::max);
        // A program without moves sets no speed limit for the return of its robot.
        let speed_share = if fastest > 0.0 { fastest } else { 1.0 };
        let mut clock = Self {
            plan,
            limits,
            step: 0,
            path_number: 0,
            time: 0.0,
            rate: 0.0,
            rate_change: 0.0,
            programmed,
            intent: here.dq.clone(),
            here,
            speed_share,
            executed: InstantSteps::default(),
            held: false,
            joins: false,
        };
        clock.execute_instant_steps();
        clock.rate = clock.programmed;
        clock.start_step();
        clock
    }

    /// Starts another program, once this one is over.
    pub fn restart(&mut self, plan: ProgramPlan) {
        let paths = self.path_number;
        *self = Self::new(plan, std::mem::take(&mut self.limits));
        self.path_number += paths;
    }

    /// Current joint values, with derivatives with respect to program time (that is, at override 1).
    pub fn point(&self) -> &TrajectoryPoint {
        &self.here
    }

    /// Intended joint velocities at override 1, rad/s or m/s.
    ///
    /// At the start of a move from rest, these are the velocities shortly after the start: a direction-aware monitor
    /// needs the direction of the motion.
    pub fn intent(&self) -> &[f64] {
        &self.intent
    }

    /// Largest fraction of any joint's top speed that the program uses; 1 for a program without moves.
    pub fn speed_share(&self) -> f64 {
        self.speed_share
    }

    /// Current joint velocities, rad/s or m/s.
    pub fn velocity(&self) -> impl Iterator<Item = f64> + '_ {
        self.here.dq.iter().map(|v| v * self.rate)
    }

    /// Current joint accelerations, rad/s² or m/s².
    pub fn acceleration(&self) -> impl Iterator<Item = f64> + '_ {
        let (square, change) = (self.rate * self.rate, self.rate_change);
        self.here.dq.iter().zip(&self.here.ddq).map(move |(v, a)| a * square + v * change)
    }

    /// Rate of the program's time, 0..1.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// The programmed override, 0..1.
    pub fn programmed_override(&self) -> f64 {
        self.programmed
    }

    /// The current step, and the time in it (s, at override 1; in a wait, time waited).
    pub fn position(&self) -> (usize, f64) {
        (self.step, self.time)
    }

    /// True after the last step.
    pub fn finished(&self) -> bool {
        self.step >= self.plan.steps.len()
    }

    /// True during a move.
    pub fn moving(&self) -> bool {
        matches!(self.plan.steps.get(self.step), Some(PlanStep::Move(_) | PlanStep::Play(_) | PlanStep::Planned { .. }))
    }

    /// True at the start of a move, before any motion.
    pub fn is_at_start(&self) -> bool {
        self.moving() && self.time <= 0.0
    }

    /// True during a wait.
    pub fn waiting(&self) -> bool {
        matches!(self.plan.steps.get(self.step), Some(PlanStep::Wait(_)))
    }

    /// End of the current joint move; `None` for other steps, whose path must be followed.
    pub fn end_of_joint_move(&self) -> Option<Vec<f64>> {
        match self.plan.steps.get(self.step) {
            Some(PlanStep::Move(m)) if matches!(m.geometry(), MovePath::Joint { .. }) => Some(m.end()),
            _ => None,
        }
    }

    /// Jumps to the end of the joint move, which the robot reaches on another path.
    ///
    /// The next step starts with the next [`ProgramClock::advance`] that is not [held](ProgramClock::hold).
    pub fn skip_move(&mut self) {
        let Some(PlanStep::Move(m)) = self.plan.steps.get(self.step) else { return };
        (self.time, self.rate, self.rate_change) = (m.duration(), 0.0, 0.0);
        self.update_point();
    }

    /// Rest of the step's path: times in the step (s, at override 1), at most `step_s` apart, and joint values.
    ///
    /// Empty for a step without motion.
    fn path_ahead(&self, step_s: f64) -> Vec<(f64, Vec<f64>)> {
        let end_s = self.duration();
        let count = ((end_s - self.time).max(0.0) / step_s).ceil() as usize;
        let times = (0..=count).map(|n| (self.time + step_s * n as f64).min(end_s));
        times.filter_map(|t| self.point_at(t).map(|p| (t, p.q))).collect()
    }

    /// Time in the step (s, at override 1) at which the robot comes to rest if it continues for `coast_s` (s) and then
    /// brakes, in ticks of `dt` (s).
    pub fn rests_at(&self, coast_s: f64, dt: f64) -> f64 {
        let (mut time, mut rate) = (self.time, self.rate);
        let speeding = (rate + self.max_rate_increase() * coast_s).min(self.programmed.max(rate));
        time += coast_s * speeding;
        rate = speeding;
        while rate > 0.0 && time < self.duration() {
            let Some(here) = self.point_at(time) else { break };
            let next = self.braked(time, rate, &here.dq, dt).max(0.0);
            time += dt * f64::midpoint(rate, next);
            rate = next;
        }
        time
    }

    /// The number of the present path: a step, and a path that replaces another, begin a new one.
    pub fn path_number(&self) -> u64 {
        self.path_number
    }

    /// The motion that is executed now.
    pub fn executed_motion(&self) -> ExecutedMotion {
        let planned = match self.plan.steps.get(self.step) {
            Some(PlanStep::Planned { play, speed, planner, keep }) => {
                Some(PlannedGoal { q: play.q(play.duration()), speed: *speed, planner: *planner, keep: *keep })
            }
            _ => None,
        };
        ExecutedMotion {
            path: self.path_number,
            ahead: PathAhead::of(self.path_ahead(SAMPLE_S)),
            planned,
            q: self.here.q.clone(),
            qd: self.velocity().collect(),
            rate: self.rate,
            programmed_override: self.programmed_override(),
        }
    }

    /// Joint values at the ends of the moves that are planned on the robot's joint-space map, rad or m.
    pub fn moves_on_map(&self) -> impl Iterator<Item = Vec<f64>> {
        self.plan.steps.iter().filter_map(|step| match step {
            PlanStep::Planned { play, planner: PathPlanner::Grid, .. } => Some(play.q(play.duration())),
            _ => None,
        })
    }

    /// Replaces the planned move of this step by another one with the same end.
    ///
    /// The robot enters the new move at the time `entry_s` (s, at override 1) and at `rate`.
    pub fn replace_planned_move(&mut self, play: Arc<Playback>, entry_s: f64, rate: f64) {
        let Some(PlanStep::Planned { play: old, .. }) = self.plan.steps.get_mut(self.step) else { return };
        *old = play;
        self.path_number += 1;
        (self.time, self.rate, self.rate_change) = (entry_s, rate, 0.0);
        self.update_point();
    }

    /// Duration of the step at override 1, s; 0 for one without motion.
    fn duration(&self) -> f64 {
        match self.plan.steps.get(self.step) {
            Some(PlanStep::Move(m)) => m.duration(),
            Some(PlanStep::Play(p) | PlanStep::Planned { play: p, .. }) => p.duration(),
            _ => 0.0,
        }
    }

    /// Region switches since the last call.
    pub fn take_switches(&mut self) -> Vec<RegionSwitch> {
        std::mem::take(&mut self.executed.switches)
    }

    /// Objects gripped and released since the last call.
    pub fn take_grips(&mut self) -> Vec<GripAction> {
        std::mem::take(&mut self.executed.grips)
    }

    /// Tools made active since the last call, in order.
    pub fn take_tools(&mut self) -> Vec<usize> {
        std::mem::take(&mut self.executed.tools)
    }

    /// Objects that the present move sets down: the program releases them before the next move.
    pub fn objects_set_down(&self) -> impl Iterator<Item = ObjectId> + '_ {
        let next = self.plan.steps.get(self.step + 1..).unwrap_or_default().iter();
        let until_move =
            next.take_while(|s| !matches!(s, PlanStep::Move(_) | PlanStep::Play(_) | PlanStep::Planned { .. }));
        let next = until_move.filter_map(|s| if let PlanStep::Grip(action) = s { Some(action) } else { None });
        // Releases of this instant count, too: the move before them ends now.
        self.executed.grips.iter().chain(next).filter(|a| !a.grips).map(|a| a.object)
    }

    /// Advances by `dt` seconds under the override `target`.
    pub fn advance(&mut self, dt: f64, target: f64) {
        let target = target.clamp(0.0, 1.0);
        let next = if target < self.rate {
            self.braked_rate(dt, target)
        } else {
            target.min(self.rate + self.max_rate_increase() * dt)
        };
        // If the rate reaches its target within this tick, the recording follows its rows from the first one. A move that
        // may not begin does not begin, whatever the rate was before.
        let keeps_next = (self.joins && next >= target) || (next <= 0.0 && self.is_at_start());
        let mean = if keeps_next { next } else { f64::midpoint(self.rate, next) };
        self.joins = false;
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
            Some(PlanStep::Play(p) | PlanStep::Planned { play: p, .. }) => {
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
        self.update_point();
    }

    /// Sets whether the current step is held. A held step does not end.
    ///
    /// A robot off its path holds its step, so that the next step does not start.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
    }

    /// Ends the step exactly at its end: consecutive steps join at rest.
    fn end_step(&mut self, duration: f64) {
        self.time = duration;
        self.update_point();
        self.step += 1;
        self.time = 0.0;
        self.start_step();
    }

    /// Starts a step. Steps start from rest at any rate, except a recording that begins in motion, which starts at rate
    /// 0.
    fn start_step(&mut self) {
        self.path_number += 1;
        self.execute_instant_steps();
        self.update_point();
        if self.here.dq.iter().any(|v| v.abs() > REST_SPEED) {
            (self.rate, self.rate_change, self.joins) = (0.0, 0.0, true);
        }
    }

    /// The rate after braking for `dt` seconds, at least `target`.
    fn braked_rate(&self, dt: f64, target: f64) -> f64 {
        self.braked(self.time, self.rate, &self.here.dq, dt).max(target)
    }

    /// The rate after braking for `dt` seconds from a time in the step, a rate, and the velocities there at override 1.
    ///
    /// The robot brakes along its path: its stop time, the longest stop time of any joint, falls by one second per
    /// second. If the program accelerates meanwhile, the rate falls faster; if the program itself decelerates harder,
    /// the rate stays.
    fn braked(&self, time: f64, rate: f64, dq: &[f64], dt: f64) -> f64 {
        let left = self.stop_time(dq) * rate - dt;
        if left <= 0.0 {
            return 0.0;
        }
        let mut braked = rate;
        for _ in 0..SAMPLES {
            let ahead = self.point_at(time + dt * f64::midpoint(rate, braked));
            let stop_time = ahead.map_or(0.0, |p| self.stop_time(&p.dq));
            let fits = if stop_time * braked > left { left / stop_time } else { braked };
            if fits >= braked {
                break;
            }
            braked = fits;
        }
        braked
    }

    /// The longest stop time of any joint from these velocities, s.
    fn stop_time(&self, velocity: &[f64]) -> f64 {
        velocity.iter().zip(&self.limits).fold(0.0, |most, (v, l)| f64::max(most, v.abs() / l.stop))
    }

    /// The point at a time (s) of the current step; `None` for a step without motion.
    fn point_at(&self, time: f64) -> Option<TrajectoryPoint> {
        match self.plan.steps.get(self.step) {
            Some(PlanStep::Move(m)) => Some(m.at(time)),
            Some(PlanStep::Play(p) | PlanStep::Planned { play: p, .. }) => Some(p.at(time)),
            _ => None,
        }
    }

    /// Upper bound of the rise of the rate, 1/s.
    ///
    /// With `q̇ = q′σ` and `q̈ = q″σ² + q′σ̇`, `|q̈| ≤ a` leaves `σ̇ ≤ (a − |q″|σ²) / |q′|` per joint.
    fn max_rate_increase(&self) -> f64 {
        let square = self.rate * self.rate;
        let mut rise = f64::INFINITY;
        for ((dq, ddq), l) in self.here.dq.iter().zip(&self.here.ddq).zip(&self.limits) {
            let speed = dq.abs();
            if speed >= 1e-12 {
                rise = rise.min((l.acceleration - ddq.abs() * square).max(RESERVE * l.acceleration) / speed);
            }
        }
        // A finite bound avoids 0 · ∞.
        rise.min(1e9)
    }

    /// Executes the steps without duration.
    fn execute_instant_steps(&mut self) {
        loop {
            match self.plan.steps.get(self.step) {
                Some(PlanStep::Switch { region, active }) => {
                    self.executed.switches.push(RegionSwitch { region: *region, active: *active });
                }
                Some(PlanStep::Override(o)) => self.programmed = *o,
                Some(PlanStep::Tool(tool)) => self.executed.tools.push(*tool),
                Some(PlanStep::Grip(action)) => self.executed.grips.push(action.clone()),
                Some(PlanStep::Move(m)) if m.duration() <= 0.0 => {}
                Some(PlanStep::Wait(s)) if *s <= 0.0 => {}
                _ => return,
            }
            self.step += 1;
        }
    }

    fn update_point(&mut self) {
        let point = self.point_at(self.time);
        let moves = point.is_some();
        if let Some(point) = point {
            self.here = point;
        } else {
            self.here.dq.fill(0.0);
            self.here.ddq.fill(0.0);
        }
        self.intent.clone_from(&self.here.dq);
        let ahead = LOOKAHEAD_S.min(self.duration() / 2.0);
        if moves && self.time < ahead {
            self.intent = self.point_at(ahead).map_or_else(Vec::new, |p| p.dq);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{PlannedPaths, plan};
    use elbowroom_robot::RobotId;

    /// Detours are at most as fast as the fastest move of the program in the cell file.
    #[test]
    fn the_share_of_a_program_is_that_of_its_fastest_move() {
        let share = |steps: &str| {
            let text = format!(
                "version = 1\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[robot.rail]\n\
                 dh = [{{ kind = \"prismatic\", min = 0, max = 2000, speed = 1000 }}]\n[program.rail]\nsteps = [{steps}]\n"
            );
            let cell = elbowroom_cell::Cell::parse("rail.toml", &text).unwrap();
            let plan = plan(&PlannedPaths::new(&cell), RobotId(0), 1, &mut Vec::new()).unwrap();
            ProgramClock::new(plan, cell.robots[0].limits.clone()).speed_share()
        };
        let [slow, fast] = [10, 30].map(|speed| format!("{{ move = \"joint\", to = [{speed}], speed = {speed} }},"));
        assert!((share(&format!("{slow}{fast}{slow}")) - 0.3).abs() < 1e-9);
        assert!((share(&slow) - 0.1).abs() < 1e-9);
        assert_eq!(share("{ wait = 1 }"), 1.0);
    }
}
