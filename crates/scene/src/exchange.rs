//! The same robots among other objects.

use elbowroom_spatial::Pose;

use crate::builder::names;
use crate::model::{Model, Solid};
use crate::{Member, Object, Scene, SceneError, matrix};

impl Scene {
    /// The same robots among other objects, as a camera sees them anew in each frame: what was made for the links is kept,
    /// their paddings and all that is known of pairs of links too. Pairs with objects are those by rule; none of them is
    /// proven to be out of reach. Answers are those of a scene that was built so.
    ///
    /// ```
    /// use elbowroom_proximity::{Shape, Sphere};
    /// use elbowroom_scene::{Checker, Object, Options, SceneState, example};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// let scene = example::two_arms();
    /// let ball = |x: f64| Object {
    ///     name: "ball".into(),
    ///     shape: Shape::Sphere(Sphere { radius: 0.1 }),
    ///     in_world: Pose::from_translation(Vec3::new(x, 0.0, 0.5)),
    /// };
    /// let hit = |x| {
    ///     let scene = scene.with_objects(vec![ball(x)]).unwrap();
    ///     Checker::new(&scene, Options::default()).collides(&SceneState::new(&scene)).is_some()
    /// };
    /// assert!(hit(0.0) && !hit(0.6));
    /// ```
    ///
    /// # Errors
    /// An object that cannot be, or two of one name.
    pub fn with_objects(&self, objects: Vec<Object>) -> Result<Self, SceneError> {
        let names = names(&self.robots, &objects)?;
        let mut models = self.models[..self.first_object].to_vec();
        for (i, o) in objects.iter().enumerate() {
            if !o.in_world.is_finite() {
                return Err(SceneError::PoseNotFinite(format!("`{}`", o.name)));
            }
            o.shape.validate().map_err(|source| SceneError::Shape { member: o.name.clone(), source })?;
            models.push(Model::new(Member::Object(i), vec![Solid::new(o.shape.clone(), Pose::IDENTITY)], 0.0));
        }
        let members: Vec<Member> = models.iter().map(|m| m.member).collect();
        let padding = |member| models.iter().find(|m| m.member == member).map_or(0.0, |m| m.padding_m);
        let by_law = || matrix::by_law(&self.robots, &objects, &members, &padding);
        let [mut model_pairs, mut pairs] = [by_law(), by_law()];
        for (new, old) in [(&mut model_pairs, &self.model_pairs), (&mut pairs, &self.pairs)] {
            for entry in new.entries_mut() {
                if let (Member::Link { .. }, Member::Link { .. }) = (entry.a, entry.b)
                    && let Some(known) = old.get(entry.a, entry.b)
                {
                    entry.clone_from(known);
                }
            }
        }
        Ok(Self {
            robots: self.robots.clone(),
            objects,
            models,
            link_model: self.link_model.clone(),
            first_object: self.first_object,
            names,
            pairs,
            model_pairs,
        })
    }
}
