//! The robot of a set of problems, prepared once.

use std::path::Path;

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_formats::Diagnostic;
use elbowroom_formats::problem_set::PlanningProblem;
use elbowroom_formats::srdf::Group;
use elbowroom_kinematics::Chain;
use elbowroom_robot::Robot;
use elbowroom_scene::Scene;

use super::joint_values::{self, JointValues};
use super::messages::{Notes, ProblemKey, Result};
use super::problem_scene::{self, BaseScene, ProblemScene};

/// The robot of a set of problems, with the data that all problems share. Its root link is the world frame.
#[derive(Debug)]
pub struct ProblemModel {
    base: BaseScene,
    /// Names of the joints in the order of `q`.
    pub joints: Vec<String>,
    /// Planned joints without a largest speed, whose paths cannot be timed.
    pub joints_without_speed: Vec<String>,
    /// Warnings for the user, each once.
    pub warnings: Vec<Diagnostic>,
}

impl ProblemModel {
    /// Prepares a robot for problems; `groups` of its SRDF name the links that linear motions move. All problems are checked, so that none is refused after others have been solved.
    ///
    /// A joint that a problem does not plan stays at its start, even beyond its limits, such as the fingers of a gripper in
    /// a model with other fingers.
    ///
    /// # Errors
    /// A goal that names no joint of the robot, an object in an unknown frame or attached to an unknown link,
    /// a linear motion of an unknown group or of joints that do not move its link, and anything that a scene refuses.
    pub fn new(
        urdf: &Path,
        mut robot: Robot,
        groups: &[Group],
        problem_file: &Path,
        problems: &[PlanningProblem],
    ) -> Result<Self> {
        let limits: Vec<(f64, f64)> = robot.chain.lower().into_iter().zip(robot.chain.upper()).collect();
        let mut notes = Notes::default();
        let mut values = Vec::new();
        for problem in problems {
            let key = ProblemKey::new(problem_file, problem);
            let of_problem = joint_values::of_problem(&robot.chain, &limits, key, problem, &mut notes)?;
            report_beyond_limits(&robot.chain, key, &of_problem, &mut notes);
            values.push(of_problem);
        }
        let joints: Vec<_> = active_names(&robot.chain);
        let joints_without_speed = without_speed(&robot.chain, &values);
        robot.chain = widened(&robot.chain, &values).map_err(|e| Diagnostic::new(urdf, None, e))?;
        let query_model = QueryModel::of_robot(urdf, robot);
        notes.warnings.extend(query_model.touching_at_rest());
        let scene = query_model.scene(OutOfReachProofs::Compute)?;
        let problem_file = problem_file.to_owned();
        let base = BaseScene { scene, limits, groups: groups.to_vec(), problem_file };
        for problem in problems {
            problem_scene::build(&base, problem, &mut notes)?;
        }
        Ok(Self { base, joints, joints_without_speed, warnings: notes.warnings })
    }

    /// The robot alone, for data that a planner prepares once.
    ///
    /// Limits of joints that some problem holds beyond them are wider than in the model; [`ProblemScene::limits`] has
    /// the limits of one problem.
    pub fn scene(&self) -> &Scene {
        &self.base.scene
    }

    /// The scene of a problem, with its start and goals.
    ///
    /// # Errors
    /// As for [`Self::new`], for problems that were not checked there.
    pub fn problem_scene(&self, problem: &PlanningProblem) -> Result<ProblemScene> {
        problem_scene::build(&self.base, problem, &mut Notes::default())
    }
}

fn active_names(chain: &Chain) -> Vec<String> {
    chain.active_joints().iter().map(|id| chain.joints()[id.0].name.clone()).collect()
}

/// Planned joints without a largest speed.
fn without_speed(chain: &Chain, values: &[JointValues]) -> Vec<String> {
    let is_planned = |i: usize| values.iter().any(|v| v.planned[i]);
    let joints = chain.active_joints().iter().enumerate().filter(|(i, _)| is_planned(*i));
    let unknown = joints.map(|(_, id)| &chain.joints()[id.0]).filter(|j| {
        let known = j.limits.velocity.is_some_and(|v| v > 0.0 && v.is_finite());
        !known
    });
    unknown.map(|j| j.name.clone()).collect()
}

/// The chain with limits that include those of every problem.
fn widened(chain: &Chain, values: &[JointValues]) -> std::result::Result<Chain, elbowroom_kinematics::ChainError> {
    let mut joints = chain.joints().to_vec();
    for (i, id) in chain.active_joints().iter().enumerate() {
        let limits = &mut joints[id.0].limits;
        for (lower, upper) in values.iter().map(|v| v.limits[i]) {
            limits.lower = limits.lower.min(lower);
            limits.upper = limits.upper.max(upper);
        }
    }
    Chain::new(chain.name(), chain.links().to_vec(), joints)
}

/// Warns of joints that are held beyond their limits.
fn report_beyond_limits(chain: &Chain, key: ProblemKey<'_>, values: &JointValues, notes: &mut Notes) {
    for (i, id) in chain.active_joints().iter().enumerate() {
        let (joint, value) = (&chain.joints()[id.0], values.start[i]);
        if !values.planned[i] && !joint.limits.contains(value, 0.0) {
            let (name, lower, upper) = (&joint.name, joint.limits.lower, joint.limits.upper);
            notes.once(key, &format!("`{name}` is held at {value}, beyond its limits {lower} to {upper}"));
        }
    }
}
