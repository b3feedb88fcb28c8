//! Frames with a centre and a rotation about a vector.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{JointKind, Limits};

/// An axis of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FrameAxis {
    /// Rotates by γ, translates by the first component of `c`.
    X,
    /// Rotates by β, translates by the second component of `c`.
    Y,
    /// Rotates by α, translates by the third component of `c`.
    Z,
}

/// How a joint moves a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMotion {
    /// The joint's name. A mimic joint has its own name: its value is `multiplier · q(source) + offset`.
    pub joint: String,
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// The axis of the frame that the joint moves about or along.
    pub along: FrameAxis,
    /// True if the displacement is minus the joint's value.
    pub reversed: bool,
    /// Limits of the joint, rad or m.
    pub limits: Limits,
}

/// The six numbers of a dynamic frame (equation 3).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Displacement {
    /// Translation along the frame's axes, m.
    pub c: Vec3,
    /// Rotation about x, rad.
    pub gamma: f64,
    /// Rotation about y, rad.
    pub beta: f64,
    /// Rotation about the actual z axis, rad.
    pub alpha: f64,
}

impl Displacement {
    /// The pose `T(c) · Rz(α) · Ry(β) · Rx(γ)`.
    pub fn pose(&self) -> Pose {
        Pose::new(Rotation::from_rpy(self.gamma, self.beta, self.alpha), self.c)
    }
}

impl JointMotion {
    /// The displacement at the joint's value (rad or m).
    pub fn displacement(&self, value: f64) -> Displacement {
        let v = if self.reversed { -value } else { value };
        let mut d = Displacement::default();
        match (self.kind, self.along) {
            (JointKind::Fixed, _) => {}
            (JointKind::Prismatic, axis) => d.c = axis.unit() * v,
            (_, FrameAxis::X) => d.gamma = v,
            (_, FrameAxis::Y) => d.beta = v,
            (_, FrameAxis::Z) => d.alpha = v,
        }
        d
    }
}

impl FrameAxis {
    /// The unit vector.
    pub fn unit(self) -> Vec3 {
        match self {
            Self::X => Vec3::X,
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
        }
    }
}

/// A local frame, in the frame before it.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalFrame {
    /// Name of a link, unique among the frames.
    pub name: String,
    /// The centre vector, m.
    pub centre: Vec3,
    /// The vector that the frame is rotated about; any length except zero.
    pub axis: Vec3,
    /// The fixed rotation θk about `axis`, rad.
    pub angle: f64,
    /// The frame's joint; `None` for a static frame.
    pub motion: Option<JointMotion>,
}

impl LocalFrame {
    /// A static frame without rotation.
    pub fn fixed(name: impl Into<String>, centre: Vec3) -> Self {
        Self { name: name.into(), centre, axis: Vec3::Z, angle: 0.0, motion: None }
    }

    /// The constant part `T_center · T_rotation`. NaN if the axis has no direction, unless the angle is 0.
    pub fn fixed_pose(&self) -> Pose {
        let rotation = match self.axis.try_normalize() {
            _ if self.angle == 0.0 => Rotation::IDENTITY,
            Some(axis) => Rotation::from_axis_angle(axis, self.angle),
            None => Rotation::from_axis_angle(Vec3::Z, f64::NAN),
        };
        Pose::new(rotation, self.centre)
    }

    /// `T_center · T_rotation · T_q` at the joint's value (rad or m; ignored for a static frame).
    pub fn transform(&self, value: f64) -> Pose {
        match &self.motion {
            Some(motion) => self.fixed_pose() * motion.displacement(value).pose(),
            None => self.fixed_pose(),
        }
    }
}

/// A sequence of frames from the global frame outwards.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameChain {
    /// The frames, in order from the global frame.
    pub frames: Vec<LocalFrame>,
}

impl FrameChain {
    /// The last frame in the global frame (equation 4). `value` returns a joint's value for its name, rad or m.
    pub fn tip_in_root(&self, mut value: impl FnMut(&str) -> f64) -> Pose {
        self.frames.iter().fold(Pose::IDENTITY, |at, frame| {
            let q = frame.motion.as_ref().map_or(0.0, |m| value(&m.joint));
            at * frame.transform(q)
        })
    }
}
