//! A joint prepared for the forward pass.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{Joint, JointCoupling, JointKind};

/// A joint prepared for the forward pass.
#[derive(Debug, Clone)]
pub(crate) struct ForwardStep {
    pub kind: JointKind,
    pub parent: usize,
    pub child: usize,
    pub origin: Pose,
    /// False if the origin is only a translation, as for most joints in files: then no rotation is multiplied.
    pub origin_rotates: bool,
    pub axis: Vec3,
    /// Index and sign if the axis is a coordinate axis, as for most joints.
    pub principal: Option<(usize, f64)>,
    pub coupling: JointCoupling,
}

impl ForwardStep {
    pub fn new(joint: &Joint, coupling: Option<JointCoupling>) -> Self {
        Self {
            kind: joint.kind,
            parent: joint.parent.0,
            child: joint.child.0,
            origin: joint.origin,
            origin_rotates: joint.origin.rotation != Rotation::IDENTITY,
            axis: joint.axis,
            principal: principal(joint.axis),
            coupling: coupling.unwrap_or(JointCoupling { index: 0, multiplier: 0.0, offset: 0.0 }),
        }
    }

    #[inline]
    pub fn child_in_root(&self, parent_in_root: &Pose, q: &[f64]) -> Pose {
        let translation = parent_in_root.transform_point(self.origin.translation);
        let rotation =
            if self.origin_rotates { parent_in_root.rotation * self.origin.rotation } else { parent_in_root.rotation };
        match self.kind {
            JointKind::Fixed => Pose::new(rotation, translation),
            JointKind::Revolute | JointKind::Continuous => {
                Pose::new(self.rotated(rotation, self.coupling.value(q)), translation)
            }
            JointKind::Prismatic => Pose::new(rotation, translation + (rotation * self.axis) * self.coupling.value(q)),
        }
    }

    #[inline]
    fn rotated(&self, rotation: Rotation, angle: f64) -> Rotation {
        match self.principal {
            Some((axis, sign)) => rotation.rotated_about(axis, sign * angle),
            None => rotation * Rotation::from_axis_angle(self.axis, angle),
        }
    }
}

/// Index and sign of the axis if the unit vector is a coordinate axis.
pub(crate) fn principal(axis: Vec3) -> Option<(usize, f64)> {
    (0..3).find(|&i| axis[i].abs() == 1.0).map(|i| (i, axis[i]))
}
