//! From a chain to its table.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::split::{along_z, exact_row, is_along_z, row_and_rest};
use super::{Row, Table};
use crate::inverse::spread_state;
use crate::{Chain, ChainState, JointKind, LinkId};

/// How many states the residual is measured at.
const STATES: usize = 32;

impl Table {
    /// The generalized table of `tip` in the root link, with its residual. Fixed joints are merged into the rows around
    /// them. Works for every chain; the residual is rounding (about 1e-15 per metre and joint), and says so.
    pub fn extract(chain: &Chain, tip: LinkId) -> Self {
        Self::extract_to(chain, tip, Pose::IDENTITY)
    }

    /// As [`Table::extract`], to a frame fixed on the link `tip`: a tool, or a point of a surface that is to be steered
    /// (S4.6). `tool_in_tip` is in metres.
    pub fn extract_to(chain: &Chain, tip: LinkId, tool_in_tip: Pose) -> Self {
        let mut rows = Vec::new();
        let mut pending = Pose::IDENTITY; // from the frame whose z is the last joint's axis
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
            // The joint moves what follows its axis frame; turning back puts the link's own frame behind it.
            pending = rest * axis_in_joint.inverse();
        }
        push_last(&mut rows, joint, &(pending * tool_in_tip));
        let mut table = Self { rows, residual: 0.0 };
        table.residual = residual(chain, tip, tool_in_tip, |value| table.tip_in_root(value));
        table
    }
}

/// A turn that takes z onto the axis; none at all where it is z already.
pub fn z_onto(axis: Vec3) -> Rotation {
    // Adding 0 takes the sign off zeros: it would choose another turn about the axis.
    if axis == Vec3::Z { Rotation::IDENTITY } else { Rotation::from_z(axis + Vec3::ZERO) }
}

pub fn with_joint(mut row: Row, joint: Option<(String, JointKind)>) -> Row {
    if let Some((name, kind)) = joint {
        row.joint = Some(name);
        row.kind = kind;
    }
    row
}

/// Appends the row to the next axis and returns what commutes with the joint there.
fn push_row(rows: &mut Vec<Row>, joint: Option<(String, JointKind)>, t: &Pose) -> Pose {
    let (row, rest) = row_and_rest(t);
    let nothing = joint.is_none() && is_along_z(&row) && row.theta == 0.0 && row.d == 0.0;
    if !nothing {
        rows.push(with_joint(row, joint));
    }
    rest
}

/// The way to the tip: one row, or two with an auxiliary frame between them.
fn push_last(rows: &mut Vec<Row>, joint: Option<(String, JointKind)>, t: &Pose) {
    if let Some(row) = exact_row(t) {
        let nothing = joint.is_none() && is_along_z(&row) && row.theta == 0.0 && row.d == 0.0;
        if !nothing {
            rows.push(with_joint(row, joint));
        }
        return;
    }
    let (row, rest) = row_and_rest(t);
    rows.push(with_joint(row, joint));
    rows.push(along_z(&rest));
}

/// A joint's value by its name.
pub type Values<'a> = &'a dyn Fn(&str) -> f64;

/// Largest difference between what `product` makes of joint values and forward kinematics; NaN where there is one.
pub fn residual(chain: &Chain, tip: LinkId, tool_in_tip: Pose, product: impl Fn(Values<'_>) -> Pose) -> f64 {
    let mut state = ChainState::new(chain);
    let mut worst: f64 = 0.0;
    for index in 0..STATES {
        spread_state(chain, index, &mut state.q);
        chain.forward(&mut state);
        let value = |name: &str| chain.joint(name).map_or(f64::NAN, |id| chain.joint_value(id, &state.q));
        let difference = largest_difference(&product(&value), &(state.link_in_root(tip) * tool_in_tip));
        // `max` would drop a NaN.
        worst = if difference.is_nan() { f64::NAN } else { worst.max(difference) };
    }
    worst
}

fn largest_difference(a: &Pose, b: &Pose) -> f64 {
    let pairs = a.to_rows().into_iter().flatten().zip(b.to_rows().into_iter().flatten());
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
}
