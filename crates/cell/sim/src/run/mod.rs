//! Simulation of a cell: programs on one clock, under the monitor.

mod avoiding_robot;
mod carried_parts;
mod deadlock_detector;
mod fault_injection;
mod idle_detector;
mod observation;
mod observer;
mod obstacle_guard;
mod outcome;
mod override_delay;
mod path_ahead;
mod path_replanner;
mod path_search;
mod perceived_obstacles;
mod region_recorder;
mod release;
mod sensor_guards;
mod stop_state;
mod surroundings;
mod wait_for_graph;
mod zone_claims;

use std::sync::Arc;
use std::time::Instant;

use elbowroom_cell::configure::{self, MonitorSetup};
use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{Cell, CellRegionId, CellRobot, Frames, ObjectMotion, OutOfReachProofs, QueryModel};
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{
    AccessClass, EventKind, Monitor, OverrideReason, RegionId, RegionKind, Snapshot, SourceState, VirtualTcp, VolumeId,
    ZoneArbiter,
};
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_scene::{FirstContact, FirstContacts, MovedObject};
use elbowroom_spatial::Pose;

use crate::motion::{GripAction, PlannedPaths, ProgramClock, RegionSwitch, plan};
use crate::recording::{
    Collision, EventRow, GoverningPoint, HoldReason, ObjectTrack, Recording, RegionTrack, RobotEnding, RobotTrack,
    RunEnd, RunEvent, Sample, Stop, TickTimes,
};
use avoiding_robot::AvoidingRobot;
pub use avoiding_robot::evasion_limits;
use carried_parts::CarriedParts;
use deadlock_detector::DeadlockDetector;
pub use fault_injection::{InputFault, InputFaultKind};
use idle_detector::{IDLE_TIMEOUT_S, IdleDetector, STANDSTILL_TIMEOUT_S};
pub use observer::{ObservedInstant, ObservedTick, RunObserver};
use obstacle_guard::{ObstacleGuard, obstacle_guards};
use override_delay::OverrideDelay;
use perceived_obstacles::PerceivedObstacles;
use region_recorder::RegionRecorder;
use stop_state::StopState;
use wait_for_graph::WaitForGraph;
use zone_claims::ZoneClaims;

/// Options of a simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct RunOptions {
    /// False: the override of the monitor is computed but not applied (`--no-monitor`).
    pub apply_override: bool,
    /// False: robots with `[avoidance]` follow their programs (`--no-avoidance`).
    pub avoidance: bool,
    /// Number of repetitions of the programs, times their own `repeat`.
    pub repeat: u32,
    /// Fault injection: robots that become silent and stop.
    pub silent_from: Vec<SilentFrom>,
    /// Fault injection: faulty inputs of the robots' monitors. Where two faults of one robot overlap, the first one in
    /// this list applies.
    pub faults: Vec<InputFault>,
}

/// A robot that is silent and stopped from a time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SilentFrom {
    /// The robot.
    pub robot: RobotId,
    /// The time, s.
    pub t_s: f64,
}

impl RunOptions {
    fn is_silent(&self, robot: RobotId, t_s: f64) -> bool {
        self.silent_from.iter().any(|s| s.robot == robot && t_s >= s.t_s)
    }
}

impl Default for RunOptions {
    fn default() -> Self {
        Self { apply_override: true, avoidance: true, repeat: 1, silent_from: Vec::new(), faults: Vec::new() }
    }
}

/// Result of a simulation.
#[derive(Debug, Clone)]
pub struct RunOutcome {
    /// The recording.
    pub recording: Recording,
    /// Notes on the programs: speeds beyond the joint limits, and the like.
    pub notes: Vec<Warning>,
}

impl RunOutcome {
    /// True where a collision occurred, a forbidden region was entered, or robots are in a deadlock: exit status 1.
    pub fn has_violation(&self) -> bool {
        let r = &self.recording;
        r.robots.iter().any(|r| !r.collisions.is_empty())
            || r.regions.iter().any(RegionTrack::is_violated)
            || !r.deadlocks.is_empty()
    }
}

/// Progress of a simulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunProgress {
    /// Simulated time, s.
    pub t_s: f64,
    /// Number of robots with completed programs.
    pub finished: usize,
    /// Number of robots.
    pub robots: usize,
}

/// Simulates the programs of a cell.
///
/// All robot states of an instant are computed before the first monitor runs, so followed frames have no latency; the
/// override of a tick applies to the motion from this tick to the next.
///
/// # Errors
/// [`FormatError`] at the line of an infeasible step. Nothing has moved then, except where a part that another robot
/// moves cannot be gripped.
pub fn simulate(cell: &Cell, options: &RunOptions) -> Result<RunOutcome, FormatError> {
    simulate_observed(&PlannedPaths::new(cell), options, &mut |_| {}, None)
}

