//! Avoidance in a run: each robot that evades goes along its path as far as what comes lets it.

use elbowroom_avoidance::fuzzy::Surface;
use elbowroom_avoidance::{
    Advice, Around, AvoidanceError, Avoider, Doing, JointLimit, Neighbour, PathKind, Reference, Seen,
};
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::ChainState;
use elbowroom_planner::{Fence, RouteOptions};
use elbowroom_scene::Scene;
use elbowroom_spatial::Motion;

use super::tick_times;
use crate::fence::RegionFence;
use crate::motion::Clock;
use crate::{AvoidanceSample, AvoidanceSpec, AvoidanceTrack, Cell};

/// Ways are planned with so many looks at most: a run is the same on every machine, …
const LOOKS: u64 = 40_000;
/// … if only it has the time, …
const PLANNING: std::time::Duration = std::time::Duration::from_mins(1);
/// … staying so far away where there is room for it, m, …
const CLEARANCES_M: [f64; 3] = [0.06, 0.02, 0.0];
/// … and so far into the warning zone of a region, as a share of it that is left, at the same try: so much is left of the speed, …
const WARNINGS: [f64; 3] = [0.25, 0.1, 0.0];
/// … and asked for again after this time, s.
const AGAIN_S: f64 = 0.5;
/// After so many in a row that found nothing, after this time, s.
const MANY: u64 = 8;
const LATER_S: f64 = 4.0;
/// Below this share of the programmed override a robot off its path is at a border: nearer, it would take too long to get away.
const BORDER: f64 = 1e-3;
/// Values of each input in a picture of the rules.
const SURFACE: usize = 33;

/// One robot that evades.
#[derive(Debug)]
pub(super) struct Evasive<'s> {
    avoider: Avoider<'s>,
    spec: &'s AvoidanceSpec,
    robot: usize,
    advice: Advice,
    /// No velocity of any joint.
    rest: Vec<f64>,
    not_before_s: f64,
    /// Plans in a row that found nothing.
    failed: u64,
    step_ns: Vec<u64>,
    track: AvoidanceTrack,
    /// The first tick that could not be done, and why.
    fault: Option<(f64, String)>,
}

impl<'s> Evasive<'s> {
    /// One entry per robot of the cell; `None` where it does not evade.
    pub fn of_cell(cell: &'s Cell, scene: &'s Scene, clocks: &[Clock]) -> Result<Vec<Option<Self>>, FormatError> {
        let each = cell.avoidance.iter().enumerate();
        each.map(|(robot, spec)| spec.as_ref().map(|s| Self::new(cell, scene, robot, s, &clocks[robot])).transpose())
            .collect()
    }

    fn new(
        cell: &Cell,
        scene: &'s Scene,
        robot: usize,
        spec: &'s AvoidanceSpec,
        clock: &Clock,
    ) -> Result<Self, FormatError> {
        let refused = |e: AvoidanceError| FormatError::new(&cell.file, cell.robots[robot].line, e.to_string());
        let (q, limits) = (&clock.point().q, limits(cell, robot));
        let avoider = Avoider::new(scene, robot, q, &limits, spec.rules.clone(), spec.settings).map_err(refused)?;
        Ok(Self {
            avoider,
            spec,
            robot,
            advice: Advice { rate: 1.0, nearest_m: f64::INFINITY, ..Advice::default() },
            rest: vec![0.0; q.len()],
            not_before_s: 0.0,
            failed: 0,
            step_ns: Vec::new(),
            track: AvoidanceTrack { surfaces: surfaces(spec), ..AvoidanceTrack::default() },
            fault: None,
        })
    }

    /// Writes where the robot is and how it moves.
    pub fn look(&self, state: &mut ChainState) {
        state.q.copy_from_slice(self.avoider.q());
        state.qd.copy_from_slice(self.avoider.qd());
        state.qdd.copy_from_slice(self.avoider.qdd());
    }

    /// Joint velocities that it would have at override 1; none while it waits for what comes, whatever its program asks for.
    pub fn intent<'a>(&'a self, clock: &'a Clock) -> &'a [f64] {
        match (self.is_on_path(), self.advice.rate == 0.0) {
            (true, true) => &self.rest,
            (true, false) => clock.intent(),
            (false, _) => self.avoider.intent(),
        }
    }

    /// True where the robot is where its program has it.
    pub fn is_on_path(&self) -> bool {
        self.advice.astray_s == 0.0
    }

    /// What is told of the present tick.
    pub fn record(&mut self) {
        let a = &self.advice;
        self.track.samples.push(AvoidanceSample {
            doing: a.doing,
            nearest_m: a.nearest_m,
            size: a.reaction.size,
            astray_s: a.astray_s,
            rate: a.rate,
        });
    }

    /// Why it stood still where its tick could not be done; `None` where each could.
    pub fn trouble(&self, cell: &Cell) -> Option<Warning> {
        let (t_s, why) = self.fault.as_ref()?;
        let robot = &cell.robots[self.robot];
        Some(Warning {
            file: cell.file.clone(),
            line: Some(robot.line),
            what: format!("avoidance of '{}' failed at {t_s:.3} s, and it stood still: {why}", robot.name),
            write_instead: None,
        })
    }

    /// All that was recorded.
    pub fn finish(mut self) -> AvoidanceTrack {
        self.track.step_ns = tick_times(self.step_ns);
        self.track
    }

