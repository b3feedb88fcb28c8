//! A whole arm that a person guides: the tool navigates, the arm follows, and every motion of it is proven.

use elbowroom_kinematics::inverse::IkSolver;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneError, SceneState, SweepMove, SweepOptions};
use elbowroom_spatial::Pose;

use crate::force::{ArmForces, ArmPlace};
use crate::{Guide, Limit, NavigationStep, NavigatorError, SurfaceNavigator};

/// Override below which a virtual mass has no velocity: it turns back as soon as the hand does.
const LEAST_OVERRIDE: f64 = 0.02;
/// How often a step that the arm cannot follow is halved.
const HALVINGS: usize = 4;

/// What kept a guided arm from following.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ArmLimit {
    /// The tool: see there.
    Tool(Limit),
    /// No joint values within the limits near the present ones hold the tool there: the end of the reach, a limit of a
    /// joint, or a singularity.
    Reach,
    /// A joint would have to be faster than it can; the index of the joint.
    JointSpeed(usize),
    /// Two parts would touch.
    Contact(GeometryId, GeometryId),
    /// The motion could not be proven.
    Unproven,
    /// Fields push the tool back with all the energy that there is.
    Energy,
}

/// What one step of a guided arm did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GuidedStep {
    /// The step of the tool; the tool stands where the arm could not follow.
    pub tool: NavigationStep,
    /// What kept it from following; `None` if it followed.
    pub limit: Option<ArmLimit>,
}

/// An arm whose tool a [`SurfaceNavigator`] moves.
///
/// The tool keeps its gap from the protected surfaces. The rest of the arm, and the tool against everything that is not
/// protected, never touches anything in the scene: each motion of the joints is swept before it is executed. If the arm
/// cannot follow, the step is shortened on its path, never bent.
#[derive(Debug)]
pub struct GuidedArm<'s> {
    navigator: SurfaceNavigator,
    scene: &'s Scene,
    robot: RobotId,
    checker: Checker<'s>,
    state: SceneState,
    solver: IkSolver,
    /// Largest speed of each joint, rad/s or m/s.
    joint_speeds: Vec<f64>,
    next: Vec<f64>,
    /// Joint values at the start of the step.
    before: Vec<f64>,
    /// Joint values between moving and turning.
    moved: Vec<f64>,
    guide: Option<Guide>,
    /// Whether the virtual mass was at rest at the start of the last step, because of the override.
    is_halted: bool,
    forces: Option<Box<ArmForces<'s>>>,
}