/// [`simulate`] with paths that may be known, a progress callback, and an observer of the monitors' ticks, such as one that records them.
///
/// # Errors
/// As for [`simulate`].
pub fn simulate_observed(
    paths: &PlannedPaths<'_>,
    options: &RunOptions,
    progress: &mut dyn FnMut(RunProgress),
    observer: Option<&mut dyn RunObserver>,
) -> Result<RunOutcome, FormatError> {
    let (cell, mut notes) = (paths.cell(), Vec::new());
    let (mut clocks, mut claims) = (Vec::new(), Vec::new());
    let setups = configure::setups(cell)?;
    let arbiter = configure::zone_arbiter(cell);
    let monitors = configure::monitors_with(cell, &setups, arbiter.as_ref())?;
    let perceived = PerceivedObstacles::of_cell(cell, &mut notes)?;
    for (i, robot) in cell.robots.iter().enumerate() {
        let plan = plan(paths, RobotId(i), options.repeat, &mut notes)?;
        // A robot with avoidance or with planned moves around obstacles leaves its program: its claims are not known.
        let avoids = options.avoidance && cell.avoidance.get(i).is_some_and(Option::is_some);
        let replans = plan.has_planned_moves() && perceived.search_s(RobotId(i)).is_some();
        let keeps_to_plan = options.apply_override && !avoids && !replans;
        let arbiter = arbiter.as_deref().filter(|_| keeps_to_plan);
        claims.push(arbiter.and_then(|arbiter| ZoneClaims::of_plan(cell, RobotId(i), &setups[i], &plan, arbiter)));
        clocks.push(ProgramClock::new(plan, robot.limits.clone()));
    }
    let scene = QueryModel::of_cell(cell).scene(OutOfReachProofs::Omit)?;
    let avoiding = if options.avoidance { AvoidingRobot::of_cell(cell, &scene, &clocks)? } else { Vec::new() };
    let models: Vec<Robot> = cell.robots.iter().map(CellRobot::with_all_tools).collect();
    let mut run = Simulation::new(cell, options, &setups, &models, monitors, clocks, avoiding);
    (run.arbiter, run.claims) = (arbiter, claims);
    if let Some(observer) = observer {
        run.observer = Some(observer);
    }
    run.guards = obstacle_guards(cell, &perceived, (&run.avoiding, &run.states), &mut notes)?;
    run.perceived = Some(perceived);
    let mut tick = 0_u64;
    loop {
        let t_s = tick_time_s(tick, cell.tick_s);
        if tick.is_multiple_of(256) {
            let finished = run.clocks.iter().filter(|c| c.finished()).count();
            progress(RunProgress { t_s, finished, robots: run.clocks.len() });
        }
        if tick == 0 {
            run.publish_initial_occupancy();
        }
        run.tick(t_s)?;
        if let Some(end) = run.end(t_s) {
            notes.extend(run.avoiding.iter().flatten().filter_map(|a| a.fault_warning(cell)));
            run.perceived.iter_mut().for_each(|p| p.take_warnings(&mut notes));
            return Ok(RunOutcome { recording: run.finish(t_s, end), notes });
        }
        run.advance();
        tick += 1;
    }
}

struct Simulation<'a> {
    cell: &'a Cell,
    options: &'a RunOptions,
    setups: &'a [MonitorSetup],
    monitors: Vec<Monitor>,
    /// Arbiter of the exchange regions.
    arbiter: Option<Arc<ZoneArbiter>>,
    /// Per robot the claims of its program; `None` for one that declares none.
    claims: Vec<Option<ZoneClaims>>,
    deadlocks: DeadlockDetector,
    /// Per robot the point with the smallest requested override in the last tick.
    governing: Vec<Option<VirtualTcp>>,
    clocks: Vec<ProgramClock>,
    /// Per robot; `None` for one without avoidance.
    avoiding: Vec<Option<AvoidingRobot<'a>>>,
    /// What sensors see; `None` until the run begins.
    perceived: Option<PerceivedObstacles<'a>>,
    /// Per robot; `None` for one that no sensor guards.
    guards: Vec<Option<ObstacleGuard<'a>>>,
    /// Per robot: the obstacle or sensor that holds it in this tick.
    holds: Vec<Option<(HoldReason, String)>>,
    states: Vec<ChainState>,
    scratch: Vec<ChainState>,
    frames: Frames<'a>,
    fault_injector: fault_injection::FaultInjector<'a>,
    regions: RegionRecorder<'a>,
    checker: FirstContacts<'a>,
    parts: CarriedParts<'a>,
    /// The robots with their tools as they are now.
    present: Vec<CellRobot>,
    /// Robots and their volumes that were released at this instant.
    released: Vec<(usize, VolumeId)>,
    /// The objects of the last tracks, which move only in a robot's hand.
    gripped: Vec<ObjectId>,
    tracks: Vec<RobotTrack>,
    objects: Vec<ObjectTrack>,
    /// Time of the last collision check, s.
    checked_s: f64,
    stop_states: Vec<StopState>,
    /// Override applied to each robot until the next tick.
    applied: Vec<f64>,
    delays: Vec<OverrideDelay>,
    events: Vec<EventRow>,
    idle_detector: IdleDetector,
    standstill_detector: IdleDetector,
    tick_ns: Vec<u64>,
    /// `None` where nobody observes the run.
    observer: Option<&'a mut dyn RunObserver>,
    /// Number of events that the observer has seen.
    observed_events: usize,
}

