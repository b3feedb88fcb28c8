//! A problem as a scene with a start and goals.

use std::collections::HashMap;
use std::path::PathBuf;

use elbowroom_formats::problem_set::{AxisConstraint, PlanningProblem, RequestedMotion};
use elbowroom_formats::srdf::Group;
use elbowroom_formats::suggest;
use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_planner::{PathConstraint, RrtConnect};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Object, Scene, SceneError, SceneState};
use elbowroom_spatial::Pose;

use super::frames::Frames;
use super::joint_values::{self, JointValues};
use super::matrix::skip_allowed;
use super::messages::{Notes, ProblemKey, Result};
use super::moved_link;
use crate::plan::KeptDirection;

/// The only robot.
pub(super) const ROBOT: RobotId = RobotId(0);

/// The robot alone, with the data that all problems of a file share.
#[derive(Debug)]
pub(super) struct BaseScene {
    /// Scene of the robot. Limits of joints that some problem holds beyond them are wider than in the model.
    pub scene: Scene,
    /// Position limits of the robot's joints in the model, rad or m.
    pub limits: Vec<(f64, f64)>,
    /// Groups of the robot's SRDF.
    pub groups: Vec<Group>,
    /// The file of the problems, for messages.
    pub problem_file: PathBuf,
}

/// How the robot moves to a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// On any path.
    Any,
    /// Straight in joint space.
    PointToPoint,
    /// Straight with this link.
    Linear(LinkId),
}

/// A problem as a scene: the robot among the objects, its start and goals. Coordinates are in the root link.
#[derive(Debug, Clone)]
pub struct ProblemScene {
    pub(super) scene: Scene,
    pub(super) start: SceneState,
    pub(super) goals: Vec<Vec<f64>>,
    limits: Vec<(f64, f64)>,
    pub(super) planned: Vec<bool>,
    /// Directions that axes of links keep, in the root link.
    kept: Vec<KeptDirection>,
    pub(super) motion: Motion,
}

impl ProblemScene {
    /// The only robot and the objects, with the pairs that may touch.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The start, with attached objects.
    pub fn start(&self) -> &SceneState {
        &self.start
    }

    /// Alternative goals: all values of the robot, rad or m.
    pub fn goals(&self) -> &[Vec<f64>] {
        &self.goals
    }

    /// Lowest and highest value of each joint, rad or m; equal for a joint that is held at its start.
    pub fn limits(&self) -> &[(f64, f64)] {
        &self.limits
    }

    /// A planner that holds the joints that the goals do not name.
    pub(super) fn planner(&self) -> std::result::Result<RrtConnect<'_>, SceneError> {
        let planner = RrtConnect::new(&self.scene, ROBOT)?.with_limits(self.limits.iter().copied());
        Ok(if self.kept.is_empty() { planner } else { planner.with_constraint(self.constraints()) })
    }

    /// The constraints on its paths.
    pub(super) fn constraints(&self) -> Vec<Box<dyn PathConstraint>> {
        let constraint =
            |kept: &KeptDirection| Box::new(kept.constraint(&self.scene, ROBOT)) as Box<dyn PathConstraint>;
        self.kept.iter().map(constraint).collect()
    }
}

