//! The joints between root and tip, with fixed joints merged.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::forward_step::principal;
use crate::{Chain, JointKind, LinkId};

/// A moving joint between root and tip.
#[derive(Debug, Clone)]
pub struct ArmJoint {
    /// This joint's frame in the frame of the joint before it, including fixed joints between them.
    pub origin: Pose,
    pub prismatic: bool,
    pub axis: Vec3,
    /// Index and sign if the axis is a coordinate axis.
    pub principal: Option<(usize, f64)>,
    /// Index of the arm's variable that determines the joint's value.
    pub variable: usize,
    pub multiplier: f64,
    pub offset: f64,
}

impl ArmJoint {
    /// Velocity of the point `tip` (m per unit of the variable) and angular velocity, in the root.
    #[inline]
    pub fn twist(&self, at: &AxisInRoot, tip: Vec3) -> (Vec3, Vec3) {
        let axis = at.axis * self.multiplier;
        if self.prismatic { (axis, Vec3::ZERO) } else { (axis.cross(tip - at.origin), axis) }
    }
}

/// An independent joint that moves the tip.
#[derive(Debug, Clone)]
pub struct ArmVariable {
    pub name: String,
    /// Index of the joint in the chain's `q`.
    pub q_index: usize,
    pub lower: f64,
    pub upper: f64,
    pub turns: bool,
    /// True if a full turn leaves the tip in place.
    pub wraps: bool,
}

/// The joints between root and tip, and the tip.
#[derive(Debug, Clone)]
pub struct Arm {
    pub joints: Vec<ArmJoint>,
    pub variables: Vec<ArmVariable>,
    /// The pose in the root of the link that carries the first moving joint.
    pub base_in_root: Pose,
    /// The tip (tool included) in the last joint's frame.
    pub tip_in_last: Pose,
    /// Upper bound on the distance of the tip from the first joint's origin, m; infinite with an unlimited slide.
    pub reach: f64,
}

/// A joint's axis in the root.
#[derive(Debug, Clone, Copy)]
pub struct AxisInRoot {
    pub origin: Vec3,
    pub axis: Vec3,
}

impl Arm {
    pub fn new(chain: &Chain, tip: LinkId, tip_offset: Pose) -> Self {
        let mut arm = Self {
            joints: Vec::new(),
            variables: Vec::new(),
            base_in_root: Pose::IDENTITY,
            tip_in_last: Pose::IDENTITY,
            reach: 0.0,
        };
        let mut pending = Pose::IDENTITY;
        for id in chain.path(tip) {
            let joint = &chain.joints[id.0];
            if arm.joints.is_empty() {
                arm.base_in_root = pending;
            }
            pending = pending * joint.origin;
            if let Some(coupling) = chain.couplings[id.0] {
                let variable = arm.variable(chain, coupling.index);
                arm.joints.push(ArmJoint {
                    origin: pending,
                    prismatic: joint.kind == JointKind::Prismatic,
                    axis: joint.axis,
                    principal: principal(joint.axis),
                    variable,
                    multiplier: coupling.multiplier,
                    offset: coupling.offset,
                });
                pending = Pose::IDENTITY;
            }
        }
        arm.set_tip(pending * tip_offset);
        for (i, variable) in arm.variables.iter_mut().enumerate() {
            let whole_turns = |j: &ArmJoint| j.variable != i || (!j.prismatic && j.multiplier.fract() == 0.0);
            variable.wraps = variable.turns && arm.joints.iter().all(whole_turns);
        }
        arm
    }

    /// Moves the tip to another frame of the last link.
    pub fn set_tip(&mut self, tip_in_last: Pose) {
        self.tip_in_last = tip_in_last;
        self.reach = self.reach_bound();
    }

    fn variable(&mut self, chain: &Chain, q_index: usize) -> usize {
        if let Some(known) = self.variables.iter().position(|v| v.q_index == q_index) {
            return known;
        }
        let joint = &chain.joints[chain.active[q_index].0];
        self.variables.push(ArmVariable {
            name: joint.name.clone(),
            q_index,
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            turns: joint.kind.turns(),
            wraps: false,
        });
        self.variables.len() - 1
    }

    fn reach_bound(&self) -> f64 {
        let stroke = |j: &ArmJoint| {
            let v = &self.variables[j.variable];
            let at = |q: f64| (j.multiplier * q + j.offset).abs();
            if j.prismatic { at(v.lower).max(at(v.upper)) } else { 0.0 }
        };
        let offsets = self.joints.iter().skip(1).map(|j| j.origin.translation.length()).sum::<f64>();
        self.joints.iter().map(stroke).sum::<f64>() + offsets + self.tip_in_last.translation.length()
    }

    /// A characteristic length (m) that makes metres comparable with radians.
    pub fn scale(&self) -> f64 {
        let offsets = self.joints.iter().skip(1).map(|j| j.origin.translation.length()).sum::<f64>()
            + self.tip_in_last.translation.length();
        if offsets > 1e-6 { 0.5 * offsets } else { 1.0 }
    }

    /// The tip in the root. Writes the joint axes, one per joint, to `axes`.
    pub fn tip_in_root(&self, x: &[f64], axes: &mut [AxisInRoot]) -> Pose {
        let mut at = Pose::IDENTITY;
        for (joint, out) in self.joints.iter().zip(axes) {
            at = at * joint.origin;
            let value = joint.multiplier * x[joint.variable] + joint.offset;
            let axis = at.rotation * joint.axis;
            if joint.prismatic {
                at.translation += axis * value;
            } else {
                at.rotation = match joint.principal {
                    Some((axis, sign)) => at.rotation.rotated_about(axis, sign * value),
                    None => at.rotation * Rotation::from_axis_angle(joint.axis, value),
                };
            }
            *out = AxisInRoot { origin: at.translation, axis };
        }
        at * self.tip_in_last
    }
}
