//! A scene with the same robots and other objects.

use elbowroom_robot::{GeometryId, ObjectId};
use elbowroom_spatial::Pose;

use crate::allowed_collision_matrix::by_rules;
use crate::builder::names;
use crate::geometry_model::GeometryModel;
use crate::local_shape::LocalShape;
use crate::{Object, Scene, SceneError};

impl Scene {
    /// Returns a scene with the same robots and other objects, such as the obstacles of a new camera frame.
    ///
    /// The models of the links, their paddings and the entries of pairs of links are kept. Pairs with objects get the
    /// entries of the pair rules, without out-of-reach proofs. The answers equal those of a scene built with these
    /// objects.
    ///
    /// ```
    /// use elbowroom_proximity::{Shape, Sphere};
    /// use elbowroom_scene::{Checker, CheckerOptions, Object, SceneState, example};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// let scene = example::two_arms();
    /// let ball = |x: f64| Object {
    ///     name: "ball".into(),
    ///     shape: Shape::Sphere(Sphere { radius: 0.1 }),
    ///     in_world: Pose::from_translation(Vec3::new(x, 0.0, 0.5)),
    /// };
    /// let hit = |x| {
    ///     let scene = scene.with_objects(vec![ball(x)]).unwrap();
    ///     Checker::new(&scene, CheckerOptions::default()).collides(&SceneState::new(&scene)).is_some()
    /// };
    /// assert!(hit(0.0) && !hit(0.6));
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if an object has an invalid shape or pose, or if two objects share a name.
    pub fn with_objects(&self, objects: Vec<Object>) -> Result<Self, SceneError> {
        let names = names(&self.robots, &objects)?;
        let mut models = self.models[..self.first_object].to_vec();
        for (i, o) in objects.iter().enumerate() {
            if !o.in_world.is_finite() {
                return Err(SceneError::PoseNotFinite(format!("`{}`", o.name)));
            }
            o.shape.validate().map_err(|source| SceneError::Shape { geometry: o.name.clone(), source })?;
            let shape = LocalShape::new(o.shape.clone(), Pose::IDENTITY);
            models.push(GeometryModel::new(GeometryId::Object(ObjectId(i)), vec![shape], 0.0));
        }
        let ids: Vec<GeometryId> = models.iter().map(|m| m.id).collect();
        let padding = |id| models.iter().find(|m| m.id == id).map_or(0.0, |m| m.padding_m);
        let rules = || by_rules(&self.robots, &objects, &ids, &padding);
        let [mut model_matrix, mut matrix] = [rules(), rules()];
        for (new, old) in [(&mut model_matrix, &self.model_matrix), (&mut matrix, &self.matrix)] {
            for entry in new.entries_mut() {
                if let (GeometryId::Link { .. }, GeometryId::Link { .. }) = (entry.a, entry.b)
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
            matrix,
            model_matrix,
        })
    }
}
