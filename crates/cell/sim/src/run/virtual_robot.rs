//! Robots that act as one in a run.

use elbowroom_cell::cooperation::VirtualRobot;
use elbowroom_cell::{Cell, CellVirtualRobot, OperatorInput};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Attachment, Scene};

use super::guided_robot::place;
use crate::recording::{HandOverRecord, RunEvent, ViewTrack, VirtualRobotSample, VirtualRobotTrack, WorkPieceStop};

/// Time for which a work-piece stands after the end of its stream until the run may end, s.
const STUCK_S: f64 = 5.0;
/// Distance between two robots beyond which it is not recorded, m.
const FAR_M: f64 = 0.1;
/// Override below which the intent of a robot is not its velocity, scaled.
const LEAST_OVERRIDE: f64 = 0.02;

/// A member of a virtual robot: its motion, which the virtual robot decides.
#[derive(Debug)]
pub(super) struct CooperatingRobot {
    /// Joint values, rad or m.
    pub q: Vec<f64>,
    /// Joint velocities of the last tick, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Joint velocities at override 1.
    pub intent: Vec<f64>,
    /// Whether the virtual robot has nothing left to do.
    pub is_over: bool,
}

impl CooperatingRobot {
    /// A robot at rest.
    pub fn new(q: &[f64]) -> Self {
        let rest = vec![0.0; q.len()];
        Self { q: q.to_vec(), velocity: rest.clone(), intent: rest, is_over: false }
    }

    /// Writes the robot's joint values and velocities.
    pub fn write_state(&self, state: &mut ChainState) {
        state.q.copy_from_slice(&self.q);
        state.qd.copy_from_slice(&self.velocity);
        state.qdd.fill(0.0);
    }
}

/// A virtual robot.
#[derive(Debug)]
pub(super) struct CooperatingRobots<'s> {
    pub spec: &'s CellVirtualRobot,
    robot: VirtualRobot<'s>,
    /// Time of the last row that was desired, s.
    desired_s: Option<f64>,
    /// Number of rows that were refused.
    left_out: usize,
    /// The time between these poses and the ones before them, s.
    left_out_s: f64,
    stopped_s: f64,
    is_held: bool,
    is_hidden: bool,
    yields: Vec<bool>,
    is_over: bool,
    track: VirtualRobotTrack,
}

impl<'s> CooperatingRobots<'s> {
    /// The virtual robot at its start.
    pub fn new(spec: &'s CellVirtualRobot, cell: &'s Cell, scene: &'s Scene) -> Result<Self, Diagnostic> {
        let robots = spec.members.iter().map(|m| cell.robots[m.robot.0].name.clone()).collect();
        Ok(Self {
            spec,
            robot: spec.start(cell, scene)?,
            desired_s: None,
            left_out: 0,
            left_out_s: 0.0,
            stopped_s: 0.0,
            is_held: false,
            is_hidden: false,
            yields: vec![false; spec.members.len()],
            is_over: false,
            track: VirtualRobotTrack {
                name: spec.name.clone(),
                robots,
                samples: Vec::new(),
                hand_overs: Vec::new(),
                stops: Vec::new(),
                carried_share: 0.0,
                least_singular_value: spec.settings.least_singular_value,
                view: spec
                    .view
                    .as_ref()
                    .map(|view| ViewTrack { camera: view.camera.clone(), allowed_share: spec.settings.hidden_share }),
            },
        })
    }

    /// How the work-piece is attached.
    pub fn attachment(&self) -> Option<&Attachment> {
        self.robot.attachment()
    }

