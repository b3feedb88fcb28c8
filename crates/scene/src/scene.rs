//! The constant part: robots, objects, their models and pairs.

use std::collections::HashMap;

use elbowroom_kinematics::LinkId;
use elbowroom_spatial::Pose;

use crate::model::Model;
use crate::{Member, Object, PairMatrix, Robot, SceneBuilder};

/// A robot with a name and a place.
#[derive(Debug, Clone)]
pub struct SceneRobot {
    /// Unique in the scene.
    pub name: String,
    /// Links, joints, solids.
    pub robot: Robot,
    /// Where its root link stands.
    pub base_in_world: Pose,
}

/// Robots and objects in one world (the *Scenario* of S3), constant: any number of threads may share one.
///
/// What moves is in a [`SceneState`](crate::SceneState), questions are asked of a [`Checker`](crate::Checker).
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_scene::{Object, Scene};
/// use elbowroom_spatial::{Pose, Vec3};
/// let mut builder = Scene::builder();
/// let ball = |x: f64| Object {
///     name: format!("ball at {x}"),
///     shape: Shape::Sphere(Sphere { radius: 0.1 }),
///     in_world: Pose::from_translation(Vec3::X * x),
/// };
/// builder.object(ball(0.0));
/// builder.object(ball(1.0));
/// let scene = builder.build()?;
/// assert!(scene.member("ball at 1").is_some() && scene.pairs().entries().is_empty());
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) robots: Vec<SceneRobot>,
    pub(crate) objects: Vec<Object>,
    /// Members with solids, in their order: links of the first robot, …, objects.
    pub(crate) models: Vec<Model>,
    /// Per robot and link, its model where it has one.
    pub(crate) link_model: Vec<Vec<Option<usize>>>,
    /// Model of the first object; the others follow.
    pub(crate) first_object: usize,
    pub(crate) names: HashMap<String, Member>,
    /// What is in use.
    pub(crate) pairs: PairMatrix,
    /// What the models alone say, before edits.
    pub(crate) model_pairs: PairMatrix,
}

impl Scene {
    /// An empty scene to fill.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }

    /// The robots, in the order in which they came.
    pub fn robots(&self) -> &[SceneRobot] {
        &self.robots
    }

    /// The objects, in the order in which they came, where they stood then.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The pair matrix in use.
    pub fn pairs(&self) -> &PairMatrix {
        &self.pairs
    }

    /// The same scene with another pair matrix, made from [`Scene::pairs`] or read by
    /// [`PairMatrix::from_text`].
    ///
    /// # Errors
    /// [`MatrixError::NoSuchPair`](crate::MatrixError::NoSuchPair) where the matrix is one of another scene.
    pub fn with_pairs(mut self, pairs: PairMatrix) -> Result<Self, crate::MatrixError> {
        let (ours, theirs) = (self.model_pairs.entries(), pairs.entries());
        let stranger = |m: Member| match m {
            Member::Link { robot, link } => format!("link {} of robot {robot}", link.0),
            Member::Object(o) => format!("object {o}"),
        };
        let differs = ours.iter().zip(theirs).find(|(x, y)| (x.a, x.b) != (y.a, y.b)).map(|(_, y)| y);
        let extra = theirs.get(ours.len()).or(if ours.len() > theirs.len() { ours.get(theirs.len()) } else { None });
        if let Some(e) = differs.or(extra) {
            return Err(crate::MatrixError::NoSuchPair { a: stranger(e.a), b: stranger(e.b) });
        }
        self.pairs = pairs;
        Ok(self)
    }

    /// `robot/link`, or the object's name. Members that the scene does not have are described by their index.
    pub fn name(&self, member: Member) -> String {
        match member {
            Member::Link { robot, link } => self
                .robots
                .get(robot)
                .and_then(|r| Some(format!("{}/{}", r.name, r.robot.chain.links().get(link.0)?)))
                .unwrap_or_else(|| format!("robot {robot}, link {}", link.0)),
            Member::Object(o) => self.objects.get(o).map_or_else(|| format!("object {o}"), |o| o.name.clone()),
        }
    }

    /// The member of that name: `robot/link`, or an object's name.
    pub fn member(&self, name: &str) -> Option<Member> {
        self.names.get(name).copied()
    }

    /// The robot of that name.
    pub fn robot(&self, name: &str) -> Option<usize> {
        self.robots.iter().position(|r| r.name == name)
    }

    /// All members that have a solid, in the scene's order.
    pub fn members(&self) -> impl Iterator<Item = Member> + '_ {
        self.models.iter().map(|m| m.member)
    }

    /// True where the member has a solid.
    pub fn solid(&self, member: Member) -> bool {
        self.model_of(member).is_some()
    }

    pub(crate) fn model_pairs(&self) -> &PairMatrix {
        &self.model_pairs
    }

    pub(crate) fn model_of(&self, member: Member) -> Option<usize> {
        match member {
            Member::Link { robot, link } => self.link_model.get(robot)?.get(link.0).copied().flatten(),
            Member::Object(o) => (o < self.objects.len()).then_some(self.first_object + o),
        }
    }

    /// True where all joint values are. Only what holds for sure may be taken for within the limits.
    pub(crate) fn within_limits(&self, robot: usize, q: &[f64]) -> bool {
        let chain = &self.robots[robot].robot.chain;
        let within = |(i, q): (usize, &f64)| {
            let l = chain.joints()[chain.active_joints()[i].0].limits;
            *q >= l.lower && *q <= l.upper
        };
        q.iter().enumerate().all(within)
    }

    pub(crate) fn link_name(&self, robot: usize, link: LinkId) -> String {
        self.name(Member::Link { robot, link })
    }
}
