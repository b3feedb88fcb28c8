//! A robot with an operator in a run.

use elbowroom_cell::shared_control::{ArmLimit, GuidedArm, Limit};
use elbowroom_cell::{Cell, CellOperator, OperatorInput};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneError, SceneState};

use crate::recording::{ForceSample, GuidanceSample, GuidanceState, GuidanceTrack, RunEvent};

/// Speed of the tool point from which a tool in contact glides, m/s.
const GLIDING_M_S: f64 = 2e-3;

/// A robot that a person guides.
#[derive(Debug)]
pub(super) struct GuidedRobot<'s> {
    operator: &'s CellOperator,
    arm: GuidedArm<'s>,
    /// Joint velocities of the last tick, rad/s or m/s.
    velocity: Vec<f64>,
    /// Joint velocities at override 1.
    intent: Vec<f64>,
    rest: Vec<f64>,
    state: GuidanceState,
    is_over: bool,
    track: GuidanceTrack,
}

impl<'s> GuidedRobot<'s> {
    /// The operator of a robot; `None` for a robot without.
    pub fn of_robot(
        cell: &'s Cell,
        scene: &'s Scene,
        robot: RobotId,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<Option<Self>, Diagnostic> {
        let Some(operator) = cell.guidance.operator_of(robot) else { return Ok(None) };
        let arm = operator.arm(cell, scene, notes)?;
        let rest = vec![0.0; arm.q().len()];
        let track = GuidanceTrack { operator: operator.name.clone(), samples: Vec::new() };
        let (velocity, intent, state) = (rest.clone(), rest.clone(), GuidanceState::Free);
        Ok(Some(Self { operator, arm, velocity, intent, rest, state, is_over: false, track }))
    }

    /// True when the stream is over and the robot has come to rest.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Writes the robot's joint values and velocities.
    pub fn write_state(&self, state: &mut ChainState) {
        state.q.copy_from_slice(self.arm.q());
        state.qd.copy_from_slice(&self.velocity);
        state.qdd.copy_from_slice(&self.rest);
    }

    /// Joint velocities at override 1.
    pub fn intent(&self) -> &[f64] {
        &self.intent
    }

    /// The recording.
    pub fn finish(self) -> GuidanceTrack {
        self.track
    }

    /// Moves the arm from `t_s` to the next tick under the override of the monitor. Returns an event if its state
    /// changed.
    pub fn advance(
        &mut self,
        cell: &Cell,
        states: &[ChainState],
        t_s: f64,
        allowed: f64,
    ) -> Result<Option<RunEvent>, Diagnostic> {
        let tick_s = cell.timing.tick_s;
        self.arm
            .surroundings(|scene, state| place(cell, scene, state, states, &[self.operator.robot], t_s))
            .map_err(|e| Diagnostic::new(&cell.file, self.operator.line, e))?;
        let before = self.arm.tool_in_world();
        self.velocity.copy_from_slice(self.arm.q());
        let input = self.operator.stream.at(t_s);
        let wanted = if let OperatorInput::Pose(pose) = input { Some(pose) } else { None };
        let step = self.arm.step(wanted.as_ref(), tick_s, allowed);
        for (velocity, q) in self.velocity.iter_mut().zip(self.arm.q()) {
            *velocity = (q - *velocity) / tick_s;
        }
        // What the hand wants, also while the override lets nothing move: it may lead away from a region.
        self.arm.intent(wanted.as_ref(), tick_s, &mut self.intent);
        let tool_in_world = self.arm.tool_in_world();
        let is_at_rest = self.velocity.iter().all(|v| *v == 0.0);
        self.is_over = input == OperatorInput::Over && is_at_rest;
        let sample = GuidanceSample {
            t_s,
            wanted,
            tool_in_world,
            velocity: (tool_in_world.translation - before.translation) / tick_s,
            is_moving: allowed > 0.0,
            gap_m: step.tool.gap_m,
            active: step.tool.active_rows,
            limit: step.limit,
            force: self.arm.forces().map(|f| ForceSample { on_hand_n: f.force_on_hand(), energy_j: f.energy_j() }),
        };
        self.track.samples.push(sample);
        let is_held = allowed <= 0.0 || matches!(input, OperatorInput::Disabled | OperatorInput::Stale);
        let now = next_state(self.state, &sample, is_held);
        let changed = now != self.state;
        self.state = now;
        Ok(changed.then_some(RunEvent::Guided(now)))
    }
}

/// The state after a sample.
fn next_state(before: GuidanceState, sample: &GuidanceSample, is_held: bool) -> GuidanceState {
    match sample.limit {
        _ if is_held => GuidanceState::Held,
        Some(ArmLimit::Tool(Limit::Surface | Limit::Proof)) | None if sample.active > 0 => {
            let glides = sample.velocity.length() > GLIDING_M_S;
            match before {
                GuidanceState::Gliding => GuidanceState::Gliding,
                GuidanceState::Touching if glides => GuidanceState::Gliding,
                _ => GuidanceState::Touching,
            }
        }
        Some(ArmLimit::Tool(Limit::Surface | Limit::Proof)) | None => GuidanceState::Free,
        Some(_) => GuidanceState::Refused,
    }
}

/// Places everything but robots that decide their motion themselves.
pub(super) fn place(
    cell: &Cell,
    scene: &Scene,
    state: &mut SceneState,
    states: &[ChainState],
    own: &[RobotId],
    t_s: f64,
) -> Result<(), SceneError> {
    for (index, other) in states.iter().enumerate().filter(|(index, _)| !own.contains(&RobotId(*index))) {
        state.set_q(scene, RobotId(index), &other.q)?;
    }
    cell.moving_objects.iter().try_for_each(|m| state.place(scene, m.object, m.pose(t_s)))
}
