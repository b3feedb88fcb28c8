//! Sets of planning problems in the layout of `MotionBenchMaker`: `{set: {id: {scene, request}}}`.
//!
//! Scenes and requests are in the form in which `MoveIt` writes its messages.
//!
//! | read | meaning |
//! | --- | --- |
//! | `scene.world.collision_objects` | boxes, spheres, cylinders, meshes with their vertices or files, planes; a cone becomes its cylinder |
//! | `scene.fixed_frame_transforms` | frames of the objects |
//! | `scene.allowed_collision_matrix` | pairs that may touch |
//! | `scene.robot_state`, `request.start_state` | joint values, pose of the base, attached objects; the latter overrides |
//! | `request.goal_constraints` | joint values; several are alternatives |
//! | `request.path_constraints` | orientation constraints that leave turns about one axis free |
//! | `request.pipeline_id`, `request.planner_id` | the motions `LIN` and `PTP` of `MoveIt`'s planner for industrial robots |
//! | `request.group_name` | the group whose tip a linear motion moves |
//!
//! Other content is ignored. Content that would make an answer wrong is refused: an octomap with data, goals that are
//! poses, other path constraints, and motions on circles (`CIRC`).

mod document;
mod goal;
mod motion;
mod path_constraint;
mod problem;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use elbowroom_spatial::Pose;
use serde_json::Value;

use crate::moveit_msgs::field::{Field, Location, Reading};
use crate::moveit_msgs::{collision_matrix, object, pose, robot_state};
use crate::{Diagnostic, input};
use document::{Entries, LAYOUT};

pub use crate::moveit_msgs::types::{AllowedCollisions, AttachedObject, CollisionObject, FixedFrame, JointValue};
pub use motion::RequestedMotion;
pub use path_constraint::AxisConstraint;
pub use problem::PlanningProblem;

/// Largest size of a file, bytes. A parsed document takes several times the memory of its text.
const MAX_BYTES: u64 = 256 << 20;

/// Largest size of a file, bytes, whose fields have lines in messages: the text is parsed again to find them.
const MAX_BYTES_WITH_LINES: usize = 16 << 20;

/// The problems of a file.
#[derive(Debug, Clone)]
pub struct ProblemFile {
    /// Path of the file, for messages.
    pub file: PathBuf,
    /// Problems in the order of the file.
    pub problems: Vec<PlanningProblem>,
    /// Warnings for the user, one per kind.
    pub warnings: Vec<Diagnostic>,
}

/// Reads a file of at most 256 MiB.
///
/// # Errors
/// The errors of [`parse`], or a file that cannot be read.
pub fn read(path: &Path) -> Result<ProblemFile, Diagnostic> {
    let smaller = "fewer problems per file: the sets can be in files of their own";
    parse(path, &input::read_file(path, MAX_BYTES, smaller)?)
}

/// Parses the content of a file of problems; `file` is named in messages.
///
/// ```
/// use elbowroom_formats::problem_set;
/// let text = br#"{"shelf": {"0001": {
///   "scene": {"world": {"collision_objects": [{"id": "board",
///     "primitives": [{"type": "box", "dimensions": [0.6, 0.3, 0.02]}],
///     "primitive_poses": [{"position": [0.7, 0, 0.4], "orientation": [0, 0, 0, 1]}]}]}},
///   "request": {
///     "start_state": {"joint_state": {"name": ["waist"], "position": [0.5]}},
///     "goal_constraints": [{"joint_constraints": [{"joint_name": "waist", "position": -0.5}]}]}}}}"#;
/// let file = problem_set::parse("shelf.json".as_ref(), text)?;
/// let problem = &file.problems[0];
/// assert_eq!((problem.set.as_str(), problem.objects[0].solids.len()), ("shelf", 1));
/// assert_eq!(problem.goals[0][0].value, -0.5);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] if the text is not JSON of this layout. The message has the line, or the set, problem and field.
pub fn parse(file: &Path, bytes: &[u8]) -> Result<ProblemFile, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text(bytes, file)?;
    let sets: Entries<Entries<Value>> = document::parse(&text, file)?;
    let mut reading = Reading::default();
    let mut problems = Vec::new();
    for (set, entries) in &sets.0 {
        for (id, value) in &entries.0 {
            // JSON is YAML, too.
            let yaml = (text.len() <= MAX_BYTES_WITH_LINES).then_some(&*text);
            let part = format!("set `{set}`, problem `{id}`: ");
            let location = Location { file, part, yaml, yaml_path: format!("{set}.{id}") };
            problems.push(problem([set, id], &Field::root(&location, value), &mut reading)?);
        }
    }
    if problems.is_empty() {
        return Err(Diagnostic::new(file, None, "has no planning problem").hint(LAYOUT));
    }
    Ok(ProblemFile { file: file.to_owned(), problems, warnings: reading.warnings })
}

fn problem([set, id]: [&str; 2], root: &Field<'_>, reading: &mut Reading) -> Result<PlanningProblem, Diagnostic> {
    let scene = root.require("scene", LAYOUT)?;
    let request = root.require("request", LAYOUT)?;
    let motion = motion::requested_motion(&request)?;
    let mut state = robot_state::RobotState::default();
    for at in [scene.get("robot_state")?, request.get("start_state")?].into_iter().flatten() {
        state.overlay(robot_state::parse(&at, reading)?);
    }
    let objects = object::world(&scene, reading)?;
    object::check_ids(root, &objects, &state.attached)?;
    Ok(PlanningProblem {
        set: set.to_owned(),
        id: id.to_owned(),
        frames: pose::fixed_frames(&scene)?,
        objects,
        attached: state.attached,
        matrix: collision_matrix::parse(&scene, reading)?,
        base_in_world: state.base_in_world.unwrap_or(Pose::IDENTITY),
        start: state.joints,
        goals: goal::goals(&request)?,
        kept: path_constraint::axis_constraints(&request)?,
        motion,
        group: request.text_of("group_name")?.to_owned(),
    })
}
