//! Forward kinematics: poses, velocities and accelerations of all links, from the root outwards.

use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use crate::{Chain, ChainState, JointKind};

impl Chain {
    /// Computes the pose of every link in the root from `state.q`. Does not allocate.
    ///
    /// The state must have been created for this chain. If `q` is shorter than [`Chain::dof`], poses that depend on the
    /// missing values are NaN.
    ///
    /// # Panics
    /// Panics if the state was created for a chain with fewer links.
    pub fn forward(&self, state: &mut ChainState) {
        state.poses[self.root.0] = Pose::IDENTITY;
        for step in &self.steps {
            state.poses[step.child] = step.child_in_root(&state.poses[step.parent], &state.q);
        }
    }

    /// Computes pose, velocity and acceleration of every link in the root from `state.q`, `qd`, `qdd`. Exact; does not
    /// allocate.
    ///
    /// Source: the outward pass of the recursive Newton-Euler method (Luh, Walker, Paul 1980).
    ///
    /// # Panics
    /// Panics if the state was created for a chain with fewer links.
    pub fn forward_motion(&self, state: &mut ChainState) {
        state.poses[self.root.0] = Pose::IDENTITY;
        state.motions[self.root.0] = FrameMotion::REST;
        for step in &self.steps {
            let parent_in_root = state.poses[step.parent];
            let child_in_root = step.child_in_root(&parent_in_root, &state.q);
            let offset = child_in_root.translation - parent_in_root.translation;
            let mut motion = state.motions[step.parent].shifted(offset);
            if step.kind != JointKind::Fixed {
                let axis = child_in_root.rotation * step.axis;
                add_joint_motion(
                    &mut motion,
                    step.kind,
                    axis,
                    step.coupling.rate(&state.qd),
                    step.coupling.rate(&state.qdd),
                );
            }
            state.poses[step.child] = child_in_root;
            state.motions[step.child] = motion;
        }
    }
}

/// Adds the joint's own motion. On entry `motion` is the motion of the parent at the child's origin; `axis` is in
/// the root.
#[inline]
fn add_joint_motion(motion: &mut FrameMotion, kind: JointKind, axis: Vec3, rate: f64, acceleration: f64) {
    let carried = motion.angular_velocity;
    let relative = axis * rate;
    if kind == JointKind::Prismatic {
        motion.velocity += relative;
        // The factor 2 of Coriolis acceleration: the axis rotates, and the slide changes its distance from the parent's
        // axis.
        motion.acceleration += axis * acceleration + carried.cross(relative) * 2.0;
    } else {
        motion.angular_velocity += relative;
        motion.angular_acceleration += axis * acceleration + carried.cross(relative);
    }
}
