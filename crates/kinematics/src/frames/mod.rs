//! A chain as frames with a centre and a rotation about a vector: the form in which models of the virtual world hold it.
//!
//! S4.2; equations 1 to 4 of the paper. Frame k has a fixed centre vector `p_center,k` and a fixed rotation by `θk`
//! about the vector `p_rotation,k`; a dynamic frame i moves, besides, by a translation `c_i` and the angles `γ`, `β`, `α`
//! about x, y and the actual z axis (roll, pitch, yaw):
//!
//! ```text
//! T_center,k   = T(p_center,k)                        (1)
//! T_rotation,k = R(p_rotation,k, θk)                  (2)
//! T_q,i        = T(c_i) · Rz(α_i) · Ry(β_i) · Rx(γ_i)  (3), unity for static frames
//! T⁰_n         = Π_k T_center,k · T_rotation,k · T_q,k  (4), k from 1 to n
//! ```
//!
//! A joint drives one of the six numbers of (3). Joints about x, y or z of their frame are taken as they are; for any other
//! axis the frame is turned so that its z is the axis, and the next one turned back.
//!
//! ```
//! use elbowroom_kinematics::frames::{Axis, Frame, Frames, Motion};
//! use elbowroom_kinematics::{ChainState, JointKind, Limits};
//! use elbowroom_spatial::Vec3;
//!
//! let column = Frame {
//!     motion: Some(Motion { joint: "a1".into(), kind: JointKind::Revolute, along: Axis::Z, reversed: false, limits: Limits::symmetric(3.0) }),
//!     ..Frame::fixed("column", Vec3::Z * 0.75)
//! };
//! let hand = Frame { axis: Vec3::Y, angle: 0.5, ..Frame::fixed("hand", Vec3::X * 1.2) };
//! let arm = Frames { frames: vec![Frame::fixed("base", Vec3::ZERO), column, hand] };
//!
//! let chain = arm.to_chain("arm")?;
//! let mut state = ChainState::new(&chain);
//! state.q[0] = 0.3;
//! chain.forward(&mut state);
//! let hand_in_base = arm.tip_in_root(|_| 0.3);
//! assert!(hand_in_base.translation.distance(state.link_in_root(chain.tip()).translation) < 1e-12);
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

mod convert;

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::{JointKind, Limits};

/// One of a frame's own axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Turns by γ, slides by the first component of `c`.
    X,
    /// Turns by β, slides by the second component of `c`.
    Y,
    /// Turns by α, slides by the third component of `c`.
    Z,
}

/// How a joint drives a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The joint's name. A mimic joint bears its own: its value is `multiplier · q(source) + offset`.
    pub joint: String,
    /// Turning or sliding.
    pub kind: JointKind,
    /// About or along which axis of the frame.
    pub along: Axis,
    /// Whether it goes the other way: the displacement is minus the joint's value.
    pub reversed: bool,
    /// What the joint may do, rad or m.
    pub limits: Limits,
}

/// Equation 3: the six numbers of a dynamic frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Displacement {
    /// Along the frame's axes, m.
    pub c: Vec3,
    /// Turn about x, rad.
    pub gamma: f64,
    /// Turn about y, rad.
    pub beta: f64,
    /// Turn about the actual z axis, rad.
    pub alpha: f64,
}

impl Displacement {
    /// `T(c) · Rz(α) · Ry(β) · Rx(γ)`.
    pub fn pose(&self) -> Pose {
        Pose::new(Rotation::from_rpy(self.gamma, self.beta, self.alpha), self.c)
    }
}

impl Motion {
    /// The displacement at the joint's value (rad or m).
    pub fn displacement(&self, value: f64) -> Displacement {
        let v = if self.reversed { -value } else { value };
        let mut d = Displacement::default();
        match (self.kind, self.along) {
            (JointKind::Fixed, _) => {}
            (JointKind::Prismatic, axis) => d.c = axis.unit() * v,
            (_, Axis::X) => d.gamma = v,
            (_, Axis::Y) => d.beta = v,
            (_, Axis::Z) => d.alpha = v,
        }
        d
    }
}

impl Axis {
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
pub struct Frame {
    /// Unique among the frames: a link's name.
    pub name: String,
    /// The centre vector, m.
    pub centre: Vec3,
    /// The vector that it is rotated about, of any length but zero.
    pub axis: Vec3,
    /// The fixed rotation θk about it, rad.
    pub angle: f64,
    /// What moves it; `None` for a static frame.
    pub motion: Option<Motion>,
}

impl Frame {
    /// A static frame that is not turned.
    pub fn fixed(name: impl Into<String>, centre: Vec3) -> Self {
        Self { name: name.into(), centre, axis: Vec3::Z, angle: 0.0, motion: None }
    }

    /// `T_center · T_rotation`, which no joint changes. NaN where the axis is no direction, unless the angle is 0.
    pub fn fixed_pose(&self) -> Pose {
        let rotation = match self.axis.try_normalize() {
            _ if self.angle == 0.0 => Rotation::IDENTITY,
            Some(axis) => Rotation::from_axis_angle(axis, self.angle),
            None => Rotation::from_axis_angle(Vec3::Z, f64::NAN),
        };
        Pose::new(rotation, self.centre)
    }

    /// `T_center · T_rotation · T_q` at the joint's value (rad or m; ignored where nothing moves the frame).
    pub fn transform(&self, value: f64) -> Pose {
        match &self.motion {
            Some(motion) => self.fixed_pose() * motion.displacement(value).pose(),
            None => self.fixed_pose(),
        }
    }
}

/// Frames one behind the other, from the global one outwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// In order.
    pub frames: Vec<Frame>,
}

impl Frames {
    /// Equation 4: the last frame in the global one. `value` gives each joint's value by its name, rad or m.
    pub fn tip_in_root(&self, mut value: impl FnMut(&str) -> f64) -> Pose {
        self.frames.iter().fold(Pose::IDENTITY, |at, frame| {
            let q = frame.motion.as_ref().map_or(0.0, |m| value(&m.joint));
            at * frame.transform(q)
        })
    }
}