impl<'s> GuidedArm<'s> {
    /// An arm at the configuration that it has in `state`. `solver` and `navigator` are of its tool point, and the
    /// navigator's pose is the one at that configuration; `joint_speeds` are rad/s or m/s.
    ///
    /// In the scene, pairs of the tool and what a navigator protects may be skipped.
    ///
    /// # Errors
    /// [`NavigatorError::NotAtTool`] if the navigator's pose is not that of the arm.
    pub fn new(
        navigator: SurfaceNavigator,
        solver: IkSolver,
        (scene, robot): (&'s Scene, RobotId),
        state: SceneState,
        joint_speeds: Vec<f64>,
    ) -> Result<Self, NavigatorError> {
        let mut arm = Self {
            navigator,
            scene,
            robot,
            checker: Checker::new(scene, CheckerOptions::default()),
            next: state.q(robot).to_vec(),
            before: state.q(robot).to_vec(),
            moved: state.q(robot).to_vec(),
            guide: None,
            is_halted: false,
            forces: None,
            state,
            solver,
            joint_speeds,
        };
        let there = arm.solve(&arm.navigator.tool_in_world());
        let moved = arm.next.iter().zip(arm.state.q(robot)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if there && moved < 1e-6 { Ok(arm) } else { Err(NavigatorError::NotAtTool) }
    }

    /// Joint values, rad or m.
    pub fn q(&self) -> &[f64] {
        self.state.q(self.robot)
    }

    /// Pose of the tool point in the world.
    pub fn tool_in_world(&self) -> Pose {
        self.navigator.tool_in_world()
    }

    /// Moves the other robots and the objects of the scene: what they are when the next step is proven.
    ///
    /// # Errors
    /// The error of `change`.
    pub fn surroundings(
        &mut self,
        change: impl FnOnce(&Scene, &mut SceneState) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        change(self.scene, &mut self.state)
    }

    /// Switches what the tool keeps off: see [`SurfaceNavigator::switch`].
    ///
    /// # Errors
    /// [`NavigatorError::TooNear`]; nothing is switched then.
    pub fn switch(&mut self, is_on: impl Fn(usize) -> bool) -> Result<(), NavigatorError> {
        self.navigator.switch(is_on)
    }

    /// Keeps the hand within a guide from the next step on; `None` lets it move freely.
    pub fn set_guide(&mut self, guide: Option<Guide>) {
        self.navigator.set_remote_center(guide.as_ref().and_then(Guide::remote_center).copied());
        self.guide = guide;
    }

    /// Lets the tool answer to forces from the next step on.
    pub fn set_forces(&mut self, forces: ArmForces<'s>) {
        self.forces = Some(Box::new(forces));
    }

    /// The forces, if the tool answers to them.
    pub fn forces(&self) -> Option<&ArmForces<'s>> {
        self.forces.as_deref()
    }

    /// Moves the tool point for `dt_s` seconds towards the desired pose, and the arm with it, with the velocity scaled by
    /// an override, 0 to 1. Without a desired pose the tool slows down.
    pub fn step(&mut self, desired: Option<&Pose>, dt_s: f64, speed_override: f64) -> GuidedStep {
        let hand = desired.map(|d| d.translation);
        let is_usable = desired.is_none_or(|d| d.is_finite() && d.translation.length().is_finite());
        let desired = self.guided(desired);
        self.before.copy_from_slice(self.state.q(self.robot));
        let Some(mut forces) = self.forces.take() else {
            return self.step_after_hand(desired.as_ref(), dt_s, speed_override);
        };
        self.is_halted = !is_usable || speed_override < LEAST_OVERRIDE;
        if self.is_halted {
            forces.halt();
        }
        let step = if forces.is_admittance() && is_usable {
            self.step_by_forces(&mut forces, desired.as_ref(), dt_s, speed_override)
        } else {
            let step = self.step_after_hand(desired.as_ref(), dt_s, speed_override);
            forces.feel(self.place(), hand, step.tool.velocity, dt_s);
            step
        };
        self.forces = Some(forces);
        step
    }

    /// Moves the tool after the hand.
    fn step_after_hand(&mut self, desired: Option<&Pose>, dt_s: f64, speed_override: f64) -> GuidedStep {
        let desired = desired.copied().unwrap_or_else(|| self.navigator.tool_in_world());
        let (mut limit, mut gap_m) = (None, None);
        let mut share = speed_override;
        for _ in 0..=HALVINGS {
            let tool = self.navigator.step_at_override(&desired, dt_s, share);
            match self.follow(&tool.tool_in_world, dt_s) {
                Ok(()) => return GuidedStep { tool, limit: limit.or(tool.limit.map(ArmLimit::Tool)) },
                Err(why) => {
                    (limit, gap_m) = (Some(why), tool.gap_m);
                    self.navigator.undo();
                    share *= 0.5;
                }
            }
        }
        GuidedStep { tool: NavigationStep { gap_m, ..self.navigator.stand_still() }, limit }
    }

    /// Writes the joint velocities (rad/s or m/s) with which [`step`](Self::step) would follow, and moves nothing; 0 if the
    /// arm cannot. For a monitor, `desired` is the pose of the *next* step: that of the last one is where the tool is, if it
    /// keeps up with the hand.
    pub fn intent(&mut self, desired: Option<&Pose>, dt_s: f64, velocities: &mut [f64]) {
        let desired = self.guided(desired);
        let mut forces = self.forces.take();
        let tool_in_world = match &mut forces {
            Some(forces) if forces.is_admittance() && desired.is_some_and(|d| d.is_finite()) => {
                let hand = desired.map(|d| d.translation);
                let mut velocity = forces.wanted_velocity(&self.place(), hand, dt_s);
                if self.is_halted {
                    // In one step from rest the mass goes hardly anywhere; the question is where it would go.
                    let (s, at) = (*self.navigator.settings(), self.navigator.tool_in_world().translation);
                    let way_m = hand.map_or(0.0, |hand| hand.distance(at));
                    let speed = s.speed_m_s.min((2.0 * s.acceleration_m_s2 * way_m).sqrt());
                    velocity = velocity.try_normalize().map_or(velocity, |direction| direction * speed);
                }
                self.navigator.step_at_velocity(velocity, dt_s, 1.0).tool_in_world
            }
            _ => {
                let desired = desired.unwrap_or_else(|| self.navigator.tool_in_world());
                self.navigator.step(&desired, dt_s).tool_in_world
            }
        };
        self.forces = forces;
        self.navigator.undo();
        // An arm that stood was perhaps refused, and would be again: a monitor must not expect it to move.
        let stood = self.before == self.state.q(self.robot);
        let is_possible = (!stood || self.can_begin(&tool_in_world, dt_s)) && self.solve(&tool_in_world);
        let q = self.state.q(self.robot);
        for ((velocity, to), from) in velocities.iter_mut().zip(&self.next).zip(q) {
            *velocity = if is_possible { (to - from) / dt_s } else { 0.0 };
        }
    }

    /// True if the arm can take a step towards that pose of the tool, however short.
    fn can_begin(&mut self, tool_in_world: &Pose, dt_s: f64) -> bool {
        let from = self.navigator.tool_in_world();
        let shares = std::iter::successors(Some(1.0), |share| Some(0.5 * share));
        shares.take(HALVINGS + 1).any(|share| self.examine(&from.interpolate(tool_in_world, share), dt_s).is_ok())
    }

    /// The desired pose within the guide.
    fn guided(&mut self, desired: Option<&Pose>) -> Option<Pose> {
        let desired = *desired?;
        let tool = self.navigator.tool_in_world();
        match &mut self.guide {
            Some(guide) if desired.is_finite() => Some(guide.toward(&tool, &desired)),
            _ => Some(desired),
        }
    }

    fn place(&mut self) -> ArmPlace<'_> {
        ArmPlace { scene: self.scene, state: &self.state, robot: self.robot, navigator: &mut self.navigator }
    }

