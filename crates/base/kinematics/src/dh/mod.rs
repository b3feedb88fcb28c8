//! Denavit-Hartenberg tables: extracts them from any chain in generalized form, and builds chains from tables.
//!
//! | table | row | the joint acts on | notes |
//! | --- | --- | --- | --- |
//! | classical ([`ClassicalRow`], [`Chain::from_dh`](crate::Chain::from_dh)) | `Rz(θ)·Tz(d)·Tx(a)·Rx(α)` | z of the frame before | the convention of data sheets; input |
//! | generalized ([`GeneralizedTable::extract`], [`GeneralizedTable::to_chain`]) | `Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)` | z of the frame before | along common normals: classical (b = 0) where possible |
//! | direct ([`DirectTable`]) | the same | z of the frame before | one row per frame of the model |
//! | modified ([`ModifiedTable`]) | `Rx(α)·Tx(a)·Rz(θ)·Tz(d)` | z of the frame after | Craig's convention |
//!
//! A generalized row is `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)` (Reichenbach and Kovačić 2003). The joint of a row acts about
//! or along the z axis of the frame *before* the row: its value is added to θ (revolute) or d (prismatic).
//!
//! [`GeneralizedTable::extract`] makes every joint axis the z axis of a frame. The transform from one axis to the
//! next is a row times a rotation about the second axis and a translation along it. This remainder commutes with the
//! second joint, so it goes to the next row. Such a row is classical (b = 0, a ≥ 0), by the common normal. Only if
//! two axes are almost parallel (less than a thousandth of a radian), b is used, because their common normal would
//! be very far away.
//!
//! At the tip the remainder cannot be passed on. A transform whose entry (3,1) is 0 is one row; any other transform
//! is split into `T1·T2`, each with that entry 0, by an auxiliary frame (a row without a joint).
//!
//! ```
//! use elbowroom_kinematics::dh::{ClassicalRow, GeneralizedTable};
//! use elbowroom_kinematics::{Chain, JointKind, Limits};
//!
//! let row = |joint: &str, a: f64| ClassicalRow {
//!     joint: joint.into(), kind: JointKind::Revolute, a, alpha: 0.0, d: 0.0, theta: 0.0, limits: Limits::symmetric(3.0),
//! };
//! let planar = Chain::from_dh("planar", &[row("shoulder", 0.4), row("elbow", 0.3)])?;
//! let table = GeneralizedTable::extract(&planar, planar.tip());
//! assert!(table.residual < 1e-12);
//! let a: Vec<f64> = table.rows.iter().map(|r| r.a).collect();
//! assert_eq!(a, [0.4, 0.3]);
//! assert_eq!(table.rows[1].joint.as_deref(), Some("elbow"));
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

mod build;
mod direct;
mod extract;
mod generalized;
mod modified;
mod residual;
mod split;

pub use build::ClassicalRow;
pub use direct::DirectTable;
pub use generalized::{GeneralizedRow, GeneralizedTable};
pub use modified::{ModifiedRow, ModifiedTable};
