//! A whole arm that a person guides: the tool navigates, the arm follows, and every motion of it is proven.

use elbowroom_kinematics::inverse::IkSolver;
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneError, SceneState, SweepMove, SweepOptions};
use elbowroom_spatial::Pose;

use crate::{Limit, NavigationStep, NavigatorError, SurfaceNavigator};

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

    /// Moves the tool point for `dt_s` seconds towards the desired pose, and the arm with it, with the velocity scaled by
    /// an override, 0 to 1.
    pub fn step(&mut self, desired: &Pose, dt_s: f64, speed_override: f64) -> GuidedStep {
        let (mut limit, mut gap_m) = (None, None);
        let mut share = speed_override;
        for _ in 0..=HALVINGS {
            let tool = self.navigator.step_at_override(desired, dt_s, share);
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
    /// arm cannot.
    pub fn intent(&mut self, desired: &Pose, dt_s: f64, velocities: &mut [f64]) {
        let tool_in_world = self.navigator.step(desired, dt_s).tool_in_world;
        self.navigator.undo();
        let is_reached = self.solve(&tool_in_world);
        let q = self.state.q(self.robot);
        for ((velocity, to), from) in velocities.iter_mut().zip(&self.next).zip(q) {
            *velocity = if is_reached { (to - from) / dt_s } else { 0.0 };
        }
    }

    /// Moves the joints so that the tool is there, if the whole motion is free.
    fn follow(&mut self, tool_in_world: &Pose, dt_s: f64) -> Result<(), ArmLimit> {
        if !self.solve(tool_in_world) {
            return Err(ArmLimit::Reach);
        }
        let Self { checker, state, robot, next, joint_speeds, .. } = self;
        let too_fast = |(j, (to, from)): (usize, (&f64, &f64))| {
            let largest = joint_speeds.get(j).copied().unwrap_or(0.0) * dt_s;
            ((to - from).abs() > largest * (1.0 + 1e-9)).then_some(j)
        };
        if let Some(joint) = next.iter().zip(state.q(*robot)).enumerate().find_map(too_fast) {
            return Err(ArmLimit::JointSpeed(joint));
        }
        let moves = [SweepMove::Robot { robot: *robot, to: next }];
        let options = SweepOptions { tolerance_m: 1e-5, ..SweepOptions::default() };
        match checker.sweep(state, &moves, &options) {
            Ok(None) => {}
            Ok(Some(hit)) => return Err(ArmLimit::Contact(hit.a, hit.b)),
            Err(_) => return Err(ArmLimit::Unproven),
        }
        state.set_q(self.scene, *robot, next).map_err(|_| ArmLimit::Unproven)
    }

    /// Finds the joint values near the present ones that hold the tool there.
    fn solve(&mut self, tool_in_world: &Pose) -> bool {
        self.next.copy_from_slice(self.state.q(self.robot));
        let tool_in_root = self.scene.robots()[self.robot.0].base_in_world.inverse_mul(tool_in_world);
        self.solver.refine(&tool_in_root, &mut self.next)
    }
}
