//! Surroundings of the robots at one instant of a run, as scenes.

use elbowroom_kinematics::ChainState;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Object, Scene, SceneError, SceneState};
use elbowroom_spatial::Pose;

use super::perceived_obstacles::{PerceivedObstacle, PerceivedSolid};

/// Robots, objects and obstacles at one instant.
#[derive(Debug)]
pub struct Surroundings {
    /// The robots.
    pub states: Vec<ChainState>,
    /// The objects of the cell at their present poses.
    pub objects: Vec<Object>,
    /// Per object its attachment to the robot that carries it; `None` if it is not carried.
    pub attachments: Vec<Option<Attachment>>,
    /// What sensors saw.
    pub perceived: Vec<PerceivedObstacle>,
}

/// A scene with its state.
pub(super) struct PlacedScene {
    pub scene: Scene,
    pub state: SceneState,
    /// Index of the first object that is a perceived obstacle; the objects after it are, too.
    first_perceived: usize,
}

impl PlacedScene {
    /// Index of the perceived obstacle that an object is; `None` for other objects.
    pub fn perceived(&self, object: ObjectId) -> Option<usize> {
        object.0.checked_sub(self.first_perceived)
    }
}

impl Surroundings {
    /// Scene with a robot and what it carries, the other robots, and the perceived obstacles as these solids.
    ///
    /// # Errors
    /// An error if the scene refuses the solids or the joint values.
    pub(super) fn obstacles_only(
        &self,
        base: &Scene,
        robot: RobotId,
        solids: &[PerceivedSolid],
    ) -> Result<PlacedScene, SceneError> {
        self.scene(base, |attachment| attachment.is_some_and(|a| a.robot == robot), solids)
    }

    /// Scene with all robots and objects, and the perceived obstacles as these solids.
    ///
    /// # Errors
    /// As for [`obstacles_only`](Self::obstacles_only).
    pub(super) fn everything(&self, base: &Scene, solids: &[PerceivedSolid]) -> Result<PlacedScene, SceneError> {
        self.scene(base, |_| true, solids)
    }

    fn scene(
        &self,
        base: &Scene,
        keeps: impl Fn(Option<&Attachment>) -> bool,
        solids: &[PerceivedSolid],
    ) -> Result<PlacedScene, SceneError> {
        let kept: Vec<(&Object, &Option<Attachment>)> =
            self.objects.iter().zip(&self.attachments).filter(|(_, a)| keeps(a.as_ref())).collect();
        let mut objects: Vec<Object> = kept.iter().map(|(o, _)| (*o).clone()).collect();
        let first_perceived = objects.len();
        let solids = self.perceived.iter().zip(solids);
        objects.extend(solids.map(|(obstacle, solid)| Object {
            name: obstacle.name.clone(),
            shape: solid.shape.clone(),
            in_world: Pose::IDENTITY,
        }));
        let scene = base.with_objects(objects)?;
        let mut state = SceneState::new(&scene);
        for (i, robot) in self.states.iter().enumerate() {
            state.set_q(&scene, RobotId(i), &robot.q)?;
        }
        for (i, (_, attachment)) in kept.into_iter().enumerate() {
            if let Some(attachment) = attachment {
                state.attach_at(&scene, ObjectId(i), attachment.clone())?;
            }
        }
        Ok(PlacedScene { scene, state, first_perceived })
    }
}