impl<'a> Simulation<'a> {
    fn new(
        cell: &'a Cell,
        options: &'a RunOptions,
        setups: &'a [MonitorSetup],
        models: &'a [Robot],
        monitors: Vec<Monitor>,
        clocks: Vec<ProgramClock>,
        mut avoiding: Vec<Option<AvoidingRobot<'a>>>,
    ) -> Self {
        avoiding.resize_with(cell.robots.len(), || None);
        let states: Vec<_> = cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect();
        let gripped: Vec<ObjectId> = CarriedParts::gripped_by_programs(cell).collect();
        let moved = cell.moving_objects.iter().map(|m| m.object).chain(gripped.iter().copied());
        let track = |(r, setup): (&CellRobot, &MonitorSetup)| RobotTrack {
            name: r.name.clone(),
            flange: r.robot.chain.links()[r.flange.0].clone(),
            joints: r.joint_names(),
            parts: setup.configuration.volumes().iter().map(|v| v.name.clone()).collect(),
            absent_links: absent_links(r).into_iter().map(|links| (0.0, links)).collect(),
            samples: Vec::new(),
            stops: Vec::new(),
            finished: false,
            stopped_s: 0.0,
            min_override: 1.0,
            collisions: Vec::new(),
            avoidance: None,
            perception: None,
            ending: RobotEnding::default(),
        };
        let mut checker = FirstContacts::new(
            models.iter().zip(&cell.robots).map(|(model, r)| (model, r.base_in_world)).collect(),
            &cell.objects,
        )
        .skipping(cell.all_pair_rules())
        .moving(&cell.moving_objects.iter().map(|m| m.object).collect::<Vec<_>>());
        for (robot, r) in cell.robots.iter().enumerate() {
            let absent = r.tools.iter().filter(|t| !t.mounted);
            absent.for_each(|tool| checker.set_present(RobotId(robot), tool.link, false, &[]));
        }
        Self {
            arbiter: None,
            claims: Vec::new(),
            deadlocks: DeadlockDetector::new(cell.robots.len()),
            governing: vec![None; cell.robots.len()],
            options,
            setups,
            perceived: None,
            guards: Vec::new(),
            holds: vec![None; cell.robots.len()],
            scratch: states.clone(),
            states,
            frames: Frames::new(cell),
            fault_injector: fault_injection::FaultInjector::new(&options.faults, cell.robots.len()),
            regions: RegionRecorder::new(cell, setups),
            checker,
            tracks: cell.robots.iter().zip(setups).map(track).collect(),
            objects: moved.map(|o| object_track(cell, o)).collect(),
            parts: CarriedParts::new(cell),
            present: cell.robots.clone(),
            released: Vec::new(),
            gripped,
            checked_s: 0.0,
            stop_states: vec![StopState::default(); cell.robots.len()],
            applied: vec![0.0; cell.robots.len()],
            delays: cell.robots.iter().map(|_| OverrideDelay::new(cell.laws.reaction_delay_s)).collect(),
            events: Vec::new(),
            idle_detector: IdleDetector::new(cell, IDLE_TIMEOUT_S),
            standstill_detector: IdleDetector::new(cell, STANDSTILL_TIMEOUT_S),
            tick_ns: Vec::new(),
            observer: None,
            observed_events: 0,
            monitors,
            clocks,
            avoiding,
            cell,
        }
    }

    fn is_silent(&self, robot: usize, t_s: f64) -> bool {
        self.options.is_silent(RobotId(robot), t_s)
    }

    fn event(&mut self, t_s: f64, robot: usize, region: &str, event: RunEvent) {
        let robot = self.cell.robots[robot].name.clone();
        self.events.push(EventRow { t_s, robot, region: region.to_owned(), event });
    }

