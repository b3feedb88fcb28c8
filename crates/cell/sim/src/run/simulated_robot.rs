//! One robot of a run.

use std::time::Instant;

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, CellRegionId, CellRobot};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_monitor::{Fault, Monitor, OverrideReason, Snapshot, SourceState, TickReport, VirtualTcp};
use elbowroom_robot::RobotId;

use super::fault_injection::FaultInjector;
use super::journal::Journal;
use super::observer::ObservedTick;
use super::options::RunOptions;
use super::outcome::part_name;
use super::override_delay::OverrideDelay;
use super::own_motion::OwnMotion;
use super::stop_state::StopState;
use super::zone_claims::ZoneClaims;
use crate::motion::ProgramClock;
use crate::recording::{GoverningPoint, RobotEnding, RobotTrack, Sample, Stop};
use crate::replanning::{PathGuard, PathReplanner, ProgramHold};

/// A robot with its program, its monitor, its avoidance or guard, and its recording.
pub(super) struct SimulatedRobot<'a> {
    pub id: RobotId,
    pub setup: &'a MonitorSetup,
    pub monitor: Monitor,
    /// Its program.
    pub clock: ProgramClock,
    /// The claims of its program; `None` if the program declares none.
    pub claims: Option<ZoneClaims>,
    /// What moves it besides its program.
    pub own_motion: OwnMotion<'a>,
    /// `None` if no sensor guards it.
    pub guard: Option<(PathGuard, PathReplanner<'a>)>,
    /// Whether an obstacle or a sensor holds it in this tick.
    pub hold: ProgramHold,
    /// The robot with its present tools.
    pub present: CellRobot,
    /// The point with the smallest requested override in the last tick.
    pub governing: Option<VirtualTcp>,
    pub stop_state: StopState,
    /// Override applied until the next tick.
    pub applied: f64,
    /// Overrides that have not taken effect yet.
    pub delay: OverrideDelay,
    pub track: RobotTrack,
    scratch: ChainState,
}

/// Reason of a robot's override in a tick, with the region and the point if a region is the reason.
#[derive(Debug, Clone, Copy)]
pub(super) struct Governed {
    pub region: Option<CellRegionId>,
    pub point: Option<VirtualTcp>,
    pub reason: OverrideReason,
    /// Digital outputs; `None` if they stay as they were.
    pub outputs: Option<u64>,
}

impl Governed {
    /// The lack of an input only.
    pub const STALE: Self =
        Self { region: None, point: None, reason: OverrideReason::Fault(Fault::Stale), outputs: None };
}

impl<'a> SimulatedRobot<'a> {
    /// Creates a robot that only its program moves, without a guard.
    pub fn new(
        cell: &Cell,
        id: RobotId,
        setup: &'a MonitorSetup,
        monitor: Monitor,
        clock: ProgramClock,
        claims: Option<ZoneClaims>,
    ) -> Self {
        let robot = &cell.robots[id.0];
        Self {
            id,
            setup,
            monitor,
            clock,
            claims,
            own_motion: OwnMotion::None,
            guard: None,
            hold: ProgramHold::recorded(),
            present: robot.clone(),
            governing: None,
            stop_state: StopState::default(),
            applied: 0.0,
            delay: OverrideDelay::new(cell.monitoring.reaction_delay_s),
            track: new_track(robot, setup),
            scratch: ChainState::new(&robot.robot.chain),
        }
    }

    /// Whether the robot obeys its monitor's override; a mechanism never does.
    pub fn obeys(&self, options: &RunOptions) -> bool {
        options.apply_override && !self.present.is_mechanism()
    }

    /// Whether the robot is on its programmed path.
    pub fn is_on_path(&self) -> bool {
        self.own_motion.is_on_path()
    }

    /// Whether its program is over.
    pub fn is_finished(&self) -> bool {
        self.clock.finished() && self.own_motion.is_over()
    }

    /// Writes position and motion. A silent robot is assumed to be stationary.
    pub fn write_state(&self, cell: &Cell, is_silent: bool, state: &mut ChainState) {
        let scale = if is_silent { 0.0 } else { 1.0 };
        state.q.copy_from_slice(&self.clock.point().q);
        state.qd.iter_mut().zip(self.clock.velocity()).for_each(|(to, v)| *to = v * scale);
        state.qdd.iter_mut().zip(self.clock.acceleration()).for_each(|(to, v)| *to = v * scale);
        if !self.own_motion.is_on_path() {
            self.own_motion.write_state(state);
            state.qd.iter_mut().chain(&mut state.qdd).for_each(|v| *v *= scale);
        }
        cell.robots[self.id.0].robot.chain.forward_motion(state);
    }

    /// The override that its program requests; 0 while the robot is held.
    ///
    /// A held robot is not commanded to move, so its constant joint values are not a frozen reading.
    pub fn programmed_override(&self) -> f64 {
        if self.hold.reason().is_some() { 0.0 } else { self.clock.programmed_override() }
    }

