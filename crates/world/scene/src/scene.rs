//! The constant part of a scene: robots, objects, their models and the allowed collision matrix.

use std::collections::HashMap;

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_spatial::{Obb, Pose};

use crate::geometry_model::GeometryModel;
use crate::{AllowedCollisionMatrix, MatrixError, Object};

/// A robot with a name and a base pose.
#[derive(Debug, Clone)]
pub struct SceneRobot {
    /// Name, unique in the scene.
    pub name: String,
    /// Chain, colliders and disabled pairs.
    pub robot: Robot,
    /// Pose of the robot's root link in the world.
    pub base_in_world: Pose,
}

/// Robots and objects in one world (the *Scenario* of Giralt et al.).
///
/// A scene is constant: any number of threads may share it. A [`SceneState`](crate::SceneState) holds the moving parts; a
/// [`Checker`](crate::Checker) answers queries.
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
/// assert!(scene.geometry("ball at 1").is_some() && scene.allowed_collision_matrix().entries().is_empty());
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    pub(crate) robots: Vec<SceneRobot>,
    pub(crate) objects: Vec<Object>,
    /// Models of the links and objects that have shapes, in this order: links of the first robot, …, objects.
    pub(crate) models: Vec<GeometryModel>,
    /// Per robot and link: the index of its model, if it has one.
    pub(crate) link_model: Vec<Vec<Option<usize>>>,
    /// Index of the model of the first object; the others follow.
    pub(crate) first_object: usize,
    pub(crate) names: HashMap<String, GeometryId>,
    /// The matrix in use.
    pub(crate) matrix: AllowedCollisionMatrix,
    /// The matrix as derived from the models, before edits.
    pub(crate) model_matrix: AllowedCollisionMatrix,
}

impl Scene {
    /// The robots, in the order in which they were added.
    pub fn robots(&self) -> &[SceneRobot] {
        &self.robots
    }

    /// The objects, in the order in which they were added, with their initial poses.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// The allowed collision matrix in use.
    pub fn allowed_collision_matrix(&self) -> &AllowedCollisionMatrix {
        &self.matrix
    }

    /// Returns this scene with another allowed collision matrix.
    ///
    /// The matrix is derived from [`Scene::allowed_collision_matrix`] or read by [`AllowedCollisionMatrix::from_text`].
    ///
    /// # Errors
    /// [`MatrixError::NoSuchPair`] if the matrix belongs to another scene.
    pub fn with_allowed_collision_matrix(mut self, matrix: AllowedCollisionMatrix) -> Result<Self, MatrixError> {
        let (ours, theirs) = (self.model_matrix.entries(), matrix.entries());
        let unknown_name = |id: GeometryId| match id {
            GeometryId::Link { robot, link } => format!("link {} of robot {}", link.0, robot.0),
            GeometryId::Object(o) => format!("object {}", o.0),
        };
        let differs = ours.iter().zip(theirs).find(|(x, y)| (x.a, x.b) != (y.a, y.b)).map(|(_, y)| y);
        let extra = theirs.get(ours.len()).or(if ours.len() > theirs.len() { ours.get(theirs.len()) } else { None });
        if let Some(e) = differs.or(extra) {
            return Err(MatrixError::NoSuchPair { a: unknown_name(e.a), b: unknown_name(e.b) });
        }
        self.matrix = matrix;
        Ok(self)
    }

    /// The name of a geometry: `robot/link`, or the object's name.
    ///
    /// An id that the scene does not have is described by its index.
    pub fn name(&self, id: GeometryId) -> String {
        match id {
            GeometryId::Link { robot, link } => self
                .robots
                .get(robot.0)
                .and_then(|r| Some(format!("{}/{}", r.name, r.robot.chain.links().get(link.0)?)))
                .unwrap_or_else(|| format!("robot {}, link {}", robot.0, link.0)),
            GeometryId::Object(o) => {
                self.objects.get(o.0).map_or_else(|| format!("object {}", o.0), |o| o.name.clone())
            }
        }
    }

    /// The link or object with this name: `robot/link`, or an object's name.
    pub fn geometry(&self, name: &str) -> Option<GeometryId> {
        self.names.get(name).copied()
    }

    /// The robot with this name.
    pub fn robot(&self, name: &str) -> Option<RobotId> {
        self.robots.iter().position(|r| r.name == name).map(RobotId)
    }

    /// All links and objects that have shapes, in the scene's order.
    pub fn geometries(&self) -> impl Iterator<Item = GeometryId> + '_ {
        self.models.iter().map(|m| m.id)
    }

    /// True if the link or object has a shape.
    pub fn has_shape(&self, id: GeometryId) -> bool {
        self.model_of(id).is_some()
    }

    /// The shapes of a link or object, each with its pose in the frame of the link or object.
    ///
    /// These are the shapes that are checked: scaled, if the scene scales them. Empty if the link or object has no shape.
    pub fn shapes(&self, id: GeometryId) -> impl Iterator<Item = (&Shape, Pose)> + '_ {
        let model = self.model_of(id).map(|m| &self.models[m]);
        model.into_iter().flat_map(|m| m.exact.iter().map(|s| (&s.shape, s.in_geometry)))
    }

    /// The oriented boxes that [`Level::boxes`](crate::Level::boxes) compares for a link or object, in its frame.
    ///
    /// Each triangle of a mesh, and each other shape as a whole, is inside one of the boxes of every depth. Empty if the
    /// link or object has no shape, or an unbounded one. The first call for a depth builds its boxes.
    ///
    /// ```
    /// use elbowroom_kinematics::LinkId;
    /// use elbowroom_robot::{GeometryId, RobotId};
    /// use elbowroom_scene::example;
    /// let scene = example::two_arms();
    /// let forearm = GeometryId::Link { robot: RobotId(0), link: LinkId(3) };
    /// // One capsule has one box at every depth.
    /// assert_eq!([0, 3].map(|depth| scene.boxes(forearm, depth).len()), [1, 1]);
    /// ```
    pub fn boxes(&self, id: GeometryId, depth: u8) -> Vec<Obb> {
        let model = self.model_of(id).map(|m| &self.models[m]).filter(|m| m.obb.is_some());
        model.into_iter().flat_map(|m| m.tree().at_depth(depth)).filter_map(|node| node.obb).collect()
    }

    /// Padding of a link or object, m; 0 if it has no shape.
    pub fn padding_m(&self, id: GeometryId) -> f64 {
        self.model_of(id).map_or(0.0, |m| self.models[m].padding_m)
    }

    pub(crate) fn model_of(&self, id: GeometryId) -> Option<usize> {
        match id {
            GeometryId::Link { robot, link } => self.link_model.get(robot.0)?.get(link.0).copied().flatten(),
            GeometryId::Object(o) => (o.0 < self.objects.len()).then(|| self.object_model(o)),
        }
    }

    /// Index of an object's model.
    pub(crate) fn object_model(&self, object: ObjectId) -> usize {
        self.first_object + object.0
    }

    /// True if all joint values are certainly within the limits; false for NaN.
    pub(crate) fn within_limits(&self, robot: RobotId, q: &[f64]) -> bool {
        let chain = &self.robots[robot.0].robot.chain;
        let within = |(i, q): (usize, &f64)| {
            let l = chain.joints()[chain.active_joints()[i].0].limits;
            *q >= l.lower && *q <= l.upper
        };
        q.iter().enumerate().all(within)
    }

    pub(crate) fn link_name(&self, robot: RobotId, link: LinkId) -> String {
        self.name(GeometryId::Link { robot, link })
    }
}
