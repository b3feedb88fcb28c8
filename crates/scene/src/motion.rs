//! How everything moves now: velocities beside the poses of a state.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Motion;

use crate::{Member, Scene, SceneError, SceneState};

/// Velocities of the robots and objects of a [`Scene`], all at rest at first.
///
/// All memory is taken by [`SceneMotion::new`].
///
/// ```
/// use elbowroom_kinematics::LinkId;
/// use elbowroom_scene::{Member, SceneMotion, SceneState, example};
/// let scene = example::two_arms();
/// let state = SceneState::new(&scene);
/// let mut motion = SceneMotion::new(&scene);
/// motion.set_qd(&scene, &state, 0, &[2.0, 0.0, 0.0])?;
/// let waist = motion.of(&scene, &state, Member::Link { robot: 0, link: LinkId(1) });
/// assert_eq!(waist.map(|m| m.angular_velocity.z), Some(2.0));
/// # Ok::<(), elbowroom_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneMotion {
    chains: Vec<ChainState>,
    /// Per object that no robot carries.
    objects: Vec<Motion>,
}

impl SceneMotion {
    /// Everything at rest.
    pub fn new(scene: &Scene) -> Self {
        Self {
            chains: scene.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
            objects: vec![Motion::REST; scene.objects.len()],
        }
    }

    /// A robot's joint velocities (rad/s or m/s, in the order of
    /// [`Chain::active_joints`](elbowroom_kinematics::Chain::active_joints)) where `state` has it. Does not allocate.
    ///
    /// # Errors
    /// No such robot, a wrong number of values, or one that is NaN or infinite, by its joint's name.
    pub fn set_qd(&mut self, scene: &Scene, state: &SceneState, robot: usize, qd: &[f64]) -> Result<(), SceneError> {
        state.check_q(scene, robot, qd)?;
        let chain = &mut self.chains[robot];
        chain.q.copy_from_slice(&state.chains[robot].q);
        chain.qd.copy_from_slice(qd);
        scene.robots[robot].robot.chain.forward_motion(chain);
        Ok(())
    }

    /// How an object moves that no robot carries: of its frame's origin, in the world.
    ///
    /// # Errors
    /// No such object, or a number that is NaN or infinite.
    pub fn set_object(&mut self, scene: &Scene, object: usize, motion: Motion) -> Result<(), SceneError> {
        let count = scene.objects.len();
        let o = scene.objects.get(object).ok_or(SceneError::NoSuchObject { index: object, count })?;
        if !motion.is_finite() {
            return Err(SceneError::PoseNotFinite(format!("`{}` in motion", o.name)));
        }
        self.objects[object] = motion;
        Ok(())
    }

    /// How a member's frame moves in the world; what is attached moves with its link. `None` where the scene has no such
    /// member.
    pub fn of(&self, scene: &Scene, state: &SceneState, member: Member) -> Option<Motion> {
        let (robot, link) = match member {
            Member::Link { robot, link } => (robot, link),
            Member::Object(o) => match state.attached.get(o)? {
                Some(held) => (held.robot, held.link),
                None => return self.objects.get(o).copied(),
            },
        };
        let r = scene.robots.get(robot)?;
        if link.0 >= r.robot.chain.links().len() {
            return None;
        }
        let (in_root, base) = (self.chains[robot].link_motion(link), r.base_in_world.rotation);
        let motion = Motion {
            velocity: base * in_root.velocity,
            angular_velocity: base * in_root.angular_velocity,
            acceleration: base * in_root.acceleration,
            angular_acceleration: base * in_root.angular_acceleration,
        };
        let origin = state.link_in_world(scene, robot, link).translation;
        Some(motion.shifted(state.pose(scene, member)?.translation - origin))
    }
}