    /// Moves the robots from `t_s` to the next tick, each under the override of its monitor. Reports events with the robot
    /// that they concern.
    pub fn advance(
        &mut self,
        cell: &Cell,
        states: &[ChainState],
        (t_s, overrides): (f64, &[f64]),
        mut event: impl FnMut(RobotId, RunEvent),
    ) -> Result<(), Diagnostic> {
        let members: Vec<RobotId> = self.spec.members.iter().map(|m| m.robot).collect();
        self.robot
            .surroundings(|scene, state| place(cell, scene, state, states, &members, t_s))
            .map_err(|e| Diagnostic::new(&cell.file, self.spec.line, e))?;
        let input = self.desire(t_s);
        let tick_s = cell.timing.tick_s;
        let step = self.robot.step(tick_s, overrides);
        if let Some(handed_over) = step.handed_over {
            let reason = self.spec.hand_over_in_words(cell, &handed_over);
            self.track.hand_overs.push(HandOverRecord { t_s, from: handed_over.from, to: handed_over.to, reason });
            event(members[handed_over.to], RunEvent::HandOver);
        }
        for (member, yielded) in self.yields.iter_mut().enumerate() {
            let yields = self.robot.is_yielding(member);
            if yields && !*yielded {
                event(members[member], RunEvent::Yield);
            }
            *yielded = yields;
        }
        let holder = self.robot.holder();
        if let Some(hold) = step.hold.filter(|_| !self.is_held) {
            event(members[holder], RunEvent::Hold);
            let reason = self.spec.hold_in_words(cell, &hold);
            self.track.stops.push(WorkPieceStop { from_s: t_s, to_s: f64::INFINITY, reason });
        }
        let is_held = step.hold.is_some();
        if let Some(stop) = self.track.stops.last_mut().filter(|_| self.is_held) {
            stop.to_s = t_s;
        }
        self.is_held = is_held;
        self.stopped_s = if is_held { self.stopped_s + tick_s } else { 0.0 };
        let hidden_share = self.robot.hidden_share();
        let is_hidden = hidden_share.is_some_and(|share| share > self.spec.settings.hidden_share);
        if is_hidden && !self.is_hidden {
            event(members[holder], RunEvent::Hidden);
        }
        self.is_hidden = is_hidden;
        let (on_path, left_s) = self.robot.on_path();
        self.is_over = input == OperatorInput::Over && (left_s < 1e-6 || self.stopped_s > STUCK_S);
        self.track.samples.push(VirtualRobotSample {
            t_s,
            holder,
            part_in_world: self.robot.part_in_world(),
            on_path,
            rate: step.rate,
            is_stopped: is_held,
            gap_m: self.robot.gap_m(FAR_M),
            singular_value: self.robot.least_singular_value(),
            hidden_share,
        });
        Ok(())
    }

    /// Hands on the rows that have come until this time.
    fn desire(&mut self, t_s: f64) -> OperatorInput {
        let stream = &self.spec.stream;
        for (row_s, pose) in stream.rows_between(self.desired_s, t_s) {
            // A pose that is refused, because too many wait or it is too far away, is left out.
            let taken = pose.map_or(Ok(()), |pose| self.robot.desire(row_s, &pose));
            if taken.is_err() {
                self.left_out += 1;
                self.left_out_s += row_s - self.desired_s.unwrap_or(row_s);
            }
            self.desired_s = Some(row_s);
        }
        let input = stream.at(t_s);
        match input {
            OperatorInput::Pose(_) => {}
            OperatorInput::Disabled | OperatorInput::Stale => self.robot.pause(),
            OperatorInput::Over => self.robot.end(),
        }
        input
    }

    /// Writes the motion of a member, under the override of its monitor.
    pub fn write(&mut self, member: usize, tick_s: f64, speed_override: f64, to: &mut CooperatingRobot) {
        to.q.copy_from_slice(self.robot.q(member));
        to.velocity.copy_from_slice(self.robot.qd(member));
        to.is_over = self.is_over;
        if speed_override > LEAST_OVERRIDE {
            to.intent.iter_mut().zip(&to.velocity).for_each(|(intent, v)| *intent = v / speed_override.min(1.0));
        } else {
            self.robot.intent(member, tick_s, &mut to.intent);
        }
    }

    /// A warning if poses of the stream were left out.
    pub fn warning(&self, cell: &Cell) -> Option<Diagnostic> {
        let what = format!("{} poses of the stream of \"{}\" were left out", self.left_out, self.spec.name);
        let hint = "fewer than 16,000 poses that wait, each within a day of the one before";
        (self.left_out > 0).then(|| Diagnostic::new(&cell.file, self.spec.line, what).hint(hint))
    }

    /// The recording.
    pub fn finish(mut self) -> VirtualRobotTrack {
        if let (Some(stop), Some(last)) = (self.track.stops.last_mut(), self.track.samples.last()) {
            stop.to_s = stop.to_s.min(last.t_s);
        }
        let (_, left_s) = self.robot.on_path();
        let done_s = self.robot.path_s();
        // What was left out, or did not come before the end of the run, counts as the time between its rows.
        let unread = self.spec.stream.rows_between(self.desired_s, f64::INFINITY);
        let last_s = unread.filter(|(_, pose)| pose.is_some()).map(|(t_s, _)| t_s).fold(0.0, f64::max);
        let unread_s = (last_s - self.desired_s.unwrap_or(0.0)).max(0.0);
        let whole_s = done_s + left_s + self.left_out_s + unread_s;
        self.track.carried_share = if whole_s > 0.0 { done_s / whole_s } else { 1.0 };
        self.track
    }
}
