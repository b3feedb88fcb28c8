//! Construction of chains from Denavit-Hartenberg tables.

use elbowroom_spatial::{Pose, Vec3};

use super::generalized::{GeneralizedRow, GeneralizedTable};
use crate::{Chain, ChainError, Joint, JointKind, Limits, LinkId};

/// One classical row: `T = Rz(θ+q)·Tz(d)·Tx(a)·Rx(α)`; if the joint is prismatic, q is added to d instead.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassicalRow {
    /// Name of the joint.
    pub joint: String,
    /// The joint's kind.
    pub kind: JointKind,
    /// Translation along the new x axis, m.
    pub a: f64,
    /// Rotation about the new x axis, rad.
    pub alpha: f64,
    /// Translation along the old z axis, m.
    pub d: f64,
    /// Rotation about the old z axis at joint value 0, rad.
    pub theta: f64,
    /// Limits of the joint.
    pub limits: Limits,
}

impl From<&ClassicalRow> for GeneralizedRow {
    fn from(row: &ClassicalRow) -> Self {
        let joint = (row.kind != JointKind::Fixed).then(|| row.joint.clone());
        Self { joint, kind: row.kind, theta: row.theta, a: row.a, b: 0.0, d: row.d, alpha: row.alpha }
    }
}

impl Chain {
    /// Builds a serial chain from classical rows.
    ///
    /// Its links are `base` and, for each row i (from 1), `link_i_drive` and `link_i`. `link_i_drive` moves with the
    /// joint. `link_i` is fixed on it and is the row's frame, after d, a and α. The last `link_i` is the flange and the
    /// [`Chain::tip`]. Joints have the names of the rows; the fixed joints between drive and link are called
    /// `NAME_frame`.
    ///
    /// # Errors
    /// [`ChainError`] as in [`Chain::new`]: duplicate names, bounds out of order, numbers that are not finite.
    pub fn from_dh(name: impl Into<String>, rows: &[ClassicalRow]) -> Result<Self, ChainError> {
        let limits = |i: usize| rows.get(i).map_or(Limits::UNLIMITED, |r: &ClassicalRow| r.limits);
        let generalized: Vec<GeneralizedRow> = rows.iter().map(GeneralizedRow::from).collect();
        let names = rows.iter().map(|r| r.joint.clone()).collect();
        serial(name.into(), &generalized, names, limits)
    }
}

impl GeneralizedTable {
    /// Builds the serial chain of the table without limits; its links are as in [`Chain::from_dh`]. Rows without a joint
    /// become fixed joints `fixed_i`; mimic joints become independent joints.
    ///
    /// # Errors
    /// [`ChainError`] as in [`Chain::new`].
    pub fn to_chain(&self, name: impl Into<String>) -> Result<Chain, ChainError> {
        let named =
            |(i, row): (usize, &GeneralizedRow)| row.joint.clone().unwrap_or_else(|| format!("fixed_{}", i + 1));
        let names = self.rows.iter().enumerate().map(named).collect();
        serial(name.into(), &self.rows, names, |_| Limits::UNLIMITED)
    }
}

fn serial(
    name: String,
    rows: &[GeneralizedRow],
    names: Vec<String>,
    limits: impl Fn(usize) -> Limits,
) -> Result<Chain, ChainError> {
    let mut links = vec!["base".to_owned()];
    let mut joints = Vec::new();
    for (i, (row, joint)) in rows.iter().zip(names).enumerate() {
        let (before, drive, after) = (LinkId(2 * i), LinkId(2 * i + 1), LinkId(2 * i + 2));
        links.push(format!("link_{}_drive", i + 1));
        links.push(format!("link_{}", i + 1));
        let frame = format!("{joint}_frame");
        joints.push(joint_of(joint, row.kind, before, drive, Pose::IDENTITY, limits(i)));
        joints.push(joint_of(frame, JointKind::Fixed, drive, after, at_zero(row), Limits::UNLIMITED));
    }
    Chain::new(name, links, joints)
}

fn at_zero(row: &GeneralizedRow) -> Pose {
    GeneralizedRow { kind: JointKind::Fixed, ..row.clone() }.transform(0.0)
}

fn joint_of(name: String, kind: JointKind, parent: LinkId, child: LinkId, origin: Pose, limits: Limits) -> Joint {
    Joint { name, kind, parent, child, origin, axis: Vec3::Z, limits, mimic: None }
}
