//! Poses, velocities and accelerations of all links, from the root outwards.

use elbowroom_spatial::{Motion, Pose, Rotation, Vec3};

use crate::chain::Drive;
use crate::{Chain, ChainState, Joint, JointKind};

/// A joint prepared for the forward pass.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub kind: JointKind,
    pub parent: usize,
    pub child: usize,
    pub origin: Pose,
    /// Most origins in files are plain translations; their rotation need not be multiplied.
    pub origin_turns: bool,
    pub axis: Vec3,
    /// Most axes are a coordinate axis, one way or the other: its index and sign.
    pub principal: Option<(usize, f64)>,
    pub drive: Drive,
}

impl Step {
    pub fn new(joint: &Joint, drive: Option<Drive>) -> Self {
        Self {
            kind: joint.kind,
            parent: joint.parent.0,
            child: joint.child.0,
            origin: joint.origin,
            origin_turns: joint.origin.rotation != Rotation::IDENTITY,
            axis: joint.axis,
            principal: principal(joint.axis),
            drive: drive.unwrap_or(Drive { index: 0, multiplier: 0.0, offset: 0.0 }),
        }
    }

    /// Value of the joint; NaN where `q` is too short, so that a mistake cannot pass for a pose.
    #[inline]
    fn value(&self, q: &[f64]) -> f64 {
        q.get(self.drive.index).map_or(f64::NAN, |v| self.drive.multiplier * v + self.drive.offset)
    }

    /// Rate of the joint: the mimic's offset does not count.
    #[inline]
    fn rate(&self, qd: &[f64]) -> f64 {
        qd.get(self.drive.index).map_or(f64::NAN, |v| self.drive.multiplier * v)
    }

    #[inline]
    fn child_in_root(&self, parent_in_root: &Pose, q: &[f64]) -> Pose {
        let translation = parent_in_root.transform_point(self.origin.translation);
        let rotation =
            if self.origin_turns { parent_in_root.rotation * self.origin.rotation } else { parent_in_root.rotation };
        match self.kind {
            JointKind::Fixed => Pose::new(rotation, translation),
            JointKind::Revolute | JointKind::Continuous => Pose::new(self.turned(rotation, self.value(q)), translation),
            JointKind::Prismatic => Pose::new(rotation, translation + (rotation * self.axis) * self.value(q)),
        }
    }

    #[inline]
    fn turned(&self, rotation: Rotation, angle: f64) -> Rotation {
        match self.principal {
            Some((axis, sign)) => rotation.turned_about(axis, sign * angle),
            None => rotation * Rotation::from_axis_angle(self.axis, angle),
        }
    }
}

/// Index and sign where the unit vector is a coordinate axis.
pub(crate) fn principal(axis: Vec3) -> Option<(usize, f64)> {
    (0..3).find(|&i| axis[i].abs() == 1.0).map(|i| (i, axis[i]))
}

impl Chain {
    /// Computes the pose of every link in the root from `state.q`. Does not allocate.
    ///
    /// The state must have been made for this chain. Where `q` is shorter than [`Chain::dof`], poses that depend on the
    /// missing values are NaN.
    ///
    /// # Panics
    /// Where the state was made for a chain with fewer links.
    pub fn forward(&self, state: &mut ChainState) {
        state.poses[self.root.0] = Pose::IDENTITY;
        for step in &self.steps {
            state.poses[step.child] = step.child_in_root(&state.poses[step.parent], &state.q);
        }
    }

    /// Computes pose, velocity and acceleration of every link in the root from `state.q`, `qd`, `qdd`: the outward
    /// pass of the recursive Newton-Euler method (Luh, Walker, Paul 1980), exact. Does not allocate.
    ///
    /// # Panics
    /// Where the state was made for a chain with fewer links.
    pub fn forward_motion(&self, state: &mut ChainState) {
        state.poses[self.root.0] = Pose::IDENTITY;
        state.motions[self.root.0] = Motion::REST;
        for step in &self.steps {
            let parent_in_root = state.poses[step.parent];
            let child_in_root = step.child_in_root(&parent_in_root, &state.q);
            let offset = child_in_root.translation - parent_in_root.translation;
            let mut motion = state.motions[step.parent].shifted(offset);
            if step.kind != JointKind::Fixed {
                let axis = child_in_root.rotation * step.axis;
                add_joint_motion(&mut motion, step.kind, axis, step.rate(&state.qd), step.rate(&state.qdd));
            }
            state.poses[step.child] = child_in_root;
            state.motions[step.child] = motion;
        }
    }
}

/// What the joint itself adds. `motion` comes in as that of the parent at the child's origin; `axis` is in the root.
#[inline]
fn add_joint_motion(motion: &mut Motion, kind: JointKind, axis: Vec3, rate: f64, acceleration: f64) {
    let carried = motion.angular_velocity;
    let relative = axis * rate;
    if kind == JointKind::Prismatic {
        motion.velocity += relative;
        // The factor 2 is Coriolis: the axis turns, and the slide moves to where the parent is faster.
        motion.acceleration += axis * acceleration + carried.cross(relative) * 2.0;
    } else {
        motion.angular_velocity += relative;
        motion.angular_acceleration += axis * acceleration + carried.cross(relative);
    }
}
