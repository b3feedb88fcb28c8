//! Builder of a scene from robots and objects.

use std::collections::HashMap;

use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, ObjectId, Robot, RobotId};
use elbowroom_spatial::Pose;

use crate::allowed_collision_matrix::{by_rules, prove_out_of_reach};
use crate::geometry_model::GeometryModel;
use crate::local_shape::LocalShape;
use crate::{Object, PairEdit, PairRules, Scene, SceneError, SceneRobot, scale};

/// Collects the robots, objects and settings of a scene. [`SceneBuilder::build`] reports the errors.
///
/// ```
/// use elbowroom_kinematics::{Chain, LinkId};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_robot::{Collider, GeometryId, Robot};
/// use elbowroom_scene::Scene;
/// use elbowroom_spatial::Pose;
/// let mut post = Robot::new(Chain::new("post", vec!["top".into()], vec![])?);
/// let shape = Shape::Sphere(Sphere { radius: 0.1 });
/// post.colliders[0].push(Collider { name: "knob".into(), shape, in_link: Pose::IDENTITY });
/// let mut builder = Scene::builder();
/// let robot = builder.robot("left", post, Pose::IDENTITY);
/// let top = GeometryId::Link { robot, link: LinkId(0) };
/// builder.padding(top, 0.02);
/// assert_eq!(builder.build()?.name(top), "left/top");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneBuilder {
    robots: Vec<SceneRobot>,
    objects: Vec<Object>,
    padding: HashMap<GeometryId, f64>,
    scale: HashMap<GeometryId, f64>,
    edits: Vec<(GeometryId, GeometryId, PairEdit)>,
    rules: PairRules,
    prove_out_of_reach: bool,
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self {
            robots: Vec::new(),
            objects: Vec::new(),
            padding: HashMap::new(),
            scale: HashMap::new(),
            edits: Vec::new(),
            rules: PairRules::default(),
            prove_out_of_reach: true,
        }
    }
}

impl Scene {
    /// Starts an empty scene.
    pub fn builder() -> SceneBuilder {
        SceneBuilder::default()
    }
}

impl SceneBuilder {
    /// Adds a robot; returns its id.
    pub fn robot(&mut self, name: impl Into<String>, robot: Robot, base_in_world: Pose) -> RobotId {
        self.robots.push(SceneRobot { name: name.into(), robot, base_in_world });
        RobotId(self.robots.len() - 1)
    }

    /// Adds an object; returns its id.
    pub fn object(&mut self, object: Object) -> ObjectId {
        self.objects.push(object);
        ObjectId(self.objects.len() - 1)
    }

    /// Sets the padding of a link or object: the distance (m) that all other geometry must keep from it.
    ///
    /// Other geometry includes links of the same robot.
    ///
    /// The paddings of the two geometries of a pair add up.
    pub fn padding(&mut self, id: GeometryId, metres: f64) -> &mut Self {
        self.padding.insert(id, metres);
        self
    }

    /// Scales the shapes of a link or object, each about the centre of its bounding box. Half-spaces are not scaled.
    pub fn scale(&mut self, id: GeometryId, factor: f64) -> &mut Self {
        self.scale.insert(id, factor);
        self
    }

    /// Edits one pair of the allowed collision matrix. Single edits apply last, in the order of the calls.
    pub fn edit(&mut self, a: GeometryId, b: GeometryId, edit: PairEdit) -> &mut Self {
        self.edits.push((a, b, edit));
        self
    }

    /// Edits the allowed collision matrix between selections. These edits apply before the edits of single pairs.
    pub fn rules(&mut self, rules: PairRules) -> &mut Self {
        self.rules.extend(rules);
        self
    }

    /// Sets whether to look for pairs that no joint values within the limits bring together (default: yes).
    ///
    /// The proof takes time once and makes each query faster; the answers are the same.
    pub fn prove_out_of_reach(&mut self, prove: bool) -> &mut Self {
        self.prove_out_of_reach = prove;
        self
    }

