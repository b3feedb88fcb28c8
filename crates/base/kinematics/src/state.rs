//! The mutable part of a chain: joint values in, poses and velocities out.

use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use crate::{Chain, LinkId};

/// Joint values of a chain, and the poses, velocities and accelerations of its links. [`ChainState::new`] allocates
/// all memory.
#[derive(Debug)]
pub struct ChainState {
    /// Values of the independent joints, rad or m, in the order of [`Chain::active_joints`].
    pub q: Vec<f64>,
    /// Velocities of the independent joints, rad/s or m/s.
    pub qd: Vec<f64>,
    /// Accelerations of the independent joints, rad/s² or m/s².
    pub qdd: Vec<f64>,
    pub(crate) poses: Vec<Pose>,
    pub(crate) motions: Vec<FrameMotion>,
}

impl Clone for ChainState {
    fn clone(&self) -> Self {
        let Self { q, qd, qdd, poses, motions } = self;
        Self { q: q.clone(), qd: qd.clone(), qdd: qdd.clone(), poses: poses.clone(), motions: motions.clone() }
    }

    /// Reuses the memory of `self`.
    fn clone_from(&mut self, source: &Self) {
        let Self { q, qd, qdd, poses, motions } = source;
        self.q.clone_from(q);
        self.qd.clone_from(qd);
        self.qdd.clone_from(qdd);
        self.poses.clone_from(poses);
        self.motions.clone_from(motions);
    }
}

impl ChainState {
    /// The state with all joints at zero and at rest, and with computed poses. Zero may be outside a joint's limits;
    /// values are not clamped.
    pub fn new(chain: &Chain) -> Self {
        let mut state = Self {
            q: vec![0.0; chain.dof()],
            qd: vec![0.0; chain.dof()],
            qdd: vec![0.0; chain.dof()],
            poses: vec![Pose::IDENTITY; chain.links().len()],
            motions: vec![FrameMotion::REST; chain.links().len()],
        };
        chain.forward(&mut state);
        state
    }

    /// The rest pose: every joint at zero, or at the limit nearest to it; poses are computed.
    pub fn at_rest(chain: &Chain) -> Self {
        let mut state = Self::new(chain);
        let bounds = chain.lower().into_iter().zip(chain.upper());
        state.q.iter_mut().zip(bounds).for_each(|(q, (lower, upper))| *q = 0.0_f64.min(upper).max(lower));
        chain.forward(&mut state);
        state
    }

    /// The link's frame in the root link's frame, as of the last [`Chain::forward`] or [`Chain::forward_motion`].
    ///
    /// # Panics
    /// Panics if the link is not in the chain for which the state was created.
    #[inline]
    pub fn link_in_root(&self, link: LinkId) -> Pose {
        self.poses[link.0]
    }

    /// Velocity and acceleration of the link's frame, measured in and expressed in the root link's frame, as of the last
    /// [`Chain::forward_motion`].
    ///
    /// # Panics
    /// Panics if the link is not in the chain for which the state was created.
    #[inline]
    pub fn link_motion(&self, link: LinkId) -> FrameMotion {
        self.motions[link.0]
    }

    /// Velocity (m/s, in the root's frame) of the point of a link that is now at `point_in_root` (m), as of the last
    /// [`Chain::forward_motion`].
    ///
    /// # Panics
    /// Panics if the link is not in the chain for which the state was created.
    #[inline]
    pub fn point_velocity(&self, link: LinkId, point_in_root: Vec3) -> Vec3 {
        self.motions[link.0].velocity_at(point_in_root - self.poses[link.0].translation)
    }
}
