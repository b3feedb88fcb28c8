//! A moving joint prepared for batched forward kinematics.

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// Distance from 0 or ±1 within which entries of a rotation count as exact.
const PRINCIPAL_TOLERANCE: f64 = 1e-9;
/// Largest tested distance of slides from their zero, m, if their limits are wider.
const LONGEST_SLIDE_M: f64 = 100.0;
/// Distance by which slides may exceed their limits, m: for rounding and for the residual error of inverse kinematics.
const BEYOND_LIMITS_M: f64 = 1e-3;
/// Largest angle, rad.
///
/// Up to it, reducing an angle to one turn in double precision is far more exact than single precision.
const LARGEST_ANGLE_RAD: f64 = 1e6;

/// A moving joint. The z axis of the frame that it moves is along the joint's axis.
#[derive(Debug, Clone)]
pub(crate) struct JointStep {
    /// Index of the frame that carries the joint; 0 is the root's frame.
    pub parent: usize,
    pub is_prismatic: bool,
    /// Rotation of the joint's frame at value 0 in the parent frame.
    pub rotation: FixedRotation,
    /// Origin of the joint's frame in the parent frame, m.
    pub translation: [f32; 3],
    /// Pose of the joint's frame at value 0 in the parent frame, in double precision.
    pub at_zero: Pose,
    /// Index in `q`. The joint's value is `multiplier·q[index] + offset`.
    pub index: usize,
    pub multiplier: f64,
    pub offset: f64,
    /// Lowest and highest value, rad or m: the limits of a turning joint; for a slide slightly wider, and always finite.
    pub lower: f64,
    pub upper: f64,
}

impl JointStep {
    /// True for values for which the bounds of motion and rounding hold. False for NaN.
    #[inline]
    pub fn accepts(&self, value: f64) -> bool {
        if self.is_prismatic { value >= self.lower && value <= self.upper } else { value.abs() <= LARGEST_ANGLE_RAD }
    }
}

/// Lowest and highest value of a step, from both ends of its range.
pub(super) fn value_range(is_prismatic: bool, ends: [f64; 2]) -> [f64; 2] {
    let (lower, upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    if !is_prismatic {
        return [lower, upper];
    }
    [(lower - BEYOND_LIMITS_M).max(-LONGEST_SLIDE_M), (upper + BEYOND_LIMITS_M).min(LONGEST_SLIDE_M)]
}

/// A constant rotation, by columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum FixedRotation {
    /// Column `k` is `sign` times the coordinate axis `axis`.
    Permutation { axis: [usize; 3], sign: [f32; 3] },
    /// Any other rotation, by columns.
    Matrix([[f32; 3]; 3]),
}

impl FixedRotation {
    pub fn new(rotation: Rotation) -> Self {
        let columns = [rotation.x_axis(), rotation.y_axis(), rotation.z_axis()];
        match columns.map(principal) {
            [Some(x), Some(y), Some(z)] => Self::Permutation { axis: [x.0, y.0, z.0], sign: [x.1, y.1, z.1] },
            _ => Self::Matrix(columns.map(single)),
        }
    }
}

/// A rotation that turns the z axis to a joint's axis, along coordinate axes if the joint's axis is one.
pub(crate) fn axis_rotation(axis: Vec3) -> Rotation {
    match principal(axis) {
        Some((k, sign)) => {
            let unit = |i: usize| [Vec3::X, Vec3::Y, Vec3::Z][i % 3];
            let (z, x) = (unit(k) * f64::from(sign), unit(k + 1));
            Rotation::from_columns(x, z.cross(x), z).unwrap_or_else(|| Rotation::from_z(axis))
        }
        None => Rotation::from_z(axis),
    }
}

/// The coordinate axis along which a unit vector lies, and its sign.
fn principal(v: Vec3) -> Option<(usize, f32)> {
    let k = (0..3).find(|&k| (v[k].abs() - 1.0).abs() <= PRINCIPAL_TOLERANCE)?;
    let others = (0..3).all(|i| i == k || v[i].abs() <= PRINCIPAL_TOLERANCE);
    others.then_some((k, 1.0_f32.copysign(v[k] as f32)))
}

/// A vector in single precision.
pub(crate) fn single(v: Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Frame and constant pose of a link: the frame is moved by a joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkFrame {
    pub frame: usize,
    pub in_frame: Pose,
}

/// True if a joint of this kind is a step of its own.
pub(crate) fn moves(kind: JointKind) -> bool {
    kind != JointKind::Fixed
}