/// Builds the scene of a problem.
pub(super) fn build(base: &BaseScene, problem: &PlanningProblem, notes: &mut Notes) -> Result<ProblemScene> {
    let key = ProblemKey::new(&base.problem_file, problem);
    let refused = |e: SceneError| key.error(e).hint("objects with names, shapes and poses of their own");
    let chain = &base.scene.robots()[0].robot.chain;
    let values = joint_values::of_problem(chain, &base.limits, key, problem, notes)?;
    let frames = Frames::new(key, problem, chain, &values.start);
    let SceneObjects { objects, ids } = scene_objects(problem, &frames)?;
    let scene = base.scene.with_objects(objects).map_err(refused)?;
    let matrix = skip_allowed(&scene, &problem.matrix, &ids);
    let scene = scene.with_allowed_collision_matrix(matrix).map_err(|e| key.error(e))?;
    let mut start = SceneState::new(&scene);
    start.set_q(&scene, ROBOT, &values.start).map_err(refused)?;
    attach(problem, key, &scene, &ids, &mut start)?;
    let kept = problem.kept.iter().map(|kept| direction(kept, key, chain, &frames)).collect::<Result<_>>()?;
    let motion = match problem.motion {
        RequestedMotion::Any => Motion::Any,
        RequestedMotion::PointToPoint => Motion::PointToPoint,
        RequestedMotion::Linear => {
            Motion::Linear(moved_link::of_group(chain, &base.groups, key, &problem.group, &values.planned)?)
        }
    };
    let JointValues { goals, planned, limits, .. } = values;
    Ok(ProblemScene { scene, start, goals, limits, planned, kept, motion })
}

fn direction(kept: &AxisConstraint, key: ProblemKey<'_>, chain: &Chain, frames: &Frames<'_>) -> Result<KeptDirection> {
    let in_root = frames.in_root(&kept.frame)?.rotation * kept.direction;
    Ok(KeptDirection::new(link(chain, &kept.link, key)?, kept.axis_in_link, in_root, kept.tolerance_rad))
}

fn link(chain: &Chain, name: &str, key: ProblemKey<'_>) -> Result<LinkId> {
    let names = chain.links().iter().map(String::as_str);
    let unknown = || key.error(format!("there is no link `{name}`")).hint(suggest::hint(name, names));
    chain.link(name).ok_or_else(unknown)
}

/// One object of the scene per solid.
struct SceneObjects<'p> {
    objects: Vec<Object>,
    /// The solids of each object of the problem.
    ids: HashMap<&'p str, Vec<ObjectId>>,
}

fn scene_objects<'p>(problem: &'p PlanningProblem, frames: &Frames<'_>) -> Result<SceneObjects<'p>> {
    let mut objects = Vec::new();
    let mut ids: HashMap<&str, Vec<ObjectId>> = HashMap::new();
    let all = problem.objects.iter().chain(problem.attached.iter().map(|a| &a.object));
    for object in all {
        let in_root = frames.in_root(&object.frame)?;
        for (name, shape, in_frame) in object.named_solids() {
            ids.entry(&object.id).or_default().push(ObjectId(objects.len()));
            objects.push(Object { name, shape: shape.clone(), in_world: in_root * *in_frame });
        }
    }
    Ok(SceneObjects { objects, ids })
}

/// Attaches the objects that the robot holds.
fn attach(
    problem: &PlanningProblem,
    key: ProblemKey<'_>,
    scene: &Scene,
    ids: &HashMap<&str, Vec<ObjectId>>,
    state: &mut SceneState,
) -> Result<()> {
    let chain = &scene.robots()[0].robot.chain;
    for attached in &problem.attached {
        let carrier = link(chain, &attached.link, key)?;
        let touch = attached.touch_links.iter().map(|name| link(chain, name, key)).collect::<Result<Vec<_>>>()?;
        let mut chain_state = elbowroom_kinematics::ChainState::new(chain);
        chain_state.q.copy_from_slice(state.q(ROBOT));
        chain.forward(&mut chain_state);
        let link_in_root: Pose = chain_state.link_in_root(carrier);
        for &id in ids.get(attached.object.id.as_str()).into_iter().flatten() {
            let in_link = link_in_root.inverse_mul(&scene.objects()[id.0].in_world);
            let attachment = Attachment {
                robot: ROBOT,
                link: carrier,
                in_link,
                touch_links: touch.clone(),
                visiting_links: Vec::new(),
            };
            state.attach_at(scene, id, attachment).map_err(|e| key.error(e))?;
        }
    }
    Ok(())
}