    /// Publishes the occupancy of every robot before the first tick of a cell with exchange regions: a robot that
    /// starts inside would otherwise wait for robots without a status, and count as having entered.
    fn publish_initial_occupancy(&mut self) {
        if !self.cell.regions.iter().any(|r| matches!(r.region.kind, RegionKind::Exchange { .. })) {
            return;
        }
        self.update_states(0.0);
        self.declare_claims();
        for i in 0..self.clocks.len() {
            if self.is_silent(i, 0.0) {
                continue;
            }
            let sources = self.frames.sources(&self.setups[i].sources, &self.states, 0.0);
            let before = -self.cell.tick_s;
            let sources: Vec<_> = sources.into_iter().map(|s| SourceState { stamp_s: before, ..s }).collect();
            let (state, clock) = (&self.states[i], &self.clocks[i]);
            let snapshot = Snapshot {
                now_s: before,
                stamp_s: before,
                q: &state.q,
                qd: &state.qd,
                qdd: &state.qdd,
                programmed_override: clock.programmed_override(),
                intent: Some(clock.intent()),
                sources: &sources,
            };
            let report = self.monitors[i].tick(&snapshot);
            if let Some(observer) = &mut self.observer {
                let (monitor, present) = (&self.monitors[i], &self.present[i]);
                observer.ticked(&ObservedTick {
                    robot: RobotId(i),
                    snapshot: &snapshot,
                    report: &report,
                    monitor,
                    present,
                });
            }
            self.log_events(i, 0.0);
        }
    }

    /// Evaluates one instant; nothing moves.
    fn tick(&mut self, t_s: f64) -> Result<(), FormatError> {
        self.apply_switches(t_s);
        self.update_states(t_s);
        self.perceive(t_s);
        self.declare_claims();
        self.check_collisions(t_s);
        // Before the monitors' ticks: these decide how fast the robot moves with what it grips.
        self.apply_tools(t_s)?;
        self.apply_grips(t_s)?;
        for i in 0..self.clocks.len() {
            if self.is_silent(i, t_s) { self.record_silent(i, t_s) } else { self.tick_monitor(i, t_s) }
        }
        self.regions.observe(t_s, &self.monitors, &self.states, &self.frames);
        if let Some(arbiter) = &self.arbiter {
            self.deadlocks.observe(t_s, arbiter, &self.stop_states);
        }
        self.observe_instant(t_s);
        self.detach_released()
    }

    fn observe_instant(&mut self, t_s: f64) {
        let Some(observer) = &mut self.observer else { return };
        let events = &self.events[self.observed_events..];
        let arbiter = self.arbiter.as_deref();
        observer.instant(&ObservedInstant { t_s, objects: &self.objects, events, arbiter });
        self.observed_events = self.events.len();
    }

    /// What a robot releases counts up to the instant of the release.
    fn detach_released(&mut self) -> Result<(), FormatError> {
        for (robot, volume) in std::mem::take(&mut self.released) {
            let detached = self.monitors[robot].detach(volume).and_then(|()| self.regions.detach(robot, volume));
            detached.map_err(|e| FormatError::new(&self.cell.file, self.cell.robots[robot].line, e.to_string()))?;
            if let Some(observer) = &mut self.observer {
                observer.detached(RobotId(robot), volume);
            }
        }
        Ok(())
    }

    /// Makes tools active, and exchanges those that are not mounted.
    fn apply_tools(&mut self, t_s: f64) -> Result<(), FormatError> {
        for robot in 0..self.clocks.len() {
            for tool in self.clocks[robot].take_tools() {
                let before = self.present[robot].clone();
                self.present[robot] = before.with_tool(tool);
                self.exchange_volumes(robot, &before)?;
                let absent = absent_links(&self.present[robot]).map(|links| (t_s, links));
                self.tracks[robot].absent_links.extend(absent);
                let name = self.present[robot].tools[tool].name.clone();
                self.event(t_s, robot, &name, RunEvent::Tool);
            }
        }
        Ok(())
    }

    /// Attaches and detaches the tools that were exchanged, in collisions and in regions.
    fn exchange_volumes(&mut self, robot: usize, before: &CellRobot) -> Result<(), FormatError> {
        let (setup, line) = (&self.setups[robot], self.present[robot].line);
        let tools = self.present[robot].tools.iter().zip(&before.tools);
        let changed = tools.filter(|(now, old)| now.mounted != old.mounted).map(|(now, _)| (now.link, now.mounted));
        for (link, is_mounted) in changed.collect::<Vec<_>>() {
            self.checker.set_present(RobotId(robot), link, is_mounted, &self.states.iter().collect::<Vec<_>>());
            for (volume, tool) in setup.tool_volumes(link) {
                self.carry(robot, volume, is_mounted.then_some(&tool.in_link), line)?;
            }
        }
        Ok(())
    }

    /// Guards what a robot carries from now on, a part or a tool, at its pose in the link; or notes that it is to be detached.
    fn carry(
        &mut self,
        robot: usize,
        volume: VolumeId,
        in_link: Option<&Pose>,
        line: usize,
    ) -> Result<(), FormatError> {
        self.released.retain(|released| *released != (robot, volume));
        let Some(in_link) = in_link else {
            self.released.push((robot, volume));
            return Ok(());
        };
        let attached = self.monitors[robot].attach(volume, in_link);
        let attached = attached.and_then(|()| self.regions.attach(robot, volume, in_link));
        attached.map_err(|e| FormatError::new(&self.cell.file, line, e.to_string()))?;
        if let Some(observer) = &mut self.observer {
            observer.attached(RobotId(robot), volume, in_link);
        }
        Ok(())
    }

