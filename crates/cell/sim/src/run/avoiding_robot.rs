//! A robot with `[avoidance]` in a run, which follows its path as far as dynamic obstacles permit.

use elbowroom_avoidance::{
    AvoidanceError, Avoider, AvoiderOutput, AvoiderState, DynamicObstacles, EscapeState, Neighbour, ObservedObject,
    PathKind, PlannedDetour, Reference,
};
use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{AvoidanceSpec, Cell};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::surface_ik::{PointChain, SurfaceIkOptions};
use elbowroom_kinematics::{Chain, ChainState, JointLimits};
use elbowroom_planner::{PathConstraint, RrtConnectSettings};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Scene};
use elbowroom_spatial::FrameMotion;

use super::observation::ObservationModel;
use crate::motion::ProgramClock;
use crate::recording::{AvoidanceSample, AvoidanceTrack, Evasion, ReplanRecord, RunEvent, TickTimes};

/// Settings of the replanning of a robot that is off its path or blocked.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ReplanSettings {
    /// Largest number of validated states per attempt, which bounds the planning time independently of the machine.
    max_states: u64,
    /// Wall-clock limit per attempt; never reached in practice.
    time_limit: std::time::Duration,
    /// Attempts, in order.
    attempts: [ReplanAttempt; 3],
    /// Time between plans, s.
    interval_s: f64,
    /// Number of failed plans in a row after which `failed_interval_s` applies.
    max_failures: u64,
    /// Time between plans after `max_failures` failed plans in a row, s.
    failed_interval_s: f64,
    /// Fraction of the programmed override below which a robot off its path counts as at the border of a region.
    ///
    /// Any closer, the robot would take too long to leave.
    border_override: f64,
    /// Fraction of each warning zone that an escape keeps from a region.
    escape_warning_share: f64,
}

/// One attempt of replanning.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ReplanAttempt {
    /// Security margin to obstacles, m.
    clearance_m: f64,
    /// Fraction of each warning zone that the path keeps from a region, which is the fraction of the override that
    /// remains.
    warning_share: f64,
}

const REPLANNING: ReplanSettings = ReplanSettings {
    max_states: 40_000,
    time_limit: std::time::Duration::from_mins(1),
    attempts: [
        ReplanAttempt { clearance_m: 0.06, warning_share: 0.25 },
        ReplanAttempt { clearance_m: 0.02, warning_share: 0.1 },
        ReplanAttempt { clearance_m: 0.0, warning_share: 0.0 },
    ],
    interval_s: 0.5,
    max_failures: 8,
    failed_interval_s: 4.0,
    border_override: 1e-3,
    escape_warning_share: 0.1,
};
/// Samples per input of the recorded control surfaces.
const SURFACE_SAMPLES: usize = 33;

/// A plan, which becomes known only after its computing time.
#[derive(Debug)]
struct PendingPlan {
    ready_s: f64,
    detour: Option<PlannedDetour>,
    goal: Vec<f64>,
}

/// A robot with avoidance.
#[derive(Debug)]
pub(super) struct AvoidingRobot<'s> {
    avoider: Avoider<'s>,
    spec: &'s AvoidanceSpec,
    robot: RobotId,
    output: AvoiderOutput,
    /// Zero velocity of every joint.
    rest: Vec<f64>,
    not_before_s: f64,
    /// A plan that is being computed.
    pending: Option<PendingPlan>,
    /// Failed plans in a row.
    failed: u64,
    /// Objects that a robot has gripped, which no longer move by themselves.
    taken: Vec<ObjectId>,
    step_ns: Vec<u64>,
    track: AvoidanceTrack,
    /// Time (s) and cause of the first tick that failed.
    fault: Option<(f64, String)>,
}

impl<'s> AvoidingRobot<'s> {
    /// The avoidance of a robot; `None` for one without.
    pub fn of_robot(
        cell: &'s Cell,
        scene: &'s Scene,
        robot: RobotId,
        clock: &ProgramClock,
    ) -> Result<Option<Self>, Diagnostic> {
        let spec = cell.robots[robot.0].avoidance.as_ref();
        spec.map(|spec| Self::new(cell, scene, robot, spec, clock)).transpose()
    }

