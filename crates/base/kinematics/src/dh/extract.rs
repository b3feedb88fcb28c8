//! Extraction of the generalized table of a chain.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::generalized::{GeneralizedRow, GeneralizedTable};
use super::residual::residual;
use super::split::{along_z, exact_row, is_along_z, row_and_rest};
use crate::{Chain, JointKind, LinkId};

impl GeneralizedTable {
    /// Extracts the generalized table of `tip` in the root link, with its residual. Fixed joints are merged into the
    /// rows around them. Works for every chain; the residual is only rounding (about 1e-15 per metre and joint).
    pub fn extract(chain: &Chain, tip: LinkId) -> Self {
        Self::extract_to(chain, tip, Pose::IDENTITY)
    }

    /// Like [`GeneralizedTable::extract`], up to a frame fixed on the link `tip`: a tool, or a point of a surface.
    /// `tool_in_tip` is in metres.
    pub fn extract_to(chain: &Chain, tip: LinkId, tool_in_tip: Pose) -> Self {
        let mut rows = Vec::new();
        let mut pending = Pose::IDENTITY; // since the frame whose z is the last joint's axis
        let mut joint: Option<(String, JointKind)> = None;
        for id in chain.path(tip) {
            let next = &chain.joints()[id.0];
            pending = pending * next.origin;
            if next.kind == JointKind::Fixed {
                continue;
            }
            let axis_in_joint = Pose::new(z_onto(next.axis), Vec3::ZERO);
            let rest = push_row(&mut rows, joint.take(), &(pending * axis_in_joint));
            joint = Some((next.name.clone(), next.kind));
            // The joint moves everything after its axis frame; rotating back gives the link's own frame.
            pending = rest * axis_in_joint.inverse();
        }
        push_last(&mut rows, joint, &(pending * tool_in_tip));
        let mut table = Self { rows, residual: 0.0 };
        table.residual = residual(chain, tip, tool_in_tip, |value| table.tip_in_root(value));
        table
    }
}

/// A rotation that takes z onto the axis; the identity if the axis is z.
pub fn z_onto(axis: Vec3) -> Rotation {
    // Adding 0 removes the sign of zeros, which would select another rotation about the axis.
    if axis == Vec3::Z { Rotation::IDENTITY } else { Rotation::from_z(axis + Vec3::ZERO) }
}

pub fn with_joint(mut row: GeneralizedRow, joint: Option<(String, JointKind)>) -> GeneralizedRow {
    if let Some((name, kind)) = joint {
        row.joint = Some(name);
        row.kind = kind;
    }
    row
}

/// Appends the row to the next axis and returns the remainder, which commutes with the joint there.
fn push_row(rows: &mut Vec<GeneralizedRow>, joint: Option<(String, JointKind)>, t: &Pose) -> Pose {
    let (row, rest) = row_and_rest(t);
    let identity = joint.is_none() && is_along_z(&row) && row.theta == 0.0 && row.d == 0.0;
    if !identity {
        rows.push(with_joint(row, joint));
    }
    rest
}

/// Appends the transform to the tip: one row, or two with an auxiliary frame between them.
fn push_last(rows: &mut Vec<GeneralizedRow>, joint: Option<(String, JointKind)>, t: &Pose) {
    if let Some(row) = exact_row(t) {
        let identity = joint.is_none() && is_along_z(&row) && row.theta == 0.0 && row.d == 0.0;
        if !identity {
            rows.push(with_joint(row, joint));
        }
        return;
    }
    let (row, rest) = row_and_rest(t);
    rows.push(with_joint(row, joint));
    rows.push(along_z(&rest));
}