    /// Moves the tool as its virtual mass goes, then turns it as the hand does.
    fn step_by_forces(
        &mut self,
        forces: &mut ArmForces<'s>,
        desired: Option<&Pose>,
        dt_s: f64,
        speed_override: f64,
    ) -> GuidedStep {
        // Under an override, time goes by more slowly for the mass.
        let hand = desired.map(|d| d.translation);
        let scaled = if speed_override > 0.0 { speed_override.min(1.0) } else { 0.0 };
        let velocity = forces.begin(self.place(), hand, dt_s, scaled);
        let (mut limit, mut energy, mut gap_m) = (None, None, None);
        let mut share = scaled;
        for _ in 0..=HALVINGS {
            let mut tool = match desired {
                Some(_) => self.navigator.step_at_velocity(velocity, dt_s, share),
                // Nobody holds the tool: it does not coast.
                None => self.navigator.step_at_override(&self.navigator.tool_in_world(), dt_s, share),
            };
            match self.follow(&tool.tool_in_world, dt_s) {
                Ok(()) if scaled > 0.0 => {
                    if forces.end(self.place(), tool.velocity * (1.0 / scaled)) {
                        let turned = desired.map_or(Ok(()), |d| self.turn_by_hand(forces, d, dt_s, share));
                        tool.tool_in_world = self.navigator.tool_in_world();
                        let limit = limit.or(turned.err()).or(tool.limit.map(ArmLimit::Tool));
                        return GuidedStep { tool, limit };
                    }
                    self.go_back();
                    (energy, gap_m) = (Some(ArmLimit::Energy), tool.gap_m);
                }
                Ok(()) => break,
                Err(why) => (limit, gap_m) = (Some(why), tool.gap_m),
            }
            self.navigator.undo();
            share *= 0.5;
        }
        forces.stand();
        let limit = limit.or(energy);
        GuidedStep { tool: NavigationStep { gap_m, ..self.navigator.stand_still() }, limit }
    }

    /// Turns the tool, if the arm can follow and the fields let it.
    fn turn_by_hand(
        &mut self,
        forces: &mut ArmForces<'s>,
        desired: &Pose,
        dt_s: f64,
        share: f64,
    ) -> Result<(), ArmLimit> {
        self.moved.copy_from_slice(self.state.q(self.robot));
        if !self.navigator.turn(desired, dt_s, share) {
            return Ok(());
        }
        let tool_in_world = self.navigator.tool_in_world();
        let followed = self.follow(&tool_in_world, dt_s);
        if followed.is_ok() && forces.turned(self.place()) {
            return Ok(());
        }
        self.navigator.undo();
        // It was accepted before.
        let _ = self.state.set_q(self.scene, self.robot, &self.moved);
        followed
    }

    /// Takes the joints back to where they were at the start of the step.
    fn go_back(&mut self) {
        // They were accepted before.
        let _ = self.state.set_q(self.scene, self.robot, &self.before);
    }

    /// Moves the joints so that the tool is there, if the whole motion is free.
    fn follow(&mut self, tool_in_world: &Pose, dt_s: f64) -> Result<(), ArmLimit> {
        self.examine(tool_in_world, dt_s)?;
        self.state.set_q(self.scene, self.robot, &self.next).map_err(|_| ArmLimit::Unproven)
    }

    /// Finds the joint values with which the tool is there, if the whole motion is free.
    fn examine(&mut self, tool_in_world: &Pose, dt_s: f64) -> Result<(), ArmLimit> {
        if !self.solve(tool_in_world) {
            return Err(ArmLimit::Reach);
        }
        let Self { checker, state, robot, next, before, joint_speeds, .. } = self;
        let too_fast = |(j, (to, from)): (usize, (&f64, &f64))| {
            let largest = joint_speeds.get(j).copied().unwrap_or(0.0) * dt_s;
            ((to - from).abs() > largest * (1.0 + 1e-9)).then_some(j)
        };
        if let Some(joint) = next.iter().zip(before.iter()).enumerate().find_map(too_fast) {
            return Err(ArmLimit::JointSpeed(joint));
        }
        let moves = [SweepMove::Robot { robot: *robot, to: next }];
        let options = SweepOptions { tolerance_m: 1e-5, moving_only: true, ..SweepOptions::default() };
        match checker.sweep(state, &moves, &options) {
            Ok(None) => Ok(()),
            Ok(Some(hit)) => Err(ArmLimit::Contact(hit.a, hit.b)),
            Err(_) => Err(ArmLimit::Unproven),
        }
    }

    /// Finds the joint values near the present ones that hold the tool there.
    fn solve(&mut self, tool_in_world: &Pose) -> bool {
        self.next.copy_from_slice(self.state.q(self.robot));
        let tool_in_root = self.scene.robots()[self.robot.0].base_in_world.inverse_mul(tool_in_world);
        self.solver.refine(&tool_in_root, &mut self.next)
    }
}
