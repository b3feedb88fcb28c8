//! The robot of a set of problems, prepared once.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_formats::problem_set::PlanningProblem;
use elbowroom_formats::{FormatError, Warning};
use elbowroom_kinematics::Chain;
use elbowroom_robot::Robot;
use elbowroom_scene::Scene;

use super::joint_values::{self, JointValues};
use super::problem_scene::{self, ProblemScene};

pub(super) type Result<T> = std::result::Result<T, FormatError>;

/// Different warnings that are kept.
const MAX_WARNINGS: usize = 50;

/// The robot of a set of problems, with what is the same for all of them. Its root link is the world frame.
#[derive(Debug)]
pub struct ProblemModel {
    /// The robot alone.
    pub(super) scene: Scene,
    /// Position limits of the robot's joints, rad or m.
    pub(super) limits: Vec<(f64, f64)>,
    /// The file of the problems, for messages.
    pub(super) problem_file: PathBuf,
    /// Names of the joints in the order of `q`.
    pub joints: Vec<String>,
    /// Joints that a problem plans and that have no largest speed: their paths cannot be timed.
    pub joints_without_speed: Vec<String>,
    /// What the user should know; each warning once.
    pub warnings: Vec<Warning>,
}

impl ProblemModel {
    /// Prepares a robot for problems. All of them are checked, so that none is refused when others have been solved.
    ///
    /// A joint that a problem does not plan stays at its start, even beyond its limits, such as the fingers of a gripper in
    /// a model with other fingers.
    ///
    /// # Errors
    /// A goal that names no joint of the robot, an object in an unknown frame or attached to an unknown link, and what a
    /// scene refuses.
    pub fn new(urdf: &Path, mut robot: Robot, problem_file: &Path, problems: &[PlanningProblem]) -> Result<Self> {
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
        robot.chain = widened(&robot.chain, &values).map_err(|e| FormatError::new(urdf, None, e.to_string()))?;
        let query_model = QueryModel::of_robot(urdf, robot);
        notes.warnings.extend(query_model.touching_at_rest());
        let scene = query_model.scene(OutOfReachProofs::Compute)?;
        let problem_file = problem_file.to_owned();
        let mut model = Self { scene, limits, problem_file, joints, joints_without_speed, warnings: Vec::new() };
        for problem in problems {
            problem_scene::build(&model, problem, &mut notes)?;
        }
        model.warnings = notes.warnings;
        Ok(model)
    }

    /// The scene of a problem, with its start and goals.
    ///
    /// # Errors
    /// As [`Self::new`], for problems that were not checked there.
    pub fn problem_scene(&self, problem: &PlanningProblem) -> Result<ProblemScene> {
        problem_scene::build(self, problem, &mut Notes::default())
    }

    /// The robot's joints and links. Limits of joints that some problem holds beyond them are wider than in the model.
    pub(super) fn chain(&self) -> &Chain {
        &self.scene.robots()[0].robot.chain
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

/// A problem, for messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct ProblemKey<'a> {
    file: &'a Path,
    set: &'a str,
    id: &'a str,
}

impl<'a> ProblemKey<'a> {
    pub(super) fn new(file: &'a Path, problem: &'a PlanningProblem) -> Self {
        Self { file, set: &problem.set, id: &problem.id }
    }

    pub(super) fn error(self, what: impl std::fmt::Display) -> FormatError {
        FormatError::new(self.file, None, format!("set `{}`, problem `{}`: {what}", self.set, self.id))
    }
}

/// Warnings, each once: the problems of a file resemble each other.
#[derive(Debug, Default)]
pub(super) struct Notes {
    seen: HashSet<String>,
    pub warnings: Vec<Warning>,
}

impl Notes {
    /// Warns at the first problem.
    pub(super) fn once(&mut self, key: ProblemKey<'_>, what: &str) {
        if self.seen.len() < MAX_WARNINGS && self.seen.insert(what.to_owned()) {
            self.warnings.push(key.error(format!("{what} (reported once)")).into());
        }
    }
}