    /// From `t_s` to the next tick, under the override of the monitor. Returns the event that this is, where it is one.
    pub fn advance<'f>(
        &mut self,
        cell: &Cell,
        clock: &mut Clock,
        states: &[ChainState],
        t_s: f64,
        allowed: f64,
        regions: impl FnMut(f64) -> Option<RegionFence<'f>>,
    ) -> Option<&'static str> {
        let before = self.advice.doing;
        let at_border = self.at_border(clock, allowed);
        let wants_way = self.advice.wants_way || (at_border && self.avoider.stands());
        if self.spec.replan && wants_way && t_s >= self.not_before_s {
            self.plan(clock, t_s, regions);
        }
        // Not nearer to a border than a way leads off from in good time.
        let allowed = if self.at_border(clock, allowed) { 0.0 } else { allowed };
        clock.hold(!self.is_on_path());
        // What a program waits for happens at its place: away from it time does not run.
        if !(clock.waiting() && self.advice.rate == 0.0) {
            clock.advance(cell.tick_s, allowed * self.advice.rate);
        }
        self.step(cell, clock, states, t_s, allowed);
        let now = self.advice.doing;
        (now != before).then(|| event(now))
    }

    /// True where the monitor all but stops the robot off its path: it was driven up to a region. A planned way leads off; where
    /// none is found for long it is left to what draws it back.
    fn at_border(&self, clock: &Clock, allowed: f64) -> bool {
        let free = self.is_on_path() || self.avoider.has_way() || allowed >= BORDER * clock.programmed_override();
        !free && self.spec.replan && self.failed < MANY
    }

    fn step(&mut self, cell: &Cell, clock: &Clock, states: &[ChainState], t_s: f64, allowed: f64) {
        let fled = |object: usize| self.spec.objects.contains(&object);
        let moving = cell.movers.iter().map(|m| Seen {
            object: m.object,
            in_world: m.pose(t_s),
            motion: m.motion(t_s),
            known: !fled(m.object),
        });
        let stands = |o: &&usize| !cell.movers.iter().any(|m| m.object == **o);
        let standing = self.spec.objects.iter().filter(stands).map(|&object| Seen {
            object,
            in_world: cell.objects[object].in_world,
            motion: Motion::REST,
            known: false,
        });
        let objects: Vec<Seen> = moving.chain(standing).collect();
        let others = states.iter().enumerate().filter(|(i, _)| *i != self.robot);
        let known = |robot: usize| !self.spec.robots.contains(&robot);
        let robots: Vec<Neighbour<'_>> =
            others.map(|(robot, s)| Neighbour { robot, q: &s.q, qd: &s.qd, known: known(robot) }).collect();
        let path = if clock.end_of_joint_move().is_some() { PathKind::PointToPoint } else { PathKind::Continuous };
        let reference = Reference { q: &clock.point().q, qd: &clock.point().first, path };
        let around = Around { objects: &objects, robots: &robots };
        match self.avoider.tick(cell.tick_s, &reference, &around, allowed) {
            Ok(advice) => {
                self.advice = advice;
                self.step_ns.push(advice.times.total().as_nanos() as u64);
            }
            // Nothing was commanded: the robot stands where it is, wherever its path would be.
            Err(why) => {
                self.advice = Advice { rate: 0.0, doing: Doing::Halted, astray_s: f64::INFINITY, ..self.advice };
                self.fault.get_or_insert_with(|| (t_s, why.to_string()));
            }
        }
    }

    /// Another way: to the end of a joint move, else back to where the path was left.
    fn plan<'f>(&mut self, clock: &mut Clock, t_s: f64, mut regions: impl FnMut(f64) -> Option<RegionFence<'f>>) {
        let end = clock.end_of_joint_move();
        let goal = end.clone().unwrap_or_else(|| clock.point().q.clone());
        let begin = std::time::Instant::now();
        let found = CLEARANCES_M.into_iter().zip(WARNINGS).any(|(clearance_m, share)| {
            // What was not found one way may be found another.
            let seed = 1 + self.failed;
            let options = RouteOptions { time_limit: PLANNING, most_states: LOOKS, clearance_m, seed };
            let mut fence = regions(share);
            self.avoider.plan_within(&goal, &options, fence.as_mut().map(|f| f as &mut dyn Fence)).is_ok()
        });
        self.failed = if found { 0 } else { self.failed + 1 };
        // A trapped robot is not planned for all the time.
        self.not_before_s = t_s + if self.failed < MANY { AGAIN_S } else { LATER_S };
        self.track.plans.push((t_s, found.then(|| begin.elapsed().as_secs_f64())));
        if found && end.is_some() {
            clock.skip_move();
        }
    }
}

fn surfaces(spec: &AvoidanceSpec) -> Vec<Surface> {
    (0..2).filter_map(|output| Surface::of(spec.rules.controller(), output, SURFACE)).collect()
}

fn event(doing: Doing) -> &'static str {
    match doing {
        Doing::Following => "on_path",
        Doing::Evading => "evade",
        Doing::Returning => "return",
        Doing::Rounding => "go_around",
        Doing::Waiting => "wait",
        Doing::Halted => "halt",
    }
}

fn limits(cell: &Cell, robot: usize) -> Vec<JointLimit> {
    let robot = &cell.robots[robot];
    let chain = &robot.robot.chain;
    let bounds = chain.lower().into_iter().zip(chain.upper());
    let limit = |((lower, upper), l): ((f64, f64), &crate::JointLimits)| JointLimit {
        lower,
        upper,
        speed: l.velocity,
        acceleration: l.acceleration,
        stop: l.stop.max(l.acceleration),
    };
    bounds.zip(&robot.limits).map(limit).collect()
}
