//! Cell at rest whose robots a person moves.

use std::sync::Arc;
use std::time::Instant;

use elbowroom_cell::configure::{self, MonitorSetup};
use elbowroom_cell::{Cell, CellRobot, Frames};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::inverse::{IkOptions, IkSolver, IkTask};
use elbowroom_kinematics::{ChainState, Joint, JointKind};
use elbowroom_monitor::{EventKind, Monitor, RobotSlot, SlotId, Snapshot, SourceState, TickReport, ZoneArbiter};
use elbowroom_robot::RobotId;
use elbowroom_spatial::{FrameMotion, Pose};
use elbowroom_status::{CellStatus, EventStatus, PoseStatus, RobotStatus, SlotStatus};

use super::distances::pose_of;
use crate::source::{Command, CommandRefusal, ViewSource};

/// Time that passes for the monitors while a robot is moved, s: long enough that any move is plausible.
const MOVE_S: f64 = 3600.0;
/// Time between two ticks at rest, s.
const REST_S: f64 = 0.05;
/// Largest number of ticks until overrides whose rate is limited stop changing.
const MAX_TICKS: usize = 400;
/// Largest excess of a joint value over its limit, rad or m: rounding of a slider.
const LIMIT_TOLERANCE: f64 = 1e-9;
/// Number of independent joints that a pose needs.
const POSE_JOINTS: usize = 6;

/// Makes the refusal of a value beyond the limits, in the units of the page: millimetres and degrees.
fn beyond_limits(joint: &Joint, value: f64) -> CommandRefusal {
    let (unit, one) = if joint.kind == JointKind::Prismatic { ("mm", 1e-3) } else { ("degrees", 1_f64.to_radians()) };
    let [lower, upper, value] = [joint.limits.lower, joint.limits.upper, value].map(|v| v / one);
    CommandRefusal::Limits { joint: joint.name.clone(), unit, lower, upper, value }
}

/// A cell at rest under its monitors. Belts, objects and pose files stay at their start.
pub(crate) struct JogCell {
    cell: Arc<Cell>,
    setups: Arc<Vec<MonitorSetup>>,
    monitors: Vec<Monitor>,
    arbiter: Option<Arc<ZoneArbiter>>,
    solvers: Vec<IkSolver>,
    chains: Vec<ChainState>,
    q: Vec<Vec<f64>>,
    /// Clock of the monitors, s.
    now_s: f64,
    begin: Instant,
}

impl JogCell {
    pub(crate) fn new(cell: Arc<Cell>, setups: Arc<Vec<MonitorSetup>>) -> Result<Self, Diagnostic> {
        let arbiter = configure::zone_arbiter(&cell);
        Ok(Self {
            monitors: configure::monitors_with(&cell, &setups, arbiter.as_ref())?,
            solvers: cell.robots.iter().map(solver).collect(),
            chains: cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            q: cell.robots.iter().map(|r| r.start.clone()).collect(),
            now_s: 0.0,
            begin: Instant::now(),
            arbiter,
            cell,
            setups,
        })
    }

    fn robot(&self, robot: RobotId) -> Result<&CellRobot, CommandRefusal> {
        self.cell.robots.get(robot.0).ok_or(CommandRefusal::NoRobot(robot))
    }

    fn jog(&mut self, robot: RobotId, q: Vec<f64>) -> Result<(), CommandRefusal> {
        let r = self.robot(robot)?;
        let chain = &r.robot.chain;
        if q.len() != chain.dof() {
            let (robot, joints) = (r.name.clone(), chain.dof());
            return Err(CommandRefusal::JointCount { robot, joints, values: q.len() });
        }
        for (value, id) in q.iter().zip(chain.active_joints()) {
            let joint = &chain.joints()[id.0];
            if !value.is_finite() || !joint.limits.contains(*value, LIMIT_TOLERANCE) {
                return Err(beyond_limits(joint, *value));
            }
        }
        self.q[robot.0] = q;
        Ok(())
    }

    fn move_tcp(&mut self, robot: RobotId, target: &PoseStatus) -> Result<(), CommandRefusal> {
        let base_in_world = self.robot(robot)?.base_in_world;
        let target = pose_of(target).ok_or(CommandRefusal::Pose)?;
        let in_root = base_in_world.inverse_mul(&target);
        // First a few steps from the present joint values, so that the arm does not change its configuration without need.
        let mut q = self.q[robot.0].clone();
        let solver = &mut self.solvers[robot.0];
        if !solver.refine(&in_root, &mut q) {
            q = solver.solve(&in_root, &self.q[robot.0])?.q;
        }
        self.jog(robot, q)
    }

    /// Computes the pose of the tool centre point in the world.
    fn tcp(&self, robot: RobotId) -> Pose {
        let r = &self.cell.robots[robot.0];
        r.base_in_world * self.chains[robot.0].link_in_root(r.flange) * r.tcp_in_flange
    }

    fn place(&mut self) {
        for ((chain, q), r) in self.chains.iter_mut().zip(&self.q).zip(&self.cell.robots) {
            chain.q.copy_from_slice(q);
            r.robot.chain.forward_motion(chain);
        }
    }

