//! The state of a run, and its tick.

use std::sync::Arc;

use elbowroom_avoidance::AvoiderState;
use elbowroom_cell::region_constraint::RegionConstraint;
use elbowroom_cell::{Cell, Frames};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{AccessClass, OverrideReason, RegionId, RegionKind, VolumeId, ZoneArbiter};

use super::contact_recorder::ContactRecorder;
use super::deadlock_detector::DeadlockDetector;
use super::end_detector::EndDetector;
use super::fault_injection::FaultInjector;
use super::journal::Journal;
use super::options::{RunOptions, RunProgress};
use super::own_motion::OwnMotion;
use super::region_recorder::RegionRecorder;
use super::simulated_robot::{Governed, SimulatedRobot};
use super::virtual_robot::CooperatingRobots;
use crate::motion::RegionSwitch;
use crate::recording::{RunEnd, RunEvent};
use crate::replanning::PerceivedObstacles;

/// A run: robots on one clock, and their surroundings.
pub(super) struct Simulation<'a> {
    pub cell: &'a Cell,
    pub options: &'a RunOptions,
    pub robots: Vec<SimulatedRobot<'a>>,
    /// Position and motion of each robot.
    pub states: Vec<ChainState>,
    /// Arbiter of the exchange regions.
    pub arbiter: Option<Arc<ZoneArbiter>>,
    pub deadlocks: DeadlockDetector,
    /// Observations of the sensors; `None` only while they are updated.
    pub perceived: Option<PerceivedObstacles<'a>>,
    pub frames: Frames<'a>,
    pub fault_injector: FaultInjector<'a>,
    pub regions: RegionRecorder<'a>,
    pub contacts: ContactRecorder<'a>,
    /// Volumes that were released at this instant, each with its robot.
    pub released: Vec<(usize, VolumeId)>,
    pub virtual_robots: Vec<CooperatingRobots<'a>>,
    pub ends: EndDetector,
    pub journal: Journal<'a>,
}

