//! Joints: indices, kinds, limits, mimics.

use elbowroom_spatial::{Pose, Vec3};

/// Index of a link in [`Chain::links`](crate::Chain::links).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub usize);

/// Index of a joint in [`Chain::joints`](crate::Chain::joints).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointId(pub usize);

/// Rounding of joint values, rad or m: recordings that are accepted as programs may be beyond a limit by this.
const ROUNDING: f64 = 1e-6;

/// Largest plausible overshoot of a joint that states none, rad or m: controllers overshoot by less.
const DEFAULT_OVERSHOOT_TOLERANCE: f64 = 0.05;

/// The kind of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// Does not move.
    Fixed,
    /// Rotates about its axis between limits (rad).
    Revolute,
    /// Rotates about its axis without limits (rad).
    Continuous,
    /// Translates along its axis between limits (m).
    Prismatic,
}

impl JointKind {
    /// True for kinds that rotate: revolute and continuous.
    pub fn turns(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous)
    }

    /// True for all kinds except fixed.
    pub fn moves(self) -> bool {
        self != Self::Fixed
    }
}

/// Limits of a joint, in rad or m (and per second, per second squared); effort in N·m or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest value; −∞ without a limit.
    pub lower: f64,
    /// Largest value; +∞ without a limit.
    pub upper: f64,
    /// Largest speed, rad/s or m/s; `None` if unknown (0 in a file means unknown too).
    pub velocity: Option<f64>,
    /// Largest acceleration, rad/s² or m/s²; `None` if unknown.
    pub acceleration: Option<f64>,
    /// Largest torque (N·m) or force (N); `None` if unknown.
    pub effort: Option<f64>,
    /// Largest plausible [overshoot](Self::overshoot) of a reading, rad or m; `None` if unknown. See
    /// [`Self::tolerated_overshoot`].
    pub overshoot_tolerance: Option<f64>,
}

impl Limits {
    /// Limits that restrict nothing.
    pub const UNLIMITED: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: None,
        acceleration: None,
        effort: None,
        overshoot_tolerance: None,
    };

    /// Limits from `lower` to `upper` (rad or m); all other limits are unknown.
    pub const fn range(lower: f64, upper: f64) -> Self {
        Self { lower, upper, ..Self::UNLIMITED }
    }

    /// Limits from `-bound` to `bound` (rad or m); all other limits are unknown.
    pub const fn symmetric(bound: f64) -> Self {
        Self::range(-bound, bound)
    }

    /// True if `value` (rad or m) is within the limits, or beyond them by at most `tolerance`. False for NaN.
    pub fn contains(&self, value: f64, tolerance: f64) -> bool {
        value >= self.lower - tolerance && value <= self.upper + tolerance
    }

    /// The joint overshoot of Giralt et al.: how far `value` (rad or m) is beyond the limits. Positive beyond the upper
    /// limit, negative beyond the lower limit, 0 within the limits. NaN for NaN.
    ///
    /// ```
    /// use elbowroom_kinematics::Limits;
    /// let limits = Limits::symmetric(2.0);
    /// assert_eq!([-2.5, 1.0, 2.25].map(|q| limits.overshoot(q)), [-0.5, 0.0, 0.25]);
    /// ```
    pub fn overshoot(&self, value: f64) -> f64 {
        if value.is_nan() {
            return value;
        }
        (value - self.upper).max(0.0) + (value - self.lower).min(0.0)
    }

    /// The largest overshoot (rad or m) at which a reading is plausible: as stated, or 0.05.
    pub fn tolerated_overshoot(&self) -> f64 {
        self.overshoot_tolerance.unwrap_or(DEFAULT_OVERSHOOT_TOLERANCE)
    }

    /// True if `value` (rad or m) is plausible as a reading: it overshoots by at most the tolerated overshoot, but for
    /// rounding (1e-6). False for NaN.
    pub fn is_plausible(&self, value: f64) -> bool {
        self.contains(value, self.tolerated_overshoot() + ROUNDING)
    }
}

/// A joint that follows another: its value is `multiplier · q(joint) + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// The joint that is followed.
    pub joint: JointId,
    /// Factor for the followed joint's value.
    pub multiplier: f64,
    /// Offset, added after multiplication, rad or m.
    pub offset: f64,
}

/// A joint's value as a function of the independent joint values: `multiplier · q[index] + offset`. For a joint that
/// is neither fixed nor mimic it is the identity of one entry of `q`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointCoupling {
    /// Index in `q`.
    pub index: usize,
    /// Factor for that entry of `q`.
    pub multiplier: f64,
    /// Offset, added after multiplication, rad or m.
    pub offset: f64,
}

impl JointCoupling {
    /// The joint's value, rad or m. NaN if `q` is too short, so that a mistake cannot pass for a pose.
    #[inline]
    pub fn value(&self, q: &[f64]) -> f64 {
        q.get(self.index).map_or(f64::NAN, |v| self.multiplier * v + self.offset)
    }

    /// The joint's rate (rad/s or m/s, or a derivative) from the rates of `q`. NaN if `qd` is too short.
    #[inline]
    pub fn rate(&self, qd: &[f64]) -> f64 {
        qd.get(self.index).map_or(f64::NAN, |v| self.multiplier * v)
    }
}

/// A joint between two links. The child's frame is the joint's frame, rotated about `axis` or translated along it by
/// the joint's value.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, unique among the chain's joints.
    pub name: String,
    /// The joint's kind.
    pub kind: JointKind,
    /// The parent link.
    pub parent: LinkId,
    /// The child link.
    pub child: LinkId,
    /// The child's frame in the parent's frame, at joint value 0.
    pub origin: Pose,
    /// Unit axis in the joint's frame. [`Chain::new`](crate::Chain::new) normalizes it; ignored if the joint is fixed.
    pub axis: Vec3,
    /// The joint's limits. [`Chain::new`](crate::Chain::new) removes the position limits of continuous joints.
    pub limits: Limits,
    /// The joint that this joint follows, if any; ignored if the joint is fixed.
    pub mimic: Option<Mimic>,
}