    fn new(
        cell: &Cell,
        scene: &'s Scene,
        robot: RobotId,
        spec: &'s AvoidanceSpec,
        clock: &ProgramClock,
    ) -> Result<Self, Diagnostic> {
        let refused = |e: AvoidanceError| Diagnostic::new(&cell.file, cell.robots[robot.0].line, e);
        let (q, limits) = (&clock.point().q, evasion_limits(cell, robot));
        let avoider = Avoider::new(scene, robot, q, &limits, spec.rules.clone(), spec.settings).map_err(refused)?;
        Ok(Self {
            avoider,
            spec,
            robot,
            output: AvoiderOutput { rate: 1.0, nearest_m: f64::INFINITY, ..AvoiderOutput::default() },
            rest: vec![0.0; q.len()],
            not_before_s: 0.0,
            pending: None,
            failed: 0,
            taken: Vec::new(),
            step_ns: Vec::new(),
            track: AvoidanceTrack {
                surfaces: spec.rules.surfaces(SURFACE_SAMPLES),
                obstacles: obstacles(cell),
                ..AvoidanceTrack::default()
            },
            fault: None,
        })
    }

    /// Writes the robot's joint values, velocities and accelerations.
    pub fn write_state(&self, state: &mut ChainState) {
        state.q.copy_from_slice(self.avoider.q());
        state.qd.copy_from_slice(self.avoider.qd());
        state.qdd.copy_from_slice(self.avoider.qdd());
    }

    /// Joint velocities at override 1; zero while it is stopped by an obstacle.
    pub fn intent<'a>(&'a self, clock: &'a ProgramClock) -> &'a [f64] {
        match (self.is_on_path(), self.output.rate == 0.0) {
            (true, true) => &self.rest,
            (true, false) => clock.intent(),
            (false, _) => self.avoider.intent(),
        }
    }

    /// True if the robot is on its programmed path.
    pub fn is_on_path(&self) -> bool {
        self.output.path_deviation_s == 0.0
    }

    /// Attaches an object that a robot, this one or another, has gripped.
    pub fn attach(&mut self, object: ObjectId, attachment: Attachment) -> Result<(), AvoidanceError> {
        self.taken.push(object);
        self.avoider.attach(object, attachment)
    }

    /// Detaches an object that a robot has released.
    pub fn detach(&mut self, object: ObjectId) -> Result<(), AvoidanceError> {
        self.avoider.detach(object)
    }

    /// Records the current tick.
    pub fn record(&mut self) {
        let a = &self.output;
        self.track.samples.push(AvoidanceSample {
            state: a.state,
            nearest_m: a.nearest_m,
            size: a.reaction.size,
            path_deviation_s: a.path_deviation_s,
            rate: a.rate,
            governed_by: a.governed_by,
            escape: a.escape,
        });
    }

    /// Warning if a tick failed and the robot was stopped; `None` if all ticks succeeded.
    pub fn fault_warning(&self, cell: &Cell) -> Option<Diagnostic> {
        let (t_s, why) = self.fault.as_ref()?;
        let robot = &cell.robots[self.robot.0];
        let what = format!("avoidance of '{}' failed at {t_s:.3} s, and it was stopped: {why}", robot.name);
        Some(Diagnostic::new(&cell.file, robot.line, what))
    }

    /// The recording.
    pub fn finish(mut self) -> AvoidanceTrack {
        self.track.step_ns = TickTimes::of(self.step_ns);
        self.track
    }

