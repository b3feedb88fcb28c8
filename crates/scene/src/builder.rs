//! From robots and objects to a scene.

use std::collections::HashMap;

use elbowroom_kinematics::LinkId;
use elbowroom_spatial::Pose;

use crate::model::{Model, Solid};
use crate::{Edit, Member, Object, Robot, Scene, SceneError, SceneRobot, matrix, scale};

/// Collects what a scene is made of. Mistakes are told by [`SceneBuilder::build`].
///
/// ```
/// use elbowroom_kinematics::{Chain, LinkId};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_scene::{Body, Member, Robot, Scene};
/// use elbowroom_spatial::Pose;
/// let mut post = Robot::new(Chain::new("post", vec!["top".into()], vec![])?);
/// let shape = Shape::Sphere(Sphere { radius: 0.1 });
/// post.bodies[0].push(Body { name: "knob".into(), shape, in_link: Pose::IDENTITY });
/// let mut builder = Scene::builder();
/// let robot = builder.robot("left", post, Pose::IDENTITY);
/// let top = Member::Link { robot, link: LinkId(0) };
/// builder.padding(top, 0.02);
/// assert_eq!(builder.build()?.name(top), "left/top");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneBuilder {
    robots: Vec<SceneRobot>,
    objects: Vec<Object>,
    padding: HashMap<Member, f64>,
    scale: HashMap<Member, f64>,
    edits: Vec<(Member, Member, Edit)>,
    reach: bool,
}

impl Default for SceneBuilder {
    fn default() -> Self {
        Self {
            robots: Vec::new(),
            objects: Vec::new(),
            padding: HashMap::new(),
            scale: HashMap::new(),
            edits: Vec::new(),
            reach: true,
        }
    }
}

impl SceneBuilder {
    /// Adds a robot; its index.
    pub fn robot(&mut self, name: impl Into<String>, robot: Robot, base_in_world: Pose) -> usize {
        self.robots.push(SceneRobot { name: name.into(), robot, base_in_world });
        self.robots.len() - 1
    }

    /// Adds an object; its index.
    pub fn object(&mut self, object: Object) -> usize {
        self.objects.push(object);
        self.objects.len() - 1
    }

    /// Metres that everything must stay away from a member, links of the same robot included. Two paddings add up.
    pub fn padding(&mut self, member: Member, metres: f64) -> &mut Self {
        self.padding.insert(member, metres);
        self
    }

    /// Makes the bodies of a member larger or smaller, each about the centre of its bounding box. Planes stay.
    pub fn scale(&mut self, member: Member, factor: f64) -> &mut Self {
        self.scale.insert(member, factor);
        self
    }

    /// Changes the pair matrix, after everything else, in the order of the calls.
    pub fn edit(&mut self, a: Member, b: Member, edit: Edit) -> &mut Self {
        self.edits.push((a, b, edit));
        self
    }

    /// Whether pairs that no joint values bring together are looked for (default: yes). It takes some time, and saves
    /// some in each question; the answers are the same.
    pub fn reach(&mut self, prove: bool) -> &mut Self {
        self.reach = prove;
        self
    }

    /// Makes all models and the pair matrix.
    ///
    /// # Errors
    /// [`SceneError`], naming what is wrong.
    pub fn build(self) -> Result<Scene, SceneError> {
        let names = names(&self.robots, &self.objects)?;
        self.check()?;
        let mut models = Vec::new();
        let mut link_model = Vec::new();
        for (robot, r) in self.robots.iter().enumerate() {
            let mut of_link = Vec::new();
            for (l, bodies) in r.robot.bodies.iter().enumerate() {
                let solids: Vec<_> = bodies.iter().map(|b| Solid::new(b.shape.clone(), b.in_link)).collect();
                of_link.push((!solids.is_empty()).then_some(models.len()));
                if !solids.is_empty() {
                    models.push(self.model(&names, Member::Link { robot, link: LinkId(l) }, solids)?);
                }
            }
            link_model.push(of_link);
        }
        let first_object = models.len();
        for (i, o) in self.objects.iter().enumerate() {
            let solid = Solid::new(o.shape.clone(), Pose::IDENTITY);
            models.push(self.model(&names, Member::Object(i), vec![solid])?);
        }
        let members: Vec<Member> = models.iter().map(|m| m.member).collect();
        let padding = |m| self.padding.get(&m).copied().unwrap_or(0.0);
        let pairs = matrix::by_law(&self.robots, &self.objects, &members, &padding);
        let Self { robots, objects, edits, reach, .. } = self;
        let model_pairs = pairs.clone();
        let mut scene = Scene { robots, objects, models, link_model, first_object, names, pairs, model_pairs };
        if reach {
            scene.model_pairs = matrix::prove(&scene, scene.pairs.clone());
        }
        let mut pairs = scene.model_pairs.clone();
        for (a, b, edit) in edits {
            pairs.edit(&scene, a, b, edit)?;
        }
        scene.pairs = pairs;
        Ok(scene)
    }