impl Simulation<'_> {
    /// Runs to the end. Returns the time (s) and the reason of the end.
    ///
    /// # Errors
    /// [`Diagnostic`] if a part cannot be gripped, or a volume cannot be attached.
    pub fn run(&mut self, progress: &mut dyn FnMut(RunProgress)) -> Result<(f64, RunEnd), Diagnostic> {
        self.publish_initial_occupancy();
        self.hold_work_pieces()?;
        let mut tick = 0_u64;
        loop {
            let t_s = self.cell.timing.at(tick);
            if tick.is_multiple_of(256) {
                let finished = self.robots.iter().filter(|robot| robot.clock.finished()).count();
                progress(RunProgress { t_s, finished, robots: self.robots.len() });
            }
            self.tick(t_s)?;
            if let Some(end) = self.end(t_s) {
                return Ok((t_s, end));
            }
            self.advance(t_s)?;
            tick += 1;
        }
    }

    /// Publishes the occupancy of every robot before the first tick of a cell with exchange regions.
    ///
    /// A robot that starts inside would otherwise wait for robots without a status, and count as having entered.
    fn publish_initial_occupancy(&mut self) {
        if !self.cell.regions.iter().any(|r| matches!(r.region.kind, RegionKind::Exchange { .. })) {
            return;
        }
        self.update_states(0.0);
        self.declare_claims();
        let Self { cell, options, robots, states, frames, journal, .. } = self;
        for (robot, state) in robots.iter_mut().zip(&*states).filter(|(r, _)| !options.is_silent(r.id, 0.0)) {
            let sources = frames.sources(&robot.setup.sources, states, 0.0);
            robot.publish_occupancy(-cell.timing.tick_s, state, sources, journal);
        }
    }

    /// Evaluates one instant; nothing moves.
    fn tick(&mut self, t_s: f64) -> Result<(), Diagnostic> {
        self.apply_switches(t_s);
        self.update_states(t_s);
        self.perceive(t_s);
        self.declare_claims();
        self.contacts.check(t_s, &mut self.robots, &self.states);
        // Before the monitors' ticks, which decide how fast the robot moves with what it grips.
        self.apply_tools(t_s)?;
        self.apply_grips(t_s)?;
        for i in 0..self.robots.len() {
            self.tick_robot(i, t_s);
        }
        self.regions.observe(t_s, &self.robots, &self.states, &self.frames);
        if let Some(arbiter) = &self.arbiter {
            self.deadlocks.observe(t_s, arbiter, &self.robots);
        }
        self.journal.instant(t_s, &self.contacts.objects, self.arbiter.as_deref());
        self.detach_released()
    }

    fn declare_claims(&mut self) {
        let Some(arbiter) = &self.arbiter else { return };
        for SimulatedRobot { claims, clock, .. } in &mut self.robots {
            if let Some(claims) = claims {
                claims.declare(clock, arbiter);
            }
        }
    }

    pub(super) fn update_states(&mut self, t_s: f64) {
        for (robot, state) in self.robots.iter().zip(&mut self.states) {
            robot.write_state(self.cell, self.options.is_silent(robot.id, t_s), state);
        }
    }

    fn apply_switches(&mut self, t_s: f64) {
        for i in 0..self.robots.len() {
            for RegionSwitch { region, active } in self.robots[i].clock.take_switches() {
                if !self.regions.switch(region, t_s, active) {
                    continue;
                }
                let event = if active { RunEvent::On } else { RunEvent::Off };
                self.journal.event(t_s, self.robots[i].id, &self.cell.regions[region.0].region.name, event);
                for robot in &mut self.robots {
                    let Some(local) = robot.setup.regions.iter().position(|r| *r == region) else { continue };
                    // The cell file refuses switching of permanent regions, so this cannot fail.
                    if robot.monitor.switch(RegionId(local), active, AccessClass::Programmer).is_ok() {
                        self.journal.switched(robot.id, RegionId(local), active);
                    }
                }
            }
        }
    }

    /// Runs the tick of a robot's monitor, applies and records it.
    fn tick_robot(&mut self, i: usize, t_s: f64) {
        let Self { cell, options, robots, states, frames, fault_injector, journal, .. } = self;
        let (robot, state) = (&mut robots[i], &states[i]);
        if options.is_silent(robot.id, t_s) {
            robot.applied = 0.0;
            return robot.record(cell, t_s, state, &Governed::STALE);
        }
        let sources = frames.sources(&robot.setup.sources, states, t_s);
        let Some(report) = robot.tick_monitor(t_s, state, &sources, fault_injector, journal) else {
            if robot.obeys(options) && !fault_injector.keeps_last_override(robot.id, t_s) {
                robot.applied = 0.0;
            }
            return robot.record(cell, t_s, state, &Governed::STALE);
        };
        let programmed = robot.programmed_override();
        robot.applied = if robot.obeys(options) { report.speed_override.min(programmed) } else { programmed };
        robot.governing = report.governing;
        journal.monitor_events(t_s, robot.id, &robot.monitor, robot.setup);
        // A region governs if it makes the robot slower than programmed.
        let is_governed = options.apply_override && robot.hold.reason().is_none();
        let regions = &robot.setup.regions;
        let region = is_governed.then(|| report.reason.region()).flatten().map(|r| regions[r.0]);
        // A monitor numbers its own regions, a recording the regions of the cell.
        let in_cell = |r: RegionId| RegionId(regions[r.0].0);
        let reason = if is_governed { report.reason.with_region(in_cell) } else { OverrideReason::Free };
        let point = region.and(report.governing);
        robot.record(cell, t_s, state, &Governed { region, point, reason, outputs: Some(report.outputs) });
        if let Some(event) = robot.stop_state.update(&robot.clock, robot.applied) {
            let region = region.map_or("", |r| cell.regions[r.0].region.name.as_str());
            let by = robot.hold.reason().map_or(region, |(_, by)| by).to_owned();
            robot.record_stop(t_s, &by, point, event == RunEvent::Stop);
            journal.event(t_s, robot.id, &by, event);
        }
        if robot.stop_state.stopped {
            robot.track.stopped_s += cell.timing.tick_s;
        }
    }

    /// Moves the robots from `t_s` to the next tick.
    fn advance(&mut self, t_s: f64) -> Result<(), Diagnostic> {
        let Self { cell, options, robots, states, frames, journal, .. } = self;
        for robot in robots.iter_mut().filter(|robot| !options.is_silent(robot.id, t_s)) {
            let SimulatedRobot { id, setup, monitor, clock, own_motion, applied, delay, guard, .. } = robot;
            let avoiding = match own_motion {
                OwnMotion::Avoiding(avoiding) => avoiding,
                OwnMotion::None => {
                    delay.send(t_s, *applied);
                    delay.advance(clock, t_s, cell.timing.tick_s, guard.is_some());
                    continue;
                }
                // All members of a virtual robot move together.
                OwnMotion::Cooperating(_) => continue,
                OwnMotion::Guided(guided) => {
                    guided.advance(cell, states, t_s, *applied, |name, event| journal.event(t_s, *id, name, event))?;
                    // Who moves after it in this tick is proven against where it is then.
                    guided.write_state(&mut states[id.0]);
                    continue;
                }
            };
            let regions = |share: f64| {
                let sources = frames.sources(&setup.sources, states, t_s);
                RegionConstraint::new(monitor, &sources, share, 0.0)
            };
            if let Some(event) = avoiding.advance(cell, clock, states, t_s, *applied, regions) {
                let is_evaded = event == RunEvent::Avoidance(AvoiderState::Evading);
                journal.event(t_s, *id, avoiding.obstacle().filter(|_| is_evaded).unwrap_or_default(), event);
            }
        }
        self.cooperate(t_s)
    }
}