    /// Advances from `t_s` to the next tick under the override of the monitor. Returns an event if the state changed.
    pub fn advance<'f>(
        &mut self,
        cell: &Cell,
        clock: &mut ProgramClock,
        states: &[ChainState],
        t_s: f64,
        allowed: f64,
        mut regions: impl FnMut(f64) -> Option<RegionConstraint<'f>>,
    ) -> Option<RunEvent> {
        let before = self.output.state;
        let at_border = self.at_border(clock, allowed);
        let needs_path = self.output.requests_detour || (at_border && self.avoider.is_stationary());
        if self.pending.is_none() && self.spec.replan && needs_path && t_s >= self.not_before_s {
            self.plan(clock, t_s, &mut regions);
        }
        if let Some(plan) = self.pending.take_if(|plan| t_s >= plan.ready_s) {
            self.use_plan(clock, plan);
        }
        if self.pending.is_some() {
            self.avoider.await_detour();
        }
        // The robot stops before it is so close to a border that a planned path cannot leave in time.
        let allowed = if self.at_border(clock, allowed) { 0.0 } else { allowed };
        clock.hold(!self.is_on_path());
        // The time of a wait stops while the robot is off its path.
        if !(clock.waiting() && self.output.rate == 0.0) {
            clock.advance(cell.timing.tick_s, allowed * self.output.rate);
        }
        // Only a robot that may leave its path needs the regions.
        let is_near = self.output.nearest_m.is_finite() || self.output.escape != EscapeState::Free;
        let may_leave = allowed > 0.0 && (is_near || !self.is_on_path());
        let mut constraint = may_leave.then(|| regions(REPLANNING.escape_warning_share)).flatten();
        let constraint = constraint.as_mut().map(|c| c as &mut dyn PathConstraint);
        self.step(cell, clock, states, t_s, allowed, constraint);
        let now = self.output.state;
        if now == before {
            return None;
        }
        if now == AvoiderState::Evading {
            let evasion = self.evasion(&cell.robots[self.robot.0].robot.chain, t_s);
            self.track.evasions.extend(evasion);
        }
        Some(RunEvent::Avoidance(now))
    }

    /// The obstacle that governs the correction of this tick.
    pub fn obstacle(&self) -> Option<&str> {
        self.track.obstacles.get(self.output.governed_by?).map(String::as_str)
    }

    /// The evasion that begins: its collision point, and the joints that move it.
    fn evasion(&self, chain: &Chain, t_s: f64) -> Option<Evasion> {
        let (link, in_link, distance_m) = self.avoider.collision_point(&self.output.reaction)?;
        let to_point = PointChain::new(chain, link, in_link, None, SurfaceIkOptions::default()).ok()?;
        Some(Evasion {
            t_s,
            obstacle: self.obstacle().map(str::to_owned),
            link: chain.links()[link.0].clone(),
            in_link_m: in_link.to_array(),
            distance_m,
            moved_by: to_point.joints().iter().map(|joint| chain.joints()[joint.0].name.clone()).collect(),
        })
    }

    /// True if the monitor almost stops the robot off its path: evasion has moved it to the border of a region.
    ///
    /// A planned path leads away. After repeated failures to find one, the avoider returns the robot to its path.
    fn at_border(&self, clock: &ProgramClock, allowed: f64) -> bool {
        let free = self.is_on_path()
            || self.avoider.has_detour()
            || allowed >= REPLANNING.border_override * clock.programmed_override();
        !free && self.spec.replan && self.failed < REPLANNING.max_failures
    }

    fn step(
        &mut self,
        cell: &Cell,
        clock: &ProgramClock,
        states: &[ChainState],
        t_s: f64,
        allowed: f64,
        constraint: Option<&mut dyn PathConstraint>,
    ) {
        let evaded = |object: ObjectId| self.spec.objects.contains(&object);
        let AvoidanceSpec { noise_m, delay_s, .. } = *self.spec;
        let exact = ObservationModel { noise_m: 0.0, delay_s: 0.0 };
        // Known motions are exact; other motions are observed with noise and delay.
        let model = |known: bool| if known { exact } else { ObservationModel { noise_m, delay_s } };
        let is_taken = |object: &ObjectId| self.taken.contains(object);
        let moving = cell.moving_objects.iter().filter(|m| !is_taken(&m.object)).map(|m| {
            let known = !evaded(m.object);
            model(known).observe(m, t_s, known)
        });
        let is_fixed = |o: &&ObjectId| !cell.moving_objects.iter().any(|m| m.object == **o);
        let fixed = self.spec.objects.iter().filter(is_fixed).filter(|o| !is_taken(o)).map(|&object| ObservedObject {
            object,
            in_world: cell.objects[object.0].in_world,
            motion: FrameMotion::REST,
            known: false,
        });
        let objects: Vec<ObservedObject> = moving.chain(fixed).collect();
        let all = states.iter().enumerate().map(|(i, s)| (RobotId(i), s));
        let others = all.filter(|(robot, _)| *robot != self.robot);
        let known = |robot: RobotId| !self.spec.robots.contains(&robot);
        let robots: Vec<Neighbour<'_>> =
            others.map(|(robot, s)| Neighbour { robot, q: &s.q, qd: &s.qd, known: known(robot) }).collect();
        let path = if clock.end_of_joint_move().is_some() { PathKind::PointToPoint } else { PathKind::Continuous };
        let (here, speed_share) = (clock.point(), clock.speed_share());
        let reference = Reference { q: &here.q, qd: &here.dq, speed_share, path };
        let obstacles = DynamicObstacles { objects: &objects, robots: &robots };
        match self.avoider.tick_constrained(cell.timing.tick_s, &reference, &obstacles, allowed, constraint) {
            Ok(output) => {
                self.output = output;
                self.step_ns.push(output.times.total().as_nanos() as u64);
            }
            // The tick commanded nothing: the robot is stopped off its path.
            Err(why) => {
                self.output = AvoiderOutput {
                    rate: 0.0,
                    state: AvoiderState::Halted,
                    path_deviation_s: f64::INFINITY,
                    ..self.output
                };
                self.fault.get_or_insert_with(|| (t_s, why.to_string()));
            }
        }
    }

    /// Replans. The path is proven against what is seen now, and followed after the planning time.
    fn plan<'f>(
        &mut self,
        clock: &mut ProgramClock,
        t_s: f64,
        regions: &mut impl FnMut(f64) -> Option<RegionConstraint<'f>>,
    ) {
        let goal = goal(clock);
        let begin = std::time::Instant::now();
        let settings = REPLANNING;
        let detour = settings.attempts.into_iter().find_map(|ReplanAttempt { clearance_m, warning_share }| {
            // Another seed may find a path after the last one failed.
            let seed = 1 + self.failed;
            let options = RrtConnectSettings {
                time_limit: settings.time_limit,
                max_states: settings.max_states,
                clearance_m,
                seed,
                ..RrtConnectSettings::default()
            };
            let mut constraint = regions(warning_share);
            self.avoider.plan_detour(&goal, &options, constraint.as_mut().map(|f| f as &mut dyn PathConstraint)).ok()
        });
        let found = detour.is_some();
        self.failed = if found { 0 } else { self.failed + 1 };
        // A trapped robot does not plan in every tick.
        let interval_s =
            if self.failed < settings.max_failures { settings.interval_s } else { settings.failed_interval_s };
        self.not_before_s = t_s + interval_s;
        let search_s = found.then(|| begin.elapsed().as_secs_f64());
        self.track.plans.push(ReplanRecord { t_s, search_s });
        self.pending = Some(PendingPlan { ready_s: t_s + self.spec.plan_s, detour, goal });
    }

    /// Follows a plan that has become known, if the robot and its goal have not moved since.
    fn use_plan(&mut self, clock: &mut ProgramClock, plan: PendingPlan) {
        let Some(detour) = plan.detour.filter(|_| goal(clock) == plan.goal) else { return };
        if self.avoider.follow_detour(detour).is_ok() && clock.end_of_joint_move().is_some() {
            clock.skip_move();
        }
    }
}

/// Goal of a plan: the end of a joint move, otherwise the present point of the path.
fn goal(clock: &ProgramClock) -> Vec<f64> {
    clock.end_of_joint_move().unwrap_or_else(|| clock.point().q.clone())
}

/// Names in the order of the keys in [`AvoiderOutput::governed_by`]: objects, then the links of all robots.
fn obstacles(cell: &Cell) -> Vec<String> {
    let objects = cell.objects.iter().map(|o| o.name.clone());
    let links = cell.robots.iter().flat_map(|r| r.robot.chain.links().iter().map(|link| format!("{}/{link}", r.name)));
    objects.chain(links).collect()
}

/// Joint limits for evasion.
pub fn evasion_limits(cell: &Cell, robot: RobotId) -> Vec<JointLimits> {
    // Avoidance never brakes less than it accelerates.
    cell.robots[robot.0].limits.iter().map(|l| l.stopping_at(l.stop.max(l.acceleration))).collect()
}
