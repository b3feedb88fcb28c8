//! Denavit-Hartenberg tables: extracted from any chain in generalized form, and chains built from tables.
//!
//! | table | row | the joint acts in | |
//! | --- | --- | --- | --- |
//! | classical ([`ClassicalRow`], [`Chain::from_dh`](crate::Chain::from_dh)) | `Rz(θ)·Tz(d)·Tx(a)·Rx(α)` | z of the frame before | what data sheets print; input |
//! | generalized ([`Table::extract`], [`Table::to_chain`]) | `Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)` | z of the frame before | along common normals: classical (b = 0) wherever that can be |
//! | direct ([`DirectTable`]) | the same | z of the frame before | one row per frame of the model, as in the paper's table 1 |
//! | modified ([`ModifiedTable`]) | `Rx(α)·Tx(a)·Rz(θ)·Tz(d)` | z of the frame after | Craig's convention |
//!
//! A generalized row is `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)` (S4.3). The joint of a row acts about or along the z axis of
//! the frame *before* the row: its value is added to θ (turning) or d (sliding).
//!
//! How [`Table::extract`] works: every joint's axis is made the z axis of a frame. The transform from one axis to the next
//! is a row times a turn about and a slide along the second axis; that remainder commutes with the second joint, so
//! it is handed on to the next row. A row found this way is classical (b = 0, a ≥ 0), by the common normal; only where two
//! axes are parallel but for rounding (less than a thousandth of a radian) is b used, instead of a common normal a
//! mile away. At the tip nothing can be handed on: a transform whose entry (3,1) is 0 is one row, any other is
//! split into `T1·T2`, each with that zero, by an auxiliary frame (a row without joint).
//!
//! ```
//! use elbowroom_kinematics::dh::{ClassicalRow, Table};
//! use elbowroom_kinematics::{Chain, JointKind, Limits};
//!
//! let row = |joint: &str, a: f64| ClassicalRow {
//!     joint: joint.into(), kind: JointKind::Revolute, a, alpha: 0.0, d: 0.0, theta: 0.0, limits: Limits::symmetric(3.0),
//! };
//! let planar = Chain::from_dh("planar", &[row("shoulder", 0.4), row("elbow", 0.3)])?;
//! let table = Table::extract(&planar, planar.tip());
//! assert!(table.residual < 1e-12);
//! let a: Vec<f64> = table.rows.iter().map(|r| r.a).collect();
//! assert_eq!(a, [0.4, 0.3]);
//! assert_eq!(table.rows[1].joint.as_deref(), Some("elbow"));
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

mod build;
mod direct;
mod extract;
mod modified;
mod split;

pub use build::ClassicalRow;
pub use direct::DirectTable;
use elbowroom_spatial::{Pose, Rotation, Vec3};
pub use modified::{ModifiedRow, ModifiedTable};

use crate::JointKind;

/// One generalized row: `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The joint whose value is added to θ (turning) or d (sliding); `None` in fixed and auxiliary rows.
    /// A mimic joint bears its own name: its value is `multiplier · q(source) + offset`.
    pub joint: Option<String>,
    /// The joint's kind; [`JointKind::Fixed`] where there is none.
    pub kind: JointKind,
    /// Turn about z, rad.
    pub theta: f64,
    /// Along the turned x, m.
    pub a: f64,
    /// Along the turned y, m; 0 in the classical convention.
    pub b: f64,
    /// Along z, m.
    pub d: f64,
    /// Turn about the turned x, rad.
    pub alpha: f64,
}

impl Row {
    /// The frame after the row in the frame before it, at the joint value `q` (rad or m; ignored without joint).
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

/// The rows from the root to a tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// In order from the root.
    pub rows: Vec<Row>,
    /// Largest difference of an entry (m, or of a rotation matrix) between the product of the rows and forward kinematics,
    /// over 32 states spread over the joint ranges.
    pub residual: f64,
}

impl Table {
    /// The product of the rows: the tip in the root. `value` gives each joint's value by its name, rad or m.
    pub fn tip_in_root(&self, mut value: impl FnMut(&str) -> f64) -> Pose {
        self.rows.iter().fold(Pose::IDENTITY, |at, row| {
            let q = row.joint.as_deref().map_or(0.0, &mut value);
            at * row.transform(q)
        })
    }
}