    fn model(
        &self,
        names: &HashMap<String, Member>,
        member: Member,
        mut solids: Vec<Solid>,
    ) -> Result<Model, SceneError> {
        let name = || names.iter().find(|(_, m)| **m == member).map_or_else(String::new, |(n, _)| n.clone());
        for s in &solids {
            s.shape.validate().map_err(|source| SceneError::Shape { member: name(), source })?;
            if !s.in_member.is_finite() {
                return Err(SceneError::PoseNotFinite(name()));
            }
        }
        if let Some(&value) = self.scale.get(&member) {
            for s in &mut solids {
                *s = scale::scaled(s, value)
                    .map_err(|what| SceneError::ScaledShape { member: name(), what: what.to_string() })?;
            }
        }
        let padding = self.padding.get(&member).copied().unwrap_or(0.0);
        Ok(Model::new(member, solids, padding))
    }

    /// Everything that can be seen without making anything.
    fn check(&self) -> Result<(), SceneError> {
        for r in &self.robots {
            let (bodies, links) = (r.robot.bodies.len(), r.robot.chain.links().len());
            if bodies != links {
                return Err(SceneError::BodiesPerLink { robot: r.name.clone(), bodies, links });
            }
            if !r.base_in_world.is_finite() {
                return Err(SceneError::PoseNotFinite(format!("the base of `{}`", r.name)));
            }
        }
        if let Some(o) = self.objects.iter().find(|o| !o.in_world.is_finite()) {
            return Err(SceneError::PoseNotFinite(format!("`{}`", o.name)));
        }
        for (&member, &value) in &self.padding {
            let member = self.checked_name(member)?;
            if !(value >= 0.0 && value.is_finite()) {
                return Err(SceneError::Padding { member, value });
            }
        }
        for (&member, &value) in &self.scale {
            let member = self.checked_name(member)?;
            if !(value > 0.0 && value.is_finite()) {
                return Err(SceneError::Scale { member, value });
            }
        }
        Ok(())
    }

    fn checked_name(&self, member: Member) -> Result<String, SceneError> {
        match member {
            Member::Object(index) => {
                let object = self.objects.get(index);
                object.map(|o| o.name.clone()).ok_or(SceneError::NoSuchObject { index, count: self.objects.len() })
            }
            Member::Link { robot: index, link } => {
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

pub(crate) fn names(robots: &[SceneRobot], objects: &[Object]) -> Result<HashMap<String, Member>, SceneError> {
    let mut names = HashMap::new();
    let mut add = |name: String, member| match names.insert(name.clone(), member) {
        Some(_) => Err(SceneError::DuplicateName(name)),
        None => Ok(()),
    };
    for (i, r) in robots.iter().enumerate() {
        if robots[..i].iter().any(|other| other.name == r.name) {
            return Err(SceneError::DuplicateName(r.name.clone()));
        }
        for (l, link) in r.robot.chain.links().iter().enumerate() {
            add(format!("{}/{link}", r.name), Member::Link { robot: i, link: LinkId(l) })?;
        }
    }
    for (i, o) in objects.iter().enumerate() {
        add(o.name.clone(), Member::Object(i))?;
    }
    Ok(names)
}