    /// In the order of each program. A robot that grips what another one holds waits for the other's steps of this
    /// instant, so that it can take a part over.
    fn apply_grips(&mut self, t_s: f64) -> Result<(), FormatError> {
        let mut late = Vec::new();
        for robot in 0..self.clocks.len() {
            let mut actions = self.clocks[robot].take_grips().into_iter();
            while let Some(action) = actions.next() {
                let holder = self.parts.carrier(action.object);
                if action.grips && holder.is_some_and(|r| r.0 != robot) {
                    late.extend(std::iter::once(action).chain(actions).map(|a| (robot, a)));
                    break;
                }
                self.apply_grip(robot, &action, t_s)?;
            }
        }
        late.into_iter().try_for_each(|(robot, action)| self.apply_grip(robot, &action, t_s))
    }

    fn apply_grip(&mut self, robot: usize, action: &GripAction, t_s: f64) -> Result<(), FormatError> {
        let states: Vec<&ChainState> = self.states.iter().collect();
        self.parts.apply(RobotId(robot), action, t_s, &self.present[robot], &mut self.checker, &states)?;
        let (cell, event) = (self.cell, if action.grips { RunEvent::Grip } else { RunEvent::Release });
        self.event(t_s, robot, &cell.objects[action.object.0].name, event);
        self.guard(robot, action)
    }

    /// Guards what a robot grips or no longer has, in the avoidance of all robots, too.
    fn guard(&mut self, robot: usize, action: &GripAction) -> Result<(), FormatError> {
        let attachment = self.checker.attachment(action.object).cloned();
        let in_link = attachment.as_ref().map_or(Pose::IDENTITY, |a| a.in_link);
        for avoiding in self.avoiding.iter_mut().flatten() {
            let applied = match &attachment {
                Some(attachment) => avoiding.attach(action.object, attachment.clone()),
                None => avoiding.detach(action.object),
            };
            applied.map_err(|e| FormatError::new(&self.cell.file, action.line, e.to_string()))?;
        }
        let slot = self.setups[robot].gripped_volume(action.object, action.link, &in_link);
        let none = || FormatError::new(&self.cell.file, action.line, "grips what its monitor has no volume for");
        let (volume, in_link) = slot.ok_or_else(none)?;
        self.carry(robot, volume, action.grips.then_some(&in_link), action.line)
    }

    fn declare_claims(&mut self) {
        let Some(arbiter) = &self.arbiter else { return };
        for (claims, clock) in self.claims.iter_mut().zip(&self.clocks) {
            if let Some(claims) = claims {
                claims.declare(clock, arbiter);
            }
        }
    }

    fn update_states(&mut self, t_s: f64) {
        for (i, clock) in self.clocks.iter().enumerate() {
            let state = &mut self.states[i];
            state.q.copy_from_slice(&clock.point().q);
            // A silent robot is assumed to be stationary.
            let is_silent = self.options.is_silent(RobotId(i), t_s);
            let scale = if is_silent { 0.0 } else { 1.0 };
            state.qd.iter_mut().zip(clock.velocity()).for_each(|(to, v)| *to = v * scale);
            state.qdd.iter_mut().zip(clock.acceleration()).for_each(|(to, v)| *to = v * scale);
            if let Some(avoiding) = self.avoiding[i].as_ref().filter(|a| !a.is_on_path()) {
                avoiding.write_state(state);
                state.qd.iter_mut().chain(&mut state.qdd).for_each(|v| *v *= scale);
            }
            self.cell.robots[i].robot.chain.forward_motion(state);
        }
    }

    fn apply_switches(&mut self, t_s: f64) {
        for robot in 0..self.clocks.len() {
            for RegionSwitch { region, active } in self.clocks[robot].take_switches() {
                if !self.regions.switch(region, t_s, active) {
                    continue;
                }
                let cell = self.cell;
                self.event(
                    t_s,
                    robot,
                    &cell.regions[region.0].region.name,
                    if active { RunEvent::On } else { RunEvent::Off },
                );
                for (i, (setup, monitor)) in self.setups.iter().zip(&mut self.monitors).enumerate() {
                    let Some(local) = setup.regions.iter().position(|r| *r == region) else { continue };
                    // The cell file refuses switching of permanent regions, so this cannot fail.
                    let switched = monitor.switch(RegionId(local), active, AccessClass::Programmer);
                    if let (Ok(()), Some(observer)) = (switched, &mut self.observer) {
                        observer.switched(RobotId(i), RegionId(local), active);
                    }
                }
            }
        }
    }

