//! A robot with an operator in a run.

use elbowroom_cell::shared_control::{ArmLimit, Limit};
use elbowroom_cell::{Cell, CellOperator, FixtureChange, OperatedArm, OperatorInput};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_kinematics::ChainState;
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneError, SceneState};
use elbowroom_spatial::Pose;

use crate::recording::{ForceSample, GuidanceSample, GuidanceState, GuidanceTrack, RunEvent};

/// Speed of the tool point from which a tool in contact glides, m/s.
const GLIDING_M_S: f64 = 2e-3;

/// A robot that a person guides.
#[derive(Debug)]
pub(super) struct GuidedRobot<'s> {
    operator: &'s CellOperator,
    operated: OperatedArm<'s>,
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
        let operated = operator.arm(cell, scene, notes)?;
        let rest = vec![0.0; operated.arm.q().len()];
        let track = GuidanceTrack { operator: operator.name.clone(), samples: Vec::new() };
        let (velocity, intent, state) = (rest.clone(), rest.clone(), GuidanceState::Free);
        Ok(Some(Self { operator, operated, velocity, intent, rest, state, is_over: false, track }))
    }

    /// True when the stream is over and the robot has come to rest.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Writes the robot's joint values and velocities.
    pub fn write_state(&self, state: &mut ChainState) {
        state.q.copy_from_slice(self.operated.arm.q());
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

    /// Moves the arm from `t_s` to the next tick under the override of the monitor. Reports events, each with the fixture
    /// that it concerns, if any.
    pub fn advance(
        &mut self,
        cell: &Cell,
        states: &[ChainState],
        t_s: f64,
        allowed: f64,
        mut event: impl FnMut(&str, RunEvent),
    ) -> Result<(), Diagnostic> {
        let tick_s = cell.timing.tick_s;
        self.operated.switch(cell, self.operator, t_s, |name, change| event(name, of_fixture(change)));
        let arm = &mut self.operated.arm;
        arm.surroundings(|scene, state| place(cell, scene, state, states, &[self.operator.robot], t_s))
            .map_err(|e| Diagnostic::new(&cell.file, self.operator.line, e))?;
        let before = arm.tool_in_world();
        self.velocity.copy_from_slice(arm.q());
        let input = self.operator.stream.at(t_s);
        let wanted = pose_of(input);
        let step = arm.step(wanted.as_ref(), tick_s, allowed);
        for (velocity, q) in self.velocity.iter_mut().zip(arm.q()) {
            *velocity = (q - *velocity) / tick_s;
        }
        // Where the hand leads in the next tick, also while the override lets nothing move: it may lead away from a region.
        // Where it leads now, a tool that keeps up with it has arrived.
        let next = pose_of(self.operator.stream.at(cell.timing.after(t_s)));
        arm.intent(next.as_ref(), tick_s, &mut self.intent);
        let tool_in_world = arm.tool_in_world();
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
            force: arm.forces().map(|f| ForceSample { on_hand_n: f.force_on_hand(), energy_j: f.energy_j() }),
        };
        self.track.samples.push(sample);
        let is_held = allowed <= 0.0 || matches!(input, OperatorInput::Disabled | OperatorInput::Stale);
        let now = next_state(self.state, &sample, is_held);
        if std::mem::replace(&mut self.state, now) != now {
            let by = sample.limit.and_then(|limit| self.operator.limited_by(cell, limit));
            event(&by.unwrap_or_default(), RunEvent::Guided(now));
        }
        Ok(())
    }
}

fn pose_of(input: OperatorInput) -> Option<Pose> {
    if let OperatorInput::Pose(pose) = input { Some(pose) } else { None }
}

fn of_fixture(change: FixtureChange) -> RunEvent {
    match change {
        FixtureChange::On => RunEvent::On,
        FixtureChange::Off => RunEvent::Off,
        FixtureChange::Refused => RunEvent::Guided(GuidanceState::Refused),
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
        Some(ArmLimit::Tool(Limit::Entry)) => GuidanceState::AtEntry,
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
