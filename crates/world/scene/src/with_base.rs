//! A scene with a robot at another place.

use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_spatial::Pose;

use crate::allowed_collision_matrix::{PairState, Reason};
use crate::{Scene, SceneError};

impl Scene {
    /// Returns the scene with another pose of a robot's base, such as a place where it could be mounted.
    ///
    /// Models, weights and edits of pairs are kept. Pairs that were proven out of reach of each other are tested again if the
    /// robot's base has moved relative to the other geometry.
    ///
    /// ```
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{Checker, CheckerOptions, SceneState, example};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// let scene = example::two_arms();
    /// let other = scene.robots()[1].base_in_world;
    /// let hit = |base| {
    ///     let scene = scene.with_base(RobotId(0), base).unwrap();
    ///     Checker::new(&scene, CheckerOptions::default()).collides(&SceneState::new(&scene)).is_some()
    /// };
    /// assert!(hit(other) && !hit(Pose::from_translation(Vec3::Z * 10.0)));
    /// ```
    ///
    /// # Errors
    /// [`SceneError`] if there is no such robot, or if the pose is not finite.
    pub fn with_base(&self, robot: RobotId, base_in_world: Pose) -> Result<Self, SceneError> {
        let mut scene = self.clone();
        let count = scene.robots.len();
        let placed = scene.robots.get_mut(robot.0).ok_or(SceneError::NoSuchRobot { index: robot.0, count })?;
        if !base_in_world.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("the base of `{}`", placed.name)));
        }
        placed.base_in_world = base_in_world;
        let is_of_robot = |id: GeometryId| matches!(id, GeometryId::Link { robot: of, .. } if of == robot);
        for matrix in [&mut scene.matrix, &mut scene.model_matrix] {
            for entry in matrix.entries_mut() {
                let has_moved = is_of_robot(entry.a) != is_of_robot(entry.b);
                if has_moved && matches!(entry.reason, Reason::OutOfReach { .. }) {
                    (entry.state, entry.reason) = (PairState::Tested, Reason::Default);
                }
            }
        }
        Ok(scene)
    }
}