    fn tick_monitor(&mut self, i: usize, t_s: f64) {
        let sources = self.frames.sources(&self.setups[i].sources, &self.states, t_s);
        let clock = &self.clocks[i];
        let state = &self.states[i];
        let held_by = self.holds[i].as_ref().map(|(_, by)| by.clone());
        // A robot that is held is not commanded to move: its constant joint values are no frozen reading.
        let programmed_override = if held_by.is_some() { 0.0 } else { clock.programmed_override() };
        let snapshot = Snapshot {
            now_s: t_s,
            stamp_s: t_s,
            q: &state.q,
            qd: &state.qd,
            qdd: &state.qdd,
            programmed_override,
            intent: Some(self.avoiding[i].as_ref().map_or(clock.intent(), |a| a.intent(clock))),
            sources: &sources,
        };
        let Some(snapshot) = self.fault_injector.apply(RobotId(i), &snapshot) else {
            return self.record_without_input(i, t_s);
        };
        let begin = Instant::now();
        let report = self.monitors[i].tick(&snapshot);
        self.tick_ns.push(begin.elapsed().as_nanos() as u64);
        if let Some(observer) = &mut self.observer {
            let (monitor, present) = (&self.monitors[i], &self.present[i]);
            observer.ticked(&ObservedTick {
                robot: RobotId(i),
                snapshot: &snapshot,
                report: &report,
                monitor,
                present,
            });
        }
        let applied = if self.options.apply_override { report.speed_override } else { programmed_override };
        let applied = applied.min(programmed_override);
        self.applied[i] = applied;
        self.log_events(i, t_s);
        // A region governs where it makes the robot slower than programmed.
        let is_governed = self.options.apply_override && held_by.is_none();
        let governs = is_governed.then(|| report.reason.region()).flatten();
        let region = governs.map(|r| self.setups[i].regions[r.0]);
        self.governing[i] = report.governing;
        let governing = region.and(report.governing);
        // The monitor counts its own regions, a recording those of the cell.
        let in_cell = |r: RegionId| RegionId(self.setups[i].regions[r.0].0);
        let reason = if is_governed { report.reason.with_region(in_cell) } else { OverrideReason::Free };
        self.record(i, t_s, applied, region, governing, reason);
        if let Some(event) = self.stop_states[i].update(&self.clocks[i], applied) {
            let region = region.map_or("", |r| self.cell.regions[r.0].region.name.as_str());
            let by = held_by.as_deref().unwrap_or(region);
            self.event(t_s, i, by, event);
            self.record_stop(i, t_s, by, governing, event == RunEvent::Stop);
        }
        if self.stop_states[i].stopped {
            self.tracks[i].stopped_s += self.cell.tick_s;
        }
    }

    /// Begins a stop at the region with this name (empty: at none), or ends the one that goes on.
    fn record_stop(&mut self, i: usize, t_s: f64, region: &str, governing: Option<VirtualTcp>, begins: bool) {
        let stops = &mut self.tracks[i].stops;
        if !begins {
            stops.last_mut().into_iter().for_each(|stop| stop.to_s = t_s);
            return;
        }
        stops.push(Stop {
            from_s: t_s,
            to_s: f64::INFINITY,
            by: (!region.is_empty()).then(|| region.to_owned()),
            part: governing.and_then(|g| outcome::part_name(&self.setups[i].configuration, g.volume)),
            point: governing.map(|g| g.position),
            distance_m: governing.map(|g| g.distance_m),
        });
    }

    fn log_events(&mut self, i: usize, t_s: f64) {
        let robot = &self.cell.robots[i].name;
        for e in self.monitors[i].events() {
            // Switching is reported once, by the switch itself.
            if matches!(e.kind, EventKind::On | EventKind::Off) {
                continue;
            }
            let region = e.region.map(|r| self.cell.regions[self.setups[i].regions[r.0].0].region.name.clone());
            let region = region.unwrap_or_default();
            self.events.push(EventRow { t_s, robot: robot.clone(), region, event: RunEvent::Monitor(e.kind) });
        }
    }

    fn record_silent(&mut self, i: usize, t_s: f64) {
        self.applied[i] = 0.0;
        self.record(i, t_s, 0.0, None, None, OverrideReason::Fault(elbowroom_monitor::Fault::Stale));
    }

    /// Records a tick without input of the monitor.
    fn record_without_input(&mut self, i: usize, t_s: f64) {
        if self.options.apply_override && !self.fault_injector.keeps_last_override(RobotId(i), t_s) {
            self.applied[i] = 0.0;
        }
        self.record(i, t_s, self.applied[i], None, None, OverrideReason::Fault(elbowroom_monitor::Fault::Stale));
    }

