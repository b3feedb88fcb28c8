//! Velocities of the robots and objects of a scene.

use elbowroom_kinematics::ChainState;
use elbowroom_robot::{GeometryId, ObjectId, RobotId};
use elbowroom_spatial::FrameMotion;

use crate::{Scene, SceneError, SceneState};

/// Velocities of the robots and objects of a [`Scene`]. Initially everything is at rest.
///
/// [`SceneMotion::new`] allocates all memory.
///
/// ```
/// use elbowroom_kinematics::LinkId;
/// use elbowroom_robot::{GeometryId, RobotId};
/// use elbowroom_scene::{SceneMotion, SceneState, example};
/// let scene = example::two_arms();
/// let state = SceneState::new(&scene);
/// let mut motion = SceneMotion::new(&scene);
/// motion.set_qd(&scene, &state, RobotId(0), &[2.0, 0.0, 0.0])?;
/// let column = GeometryId::Link { robot: RobotId(0), link: LinkId(1) };
/// assert_eq!(motion.of(&scene, &state, column).map(|m| m.angular_velocity.z), Some(2.0));
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneMotion {
    chains: Vec<ChainState>,
    /// Per object: its motion, if it is not attached.
    objects: Vec<FrameMotion>,
}

impl SceneMotion {
    /// Creates a motion with everything at rest.
    pub fn new(scene: &Scene) -> Self {
        Self {
            chains: scene.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            objects: vec![FrameMotion::REST; scene.objects.len()],
        }
    }

    /// Sets a robot's joint velocities at its configuration in `state`. Does not allocate.
    ///
    /// `qd` is in rad/s or m/s, in the order of [`Chain::active_joints`](elbowroom_kinematics::Chain::active_joints).
    ///
    /// # Errors
    /// [`SceneError`] if the robot does not exist, the number of values is wrong, or a value is NaN or infinite.
    pub fn set_qd(&mut self, scene: &Scene, state: &SceneState, robot: RobotId, qd: &[f64]) -> Result<(), SceneError> {
        state.check_q(scene, robot, qd)?;
        let chain = &mut self.chains[robot.0];
        chain.q.copy_from_slice(&state.chains[robot.0].q);
        chain.qd.copy_from_slice(qd);
        scene.robots[robot.0].robot.chain.forward_motion(chain);
        Ok(())
    }

    /// Sets the motion of an unattached object's frame, in the world.
    ///
    /// # Errors
    /// [`SceneError`] if the object does not exist, or a number is NaN or infinite.
    pub fn set_object(&mut self, scene: &Scene, object: ObjectId, motion: FrameMotion) -> Result<(), SceneError> {
        let count = scene.objects.len();
        let o = scene.objects.get(object.0).ok_or(SceneError::NoSuchObject { index: object.0, count })?;
        if !motion.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("`{}` in motion", o.name)));
        }
        self.objects[object.0] = motion;
        Ok(())
    }

    /// The motion of the frame of a link or object, in the world.
    ///
    /// An attached object moves with its link. `None` if the scene has no such link or object.
    pub fn of(&self, scene: &Scene, state: &SceneState, id: GeometryId) -> Option<FrameMotion> {
        let (robot, link) = match id {
            GeometryId::Link { robot, link } => (robot, link),
            GeometryId::Object(o) => match state.attached.get(o.0)? {
                Some(held) => (held.robot, held.link),
                None => return self.objects.get(o.0).copied(),
            },
        };
        let r = scene.robots.get(robot.0)?;
        if link.0 >= r.robot.chain.links().len() {
            return None;
        }
        let (in_root, base) = (self.chains[robot.0].link_motion(link), r.base_in_world.rotation);
        let motion = FrameMotion {
            velocity: base * in_root.velocity,
            angular_velocity: base * in_root.angular_velocity,
            acceleration: base * in_root.acceleration,
            angular_acceleration: base * in_root.angular_acceleration,
        };
        let origin = state.link_in_world(scene, robot, link).translation;
        Some(motion.shifted(state.pose(scene, id)?.translation - origin))
    }
}