    /// Builds all models and the allowed collision matrix.
    ///
    /// # Errors
    /// [`SceneError`], which names the invalid input.
    pub fn build(self) -> Result<Scene, SceneError> {
        let names = names(&self.robots, &self.objects)?;
        self.check()?;
        let mut models = Vec::new();
        let mut link_model = Vec::new();
        for (robot, r) in self.robots.iter().enumerate() {
            let mut of_link = Vec::new();
            for (l, colliders) in r.robot.colliders.iter().enumerate() {
                let shapes: Vec<_> = colliders.iter().map(|c| LocalShape::new(c.shape.clone(), c.in_link)).collect();
                of_link.push((!shapes.is_empty()).then_some(models.len()));
                if !shapes.is_empty() {
                    let id = GeometryId::Link { robot: RobotId(robot), link: LinkId(l) };
                    models.push(self.model(&names, id, shapes)?);
                }
            }
            link_model.push(of_link);
        }
        let first_object = models.len();
        for (i, o) in self.objects.iter().enumerate() {
            let shape = LocalShape::new(o.shape.clone(), Pose::IDENTITY);
            models.push(self.model(&names, GeometryId::Object(ObjectId(i)), vec![shape])?);
        }
        let ids: Vec<GeometryId> = models.iter().map(|m| m.id).collect();
        let padding = |id| self.padding.get(&id).copied().unwrap_or(0.0);
        let matrix = by_rules(&self.robots, &self.objects, &ids, &padding);
        let Self { robots, objects, edits, rules, prove_out_of_reach: prove, .. } = self;
        let model_matrix = matrix.clone();
        let mut scene = Scene { robots, objects, models, link_model, first_object, names, matrix, model_matrix };
        if prove {
            scene.model_matrix = prove_out_of_reach(&scene, scene.matrix.clone());
        }
        scene.matrix = scene.model_matrix.clone();
        rules.edit_scene(&mut scene)?;
        let mut matrix = scene.matrix.clone();
        for (a, b, edit) in edits {
            matrix.edit(&scene, a, b, edit)?;
        }
        scene.matrix = matrix;
        Ok(scene)
    }

    fn model(
        &self,
        names: &HashMap<String, GeometryId>,
        id: GeometryId,
        mut shapes: Vec<LocalShape>,
    ) -> Result<GeometryModel, SceneError> {
        let name = || names.iter().find(|(_, i)| **i == id).map_or_else(String::new, |(n, _)| n.clone());
        for s in &shapes {
            s.shape.validate().map_err(|source| SceneError::Shape { geometry: name(), source })?;
            if !s.in_geometry.is_finite() {
                return Err(SceneError::PoseNotFinite(name()));
            }
        }
        if let Some(&value) = self.scale.get(&id) {
            for s in &mut shapes {
                *s = scale::scaled(s, value)
                    .map_err(|what| SceneError::ScaledShape { geometry: name(), what: what.to_string() })?;
            }
        }
        let padding = self.padding.get(&id).copied().unwrap_or(0.0);
        Ok(GeometryModel::new(id, shapes, padding))
    }

    /// Reports all errors that can be found without building a model.
    fn check(&self) -> Result<(), SceneError> {
        for r in &self.robots {
            let (colliders, links) = (r.robot.colliders.len(), r.robot.chain.links().len());
            if colliders != links {
                return Err(SceneError::CollidersPerLink { robot: r.name.clone(), colliders, links });
            }
            if !r.base_in_world.is_finite() {
                return Err(SceneError::PoseNotFinite(format!("the base of `{}`", r.name)));
            }
        }
        if let Some(o) = self.objects.iter().find(|o| !o.in_world.is_finite()) {
            return Err(SceneError::PoseNotFinite(format!("`{}`", o.name)));
        }
        for (&id, &value) in &self.padding {
            let geometry = self.checked_name(id)?;
            if !(value >= 0.0 && value.is_finite()) {
                return Err(SceneError::Padding { geometry, value });
            }
        }
        for (&id, &value) in &self.scale {
            let geometry = self.checked_name(id)?;
            if !(value > 0.0 && value.is_finite()) {
                return Err(SceneError::Scale { geometry, value });
            }
        }
        Ok(())
    }

    fn checked_name(&self, id: GeometryId) -> Result<String, SceneError> {
        match id {
            GeometryId::Object(ObjectId(index)) => {
                let object = self.objects.get(index);
                object.map(|o| o.name.clone()).ok_or(SceneError::NoSuchObject { index, count: self.objects.len() })
            }
            GeometryId::Link { robot: RobotId(index), link } => {
                let r = self.robots.get(index).ok_or(SceneError::NoSuchRobot { index, count: self.robots.len() })?;
                let links = r.robot.chain.links();
                let link_name = links.get(link.0).ok_or_else(|| SceneError::NoSuchLink {
                    robot: r.name.clone(),
                    index: link.0,
                    count: links.len(),
                })?;
                Ok(format!("{}/{link_name}", r.name))
            }
        }
    }
}

/// Geometry by name; an error if a name is used twice.
pub(crate) fn names(robots: &[SceneRobot], objects: &[Object]) -> Result<HashMap<String, GeometryId>, SceneError> {
    let mut names = HashMap::new();
    let mut add = |name: String, id| match names.insert(name.clone(), id) {
        Some(_) => Err(SceneError::DuplicateName(name)),
        None => Ok(()),
    };
    for (i, r) in robots.iter().enumerate() {
        if robots[..i].iter().any(|other| other.name == r.name) {
            return Err(SceneError::DuplicateName(r.name.clone()));
        }
        for (l, link) in r.robot.chain.links().iter().enumerate() {
            add(format!("{}/{link}", r.name), GeometryId::Link { robot: RobotId(i), link: LinkId(l) })?;
        }
    }
    for (i, o) in objects.iter().enumerate() {
        add(o.name.clone(), GeometryId::Object(ObjectId(i)))?;
    }
    Ok(names)
}