    fn record(
        &mut self,
        i: usize,
        t_s: f64,
        speed_override: f64,
        region: Option<CellRegionId>,
        governing: Option<VirtualTcp>,
        reason: OverrideReason,
    ) {
        let (tcp, tcp_speed) = self.present[i].tcp(&self.states[i]);
        // Off its path a robot does not move by its program's time.
        let off_path = self.avoiding[i].as_ref().is_some_and(|a| !a.is_on_path());
        let rate = if off_path { 1.0 } else { self.clocks[i].rate() };
        if let Some(avoiding) = &mut self.avoiding[i] {
            avoiding.record();
        }
        let programmed_speed = if rate > 1e-3 {
            tcp_speed / rate
        } else {
            let scratch = &mut self.scratch[i];
            scratch.q.copy_from_slice(&self.states[i].q);
            scratch.qd.copy_from_slice(&self.clocks[i].point().dq);
            self.cell.robots[i].robot.chain.forward_motion(scratch);
            self.present[i].tcp(&self.scratch[i]).1
        };
        let track = &mut self.tracks[i];
        track.min_override = track.min_override.min(speed_override);
        let q = self.states[i].q.clone();
        track.samples.push(Sample {
            t_s,
            q,
            tcp,
            tcp_speed,
            programmed_speed,
            speed_override,
            region,
            distance_m: governing.map(|g| g.distance_m),
            governing: governing.map(|g| GoverningPoint { part: g.volume.0, point: g.position }),
            reason,
        });
    }