    /// Runs one tick of its monitor, with this state and these sources; `None` if a fault withholds the input.
    pub fn tick_monitor(
        &mut self,
        t_s: f64,
        state: &ChainState,
        sources: &[SourceState],
        injector: &mut FaultInjector<'_>,
        journal: &mut Journal<'_>,
    ) -> Option<TickReport> {
        let snapshot = Snapshot {
            now_s: t_s,
            stamp_s: t_s,
            q: &state.q,
            qd: &state.qd,
            qdd: &state.qdd,
            programmed_override: self.programmed_override(),
            intent: Some(self.own_motion.intent(&self.clock)),
            sources,
        };
        let snapshot = injector.apply(self.id, &snapshot)?;
        let begin = Instant::now();
        let report = self.monitor.tick(&snapshot);
        journal.tick_ns.push(begin.elapsed().as_nanos() as u64);
        let (monitor, present) = (&self.monitor, &self.present);
        journal.ticked(&ObservedTick { robot: self.id, snapshot: &snapshot, report: &report, monitor, present });
        Some(report)
    }

    /// Runs its monitor's tick before the first one, which only publishes the robot's position.
    pub fn publish_occupancy(
        &mut self,
        before_s: f64,
        state: &ChainState,
        sources: Vec<SourceState>,
        journal: &mut Journal<'_>,
    ) {
        let sources: Vec<_> = sources.into_iter().map(|s| SourceState { stamp_s: before_s, ..s }).collect();
        let snapshot = Snapshot {
            now_s: before_s,
            stamp_s: before_s,
            q: &state.q,
            qd: &state.qd,
            qdd: &state.qdd,
            programmed_override: self.clock.programmed_override(),
            intent: Some(self.clock.intent()),
            sources: &sources,
        };
        let report = self.monitor.tick(&snapshot);
        let (monitor, present) = (&self.monitor, &self.present);
        journal.ticked(&ObservedTick { robot: self.id, snapshot: &snapshot, report: &report, monitor, present });
        journal.monitor_events(0.0, self.id, &self.monitor, self.setup);
    }

    /// Records a tick.
    pub fn record(&mut self, cell: &Cell, t_s: f64, state: &ChainState, governed: &Governed) {
        let (tcp, tcp_speed) = self.present.tcp(state);
        // A robot off its path does not move by the time of its program.
        let rate = if self.is_on_path() { self.clock.rate() } else { 1.0 };
        if let Some(avoiding) = self.own_motion.avoiding_mut() {
            avoiding.record();
        }
        let programmed_speed = if rate > 1e-3 {
            tcp_speed / rate
        } else {
            self.scratch.q.copy_from_slice(&state.q);
            self.scratch.qd.copy_from_slice(&self.clock.point().dq);
            cell.robots[self.id.0].robot.chain.forward_motion(&mut self.scratch);
            self.present.tcp(&self.scratch).1
        };
        self.track.min_override = self.track.min_override.min(self.applied);
        let outputs = governed.outputs.or(self.track.samples.last().map(|s| s.outputs)).unwrap_or(0);
        self.track.samples.push(Sample {
            t_s,
            q: state.q.clone(),
            qd: state.qd.clone(),
            intent: self.own_motion.intent(&self.clock).to_vec(),
            tcp,
            tcp_speed,
            programmed_speed,
            speed_override: self.applied,
            region: governed.region,
            distance_m: governed.point.map(|g| g.distance_m),
            governing: governed.point.map(|g| GoverningPoint { part: g.volume.0, point: g.position }),
            reason: governed.reason,
            outputs,
        });
    }

    /// Records the start of a stop at the region or obstacle with this name (empty for none), or the end of the present
    /// stop.
    pub fn record_stop(&mut self, t_s: f64, by: &str, point: Option<VirtualTcp>, begins: bool) {
        let stops = &mut self.track.stops;
        if !begins {
            stops.last_mut().into_iter().for_each(|stop| stop.to_s = t_s);
            return;
        }
        stops.push(Stop {
            from_s: t_s,
            to_s: f64::INFINITY,
            by: (!by.is_empty()).then(|| by.to_owned()),
            part: point.and_then(|g| part_name(&self.setup.configuration, g.volume)),
            point: point.map(|g| g.position),
            distance_m: point.map(|g| g.distance_m),
        });
    }
}

fn new_track(robot: &CellRobot, setup: &MonitorSetup) -> RobotTrack {
    RobotTrack {
        name: robot.name.clone(),
        flange: if robot.is_mechanism() { String::new() } else { robot.robot.chain.links()[robot.flange.0].clone() },
        joints: robot.joint_names(),
        parts: setup.configuration.volumes().iter().map(|v| v.name.clone()).collect(),
        absent_links: absent_links(robot).into_iter().map(|links| (0.0, links)).collect(),
        samples: Vec::new(),
        stops: Vec::new(),
        finished: false,
        stopped_s: 0.0,
        min_override: 1.0,
        collisions: Vec::new(),
        avoidance: None,
        guidance: None,
        perception: None,
        ending: RobotEnding::default(),
    }
}

/// Links of the tools that are not mounted; `None` if all tools are mounted.
pub(super) fn absent_links(robot: &CellRobot) -> Option<Vec<LinkId>> {
    let absent: Vec<LinkId> = robot.payload.tools.iter().filter(|t| !t.mounted).map(|t| t.link).collect();
    (!absent.is_empty()).then_some(absent)
}