    /// Ticks every monitor once, and adds the events that concern regions.
    fn tick(&mut self, after_s: f64, events: &mut Vec<EventStatus>) -> Vec<(TickReport, Vec<SourceState>)> {
        self.now_s += after_s;
        let t_s = self.begin.elapsed().as_secs_f64();
        let mut reports = Vec::with_capacity(self.monitors.len());
        for (r, monitor) in self.monitors.iter_mut().enumerate() {
            let sources = sources(&self.cell, &self.setups[r], &self.chains, self.now_s);
            let at_rest = vec![0.0; self.q[r].len()];
            let report = monitor.tick(&snapshot(self.now_s, &self.q[r], &at_rest, &sources));
            // A move is a jump, which causes a fault for one tick; that fault is not of the cell.
            let shown = monitor.events().iter().filter(|e| !matches!(e.kind, EventKind::Fault | EventKind::Recovered));
            events.extend(shown.map(|e| EventStatus {
                t_s,
                robot: self.cell.robots[r].name.clone(),
                region: e.region.map_or_else(String::new, |id| monitor.configuration().regions()[id.0].name.clone()),
                event: e.kind.name().to_owned(),
            }));
            reports.push((report, sources));
        }
        reports
    }

    /// Ticks until no override changes any more; the monitors then know the positions of all robots.
    fn settle(&mut self, events: &mut Vec<EventStatus>) -> Vec<(TickReport, Vec<SourceState>)> {
        self.tick(MOVE_S, events);
        let mut last = self.tick(REST_S, events);
        for _ in 0..MAX_TICKS {
            let next = self.tick(REST_S, events);
            let is_same = next.iter().zip(&last).all(|(a, b)| a.0.speed_override == b.0.speed_override);
            last = next;
            if is_same {
                break;
            }
        }
        last
    }

    fn slots(&self) -> Vec<SlotStatus> {
        let Some(arbiter) = &self.arbiter else { return Vec::new() };
        let of_region = configure::slots(&self.cell);
        let slot = |slot: SlotId| {
            let regions = of_region.iter().zip(&self.cell.regions).filter(|(s, _)| **s == Some(slot));
            let waits = |r: &usize| {
                self.setups[*r].regions.iter().enumerate().any(|(own, id)| {
                    let state = self.monitors[*r].exchange_state(elbowroom_monitor::RegionId(own));
                    of_region[id.0] == Some(slot) && state.is_some_and(|s| s.name() == "waiting")
                })
            };
            let name = |r: usize| self.cell.robots[r].name.clone();
            SlotStatus {
                regions: regions.map(|(_, r)| r.region.name.clone()).collect(),
                holder: arbiter.holder(slot).map(|RobotSlot(r)| name(r)),
                queue: (0..self.monitors.len()).filter(waits).map(name).collect(),
                age_s: 0.0,
            }
        };
        (0..arbiter.slots()).map(SlotId).map(slot).collect()
    }
}

impl ViewSource for JogCell {
    fn mode(&self) -> &'static str {
        "jog"
    }

    fn command(&mut self, command: Command) -> Result<(), CommandRefusal> {
        match command {
            Command::Jog { robot, q } => self.jog(RobotId(robot), q)?,
            Command::Tcp { robot, position_m, quaternion_xyzw } => {
                let robot = RobotId(robot);
                self.robot(robot)?;
                let quaternion_xyzw = quaternion_xyzw.unwrap_or_else(|| self.tcp(robot).rotation.to_quaternion_xyzw());
                self.move_tcp(robot, &PoseStatus { position_m, quaternion_xyzw })?;
            }
            Command::Home {} => self.q = self.cell.robots.iter().map(|r| r.start.clone()).collect(),
        }
        self.place();
        Ok(())
    }

    fn status(&mut self) -> Option<(CellStatus, Vec<EventStatus>)> {
        self.place();
        let mut events = Vec::new();
        let reports = self.settle(&mut events);
        let t_s = self.begin.elapsed().as_secs_f64();
        let robot = |(r, (report, sources)): (usize, &(TickReport, Vec<SourceState>))| {
            let at_rest = vec![0.0; self.q[r].len()];
            let snapshot = snapshot(self.now_s, &self.q[r], &at_rest, sources);
            RobotStatus::of_tick(t_s, &self.monitors[r], &snapshot, report, Some(&self.tcp(RobotId(r))))
        };
        let status = CellStatus {
            t_s,
            cell: self.cell.name.clone(),
            checksum: self.cell.approval.checksum.clone(),
            robots: reports.iter().enumerate().map(robot).collect(),
            slots: self.slots(),
            ..CellStatus::default()
        };
        Some((status, events))
    }
}

fn snapshot<'a>(now_s: f64, q: &'a [f64], at_rest: &'a [f64], sources: &'a [SourceState]) -> Snapshot<'a> {
    Snapshot { qd: at_rest, qdd: at_rest, sources, ..Snapshot::stationary(now_s, q) }
}

/// States of the frames that regions follow, at rest: those of robots where the robots are, all others as at the start.
fn sources(cell: &Cell, setup: &MonitorSetup, chains: &[ChainState], now_s: f64) -> Vec<SourceState> {
    let at_rest = |source: SourceState| SourceState { motion: FrameMotion::REST, stamp_s: now_s, ..source };
    Frames::new(cell).sources(&setup.sources, chains, 0.0).into_iter().map(at_rest).collect()
}

/// Makes the solver: for position and orientation if the arm has enough joints, else for the position alone.
fn solver(r: &CellRobot) -> IkSolver {
    let chain = &r.robot.chain;
    let moving = chain.path(r.flange).into_iter().filter(|j| chain.coupling(*j).is_some()).count();
    let task = if moving >= POSE_JOINTS { IkTask::Pose } else { IkTask::Position };
    // Few restarts are enough: during a drag the next request follows at once.
    IkSolver::new(chain, r.flange, r.tcp_in_flange, IkOptions { task, restarts: 12, ..IkOptions::default() })
}