    fn check_collisions(&mut self, t_s: f64) {
        let Self { checker, parts, clocks, states, tracks, cell, checked_s, .. } = self;
        let states: Vec<&ChainState> = states.iter().collect();
        let before = std::mem::replace(checked_s, t_s);
        let motions: Vec<(ObjectId, ObjectMotion<'_>)> = cell
            .moving_objects
            .iter()
            .filter(|m| !parts.is_taken(m.object))
            .map(|m| (m.object, m.motion_between(before, t_s)))
            .collect();
        let moved: Vec<MovedObject<'_>> = motions
            .iter()
            .map(|(object, motion)| MovedObject { object: *object, path: motion, jumps: motion.jumps() })
            .collect();
        let set_down: Vec<ObjectId> = clocks.iter().flat_map(ProgramClock::objects_set_down).collect();
        for object in (0..cell.objects.len()).map(ObjectId) {
            checker.set_down(object, set_down.contains(&object));
        }
        let name = |m: GeometryId| match m {
            GeometryId::Object(o) => parts.name(o),
            GeometryId::Link { robot, link } => {
                let r = &cell.robots[robot.0];
                format!("{}/{}", r.name, r.robot.chain.links()[link.0])
            }
        };
        checker.check(&states, &moved, |FirstContact { a, b, fraction }| {
            // A contact at the end of the step has exactly the time of the tick.
            let t_s = if fraction < 1.0 { before + fraction * (t_s - before) } else { t_s };
            let collision = Collision { t_s, a: name(a), b: name(b) };
            let robot = |m: GeometryId| match m {
                GeometryId::Link { robot, .. } => Some(robot.0),
                GeometryId::Object(o) => parts.carrier(o).map(|r| r.0),
            };
            // A collision of two robots is listed for both.
            let mut concerned: Vec<usize> = [robot(a), robot(b)].into_iter().flatten().collect();
            concerned.dedup();
            for robot in concerned {
                tracks[robot].collisions.push(collision.clone());
            }
        });
        self.record_objects(t_s);
    }

    fn record_objects(&mut self, t_s: f64) {
        let Self { checker, parts, objects, gripped, cell, .. } = self;
        let moving = cell
            .moving_objects
            .iter()
            .map(|m| if parts.is_taken(m.object) { checker.object_in_world(m.object) } else { m.pose(t_s) });
        let poses = moving.chain(gripped.iter().map(|o| checker.object_in_world(*o)));
        objects.iter_mut().zip(poses).for_each(|(track, pose)| track.poses.push(pose));
    }

    /// Why the run ends now; `None` where it goes on.
    fn end(&mut self, t_s: f64) -> Option<RunEnd> {
        let present: Vec<usize> = (0..self.clocks.len()).filter(|i| !self.is_silent(*i, t_s)).collect();
        if present.iter().all(|i| self.finished(*i)) {
            return Some(RunEnd::Finished);
        }
        if t_s >= self.cell.max_s {
            return Some(RunEnd::TimeLimit);
        }
        let on_path = |i: usize| self.avoiding[i].as_ref().is_none_or(AvoidingRobot::is_on_path);
        let waiting = present.iter().any(|i| self.clocks[*i].waiting() && on_path(*i));
        // A robot that is held may go on after the next picture, or when its search ends.
        let waiting = waiting || self.expects_news();
        let in_motion = self.frames.is_any_moving(t_s);
        let can_continue = waiting
            || self.frames.is_any_moving_but_endless_belts(t_s)
            || !present.iter().all(|i| self.finished(*i) || on_path(*i) && self.is_held_for_good(*i, t_s));
        if self.idle_detector.is_idle(t_s, &self.states, waiting || in_motion) {
            return Some(RunEnd::Rest);
        }
        self.standstill_detector.is_idle(t_s, &self.states, can_continue).then_some(RunEnd::Standstill)
    }

    /// True where the monitor has stopped a robot, and not at a region that moves on by itself.
    fn is_held_for_good(&self, robot: usize, t_s: f64) -> bool {
        let region = self.tracks[robot].samples.last().and_then(|s| s.region);
        let follow = region.and_then(|r| self.cell.regions[r.0].follow);
        self.stop_states[robot].stopped && !follow.is_some_and(|f| self.frames.travels(&f, t_s))
    }

    fn finished(&self, robot: usize) -> bool {
        self.clocks[robot].finished() && self.avoiding[robot].as_ref().is_none_or(AvoidingRobot::is_on_path)
    }

    fn advance(&mut self) {
        let dt = self.cell.tick_s;
        let t_s = self.tracks.first().and_then(|t| t.samples.last()).map_or(0.0, |s| s.t_s);
        for i in 0..self.clocks.len() {
            if self.is_silent(i, t_s) {
                continue;
            }
            let Self { cell, clocks, avoiding, states, applied, delays, monitors, frames, setups, .. } = self;
            let Some(avoiding) = &mut avoiding[i] else {
                delays[i].send(t_s, applied[i]);
                delays[i].advance(&mut clocks[i], t_s, dt);
                continue;
            };
            let regions = |share: f64| {
                let sources = frames.sources(&setups[i].sources, states, t_s);
                RegionConstraint::new(&monitors[i], &sources, share, 0.0)
            };
            if let Some(event) = avoiding.advance(cell, &mut clocks[i], states, t_s, applied[i], regions) {
                self.event(t_s, i, "", event);
            }
        }
    }

    fn finish(mut self, t_s: f64, end: RunEnd) -> Recording {
        let mut robots = std::mem::take(&mut self.tracks);
        let finished: Vec<bool> = (0..robots.len()).map(|i| self.finished(i)).collect();
        for (track, is_over) in robots.iter_mut().zip(&finished) {
            track.finished = *is_over;
            track.stops.iter_mut().for_each(|stop| stop.to_s = stop.to_s.min(t_s));
        }
        let mut deadlocks = self.arbiter.as_ref().map_or_else(Vec::new, |arbiter| {
            self.deadlocks.finish(t_s, arbiter, self.cell, self.setups, &self.monitors)
        });
        let arbiter = self.arbiter.as_deref();
        let waits = WaitForGraph::new(self.cell, self.setups, arbiter, &self.stop_states, &robots);
        deadlocks.extend(waits.cycles(&deadlocks));
        for (track, avoiding) in robots.iter_mut().zip(self.avoiding) {
            track.avoidance = avoiding.map(AvoidingRobot::finish);
        }
        for (i, track) in robots.iter_mut().enumerate() {
            // Collisions within one tick are found in the order of the pairs.
            track.collisions.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
            let region =
                track.samples.last().and_then(|s| s.region).map(|r| self.cell.regions[r.0].region.name.as_str());
            let deadlocked = deadlocks.iter().any(|d| d.robots.contains(&track.name));
            track.perception = self.guards.get_mut(i).and_then(Option::take).map(|g| g.finish(t_s));
            let governing = self.governing[i].as_ref();
            track.ending = outcome::ending(track, deadlocked, region, governing, &self.setups[i].configuration);
            track.ending.release = release::release(self.cell, &self.setups[i], arbiter, i, track, &finished);
        }
        Recording {
            cell: self.cell.name.clone(),
            checksum: self.cell.checksum.clone(),
            tick_s: self.cell.tick_s,
            duration_s: t_s,
            end,
            monitored: self.options.apply_override,
            robots,
            regions: self.regions.finish(t_s),
            objects: self.objects,
            sensors: self.perceived.map(PerceivedObstacles::finish).unwrap_or_default(),
            deadlocks,
            events: self.events,
            tick_ns: TickTimes::of(self.tick_ns),
        }
    }
}

/// The links of the tools that are not mounted; `None` where no tool is changed.
fn absent_links(robot: &CellRobot) -> Option<Vec<LinkId>> {
    let absent: Vec<LinkId> = robot.tools.iter().filter(|t| !t.mounted).map(|t| t.link).collect();
    (!absent.is_empty()).then_some(absent)
}

fn object_track(cell: &Cell, object: ObjectId) -> ObjectTrack {
    ObjectTrack { name: cell.objects[object.0].name.clone(), poses: Vec::new() }
}

/// Time of a tick, s, rounded to nanoseconds.
fn tick_time_s(tick: u64, tick_s: f64) -> f64 {
    (tick as f64 * tick_s * 1e9).round() / 1e9
}
