//! The generalized convention.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::residual::residual;
use crate::{Chain, JointKind, LinkId};

/// One generalized row: `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)`.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedRow {
    /// The joint whose value is added to θ (revolute) or d (prismatic); `None` in fixed and auxiliary rows.
    /// A mimic joint has its own name: its value is `multiplier · q(source) + offset`.
    pub joint: Option<String>,
    /// The joint's kind; [`JointKind::Fixed`] if there is none.
    pub kind: JointKind,
    /// Rotation about z, rad.
    pub theta: f64,
    /// Translation along the rotated x, m.
    pub a: f64,
    /// Translation along the rotated y, m; 0 in the classical convention.
    pub b: f64,
    /// Translation along z, m.
    pub d: f64,
    /// Rotation about the rotated x, rad.
    pub alpha: f64,
}

impl GeneralizedRow {
    /// A fixed row of zeros: the identity.
    pub(super) const IDENTITY: Self =
        Self { joint: None, kind: JointKind::Fixed, theta: 0.0, a: 0.0, b: 0.0, d: 0.0, alpha: 0.0 };

    /// The frame after the row in the frame before it, at the joint value `q` (rad or m; ignored without a joint).
    pub fn transform(&self, q: f64) -> Pose {
        let (theta, d) = match self.kind {
            JointKind::Fixed => (self.theta, self.d),
            JointKind::Revolute | JointKind::Continuous => (self.theta + q, self.d),
            JointKind::Prismatic => (self.theta, self.d + q),
        };
        let about_z = Rotation::from_axis_angle(Vec3::Z, theta);
        let translation = about_z * Vec3::new(self.a, self.b, d);
        Pose::new(about_z * Rotation::from_axis_angle(Vec3::X, self.alpha), translation)
    }
}

/// The generalized rows from the root to a tip.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneralizedTable {
    /// The rows, in order from the root.
    pub rows: Vec<GeneralizedRow>,
    /// Largest difference of an entry (m, or of a rotation matrix) between the product of the rows and forward
    /// kinematics, over 32 configurations spread over the joint ranges.
    pub residual: f64,
}

impl GeneralizedTable {
    /// The product of the rows: the tip in the root. `value` returns a joint's value for its name, rad or m.
    pub fn tip_in_root(&self, mut value: impl FnMut(&str) -> f64) -> Pose {
        self.rows.iter().fold(Pose::IDENTITY, |at, row| {
            let q = row.joint.as_deref().map_or(0.0, &mut value);
            at * row.transform(q)
        })
    }

    /// The sum of all lengths of the rows, m: an upper bound of the distance of the tip from the root without prismatic
    /// joints.
    pub fn length_m(&self) -> f64 {
        self.rows.iter().map(|row| row.a.abs() + row.b.abs() + row.d.abs()).sum()
    }

    /// The table with every a, b and d below `least_m` set to 0: what is below the precision of a file counts as 0. The
    /// residual is that of the new rows.
    #[must_use]
    pub fn rounded(&self, chain: &Chain, tip: LinkId, least_m: f64) -> Self {
        let round = |length: f64| if length.abs() < least_m { 0.0 } else { length };
        let row =
            |row: &GeneralizedRow| GeneralizedRow { a: round(row.a), b: round(row.b), d: round(row.d), ..row.clone() };
        let mut table = Self { rows: self.rows.iter().map(row).collect(), residual: 0.0 };
        table.residual = residual(chain, tip, Pose::IDENTITY, |value| table.tip_in_root(value));
        table
    }
}
