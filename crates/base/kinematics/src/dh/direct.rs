//! The direct table: one row per frame of the model, as in Reichenbach and Kovačić 2003.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::extract::{with_joint, z_onto};
use super::generalized::{GeneralizedRow, GeneralizedTable};
use super::residual::residual;
use super::split::{along_z, exact_row, row_and_rest};
use crate::{Chain, JointKind, LinkId};

/// A generalized table that follows the frames of the model; [`GeneralizedTable::extract`] follows the axes instead.
///
/// Every frame between root and tip keeps its origin. The frames are those of the root link, of each joint, of each
/// link on a fixed joint, and of the tip. A frame whose z axis is its joint's axis keeps its orientation too, and so
/// does a frame without a joint. Any other frame is rotated so that its joint acts about or along z, as the
/// convention requires, and then about that axis so that entry (3,1) of its row is 0.
///
/// Each frame is one row with a, b, d, α and θ. Only if a kept frame has (3,1) ≠ 0, an auxiliary frame precedes it,
/// marked by `*`. A model of a base and six joints has seven rows, as in table 1 of the paper, followed by what the
/// last joint carries: the tip, or a point of a surface.
///
///
/// ```
/// use elbowroom_kinematics::dh::DirectTable;
/// use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// use elbowroom_spatial::{Pose, Vec3};
///
/// let joint = |i: usize, at: Vec3, axis: Vec3| Joint {
///     name: format!("joint_{i}"), kind: JointKind::Revolute, parent: LinkId(i - 1), child: LinkId(i),
///     origin: Pose::from_translation(at), axis, limits: Limits::symmetric(3.0), mimic: None,
/// };
/// let joints = vec![joint(1, Vec3::Z * 0.75, Vec3::Z), joint(2, Vec3::new(0.35, 0.1, 0.2), Vec3::Y)];
/// let chain = Chain::new("arm", ["base", "column", "arm"].map(String::from).to_vec(), joints)?;
/// let direct = DirectTable::extract_to(&chain, chain.tip(), Pose::from_translation(Vec3::X * 1.25));
/// assert_eq!(direct.frames, ["base", "joint_1", "joint_2", "arm"]);
/// assert!(direct.table.residual < 1e-12);
/// println!("{direct}"); // frame, joint, a, b, d, α, θ
/// # Ok::<(), elbowroom_kinematics::ChainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DirectTable {
    /// The frame after each row: a link if the frame has no joint, else the joint that acts in it (from the next row
    /// on). An auxiliary frame has the name of the frame that it precedes, with a `*`.
    pub frames: Vec<String>,
    /// The rows and their residual with respect to the chain.
    pub table: GeneralizedTable,
}

impl DirectTable {
    /// Extracts the frames from the root link to the link `tip`. Works for every chain.
    pub fn extract(chain: &Chain, tip: LinkId) -> Self {
        Self::extract_to(chain, tip, Pose::IDENTITY)
    }

    /// Like [`DirectTable::extract`], up to a frame fixed on the link `tip` (m): a tool, or a point of a surface.
    pub fn extract_to(chain: &Chain, tip: LinkId, tool_in_tip: Pose) -> Self {
        let mut rows = Rows {
            frames: vec![chain.links()[chain.root().0].clone()],
            list: vec![GeneralizedRow::IDENTITY],
            joint: None,
        };
        let mut pending = Pose::IDENTITY; // since the frame of the last row
        for id in chain.path(tip) {
            let next = &chain.joints()[id.0];
            let frame = pending * next.origin;
            if next.kind == JointKind::Fixed {
                rows.push(&chain.links()[next.child.0], &frame);
                pending = Pose::IDENTITY;
                continue;
            }
            let rotation = if next.axis == Vec3::Z { Rotation::IDENTITY } else { one_row_rotation(&frame, next.axis) };
            let rotation = Pose::new(rotation, Vec3::ZERO);
            rows.push(&next.name, &(frame * rotation));
            rows.joint = Some((next.name.clone(), next.kind));
            // The joint moves everything after its frame; rotating back gives the link's own frame.
            pending = rotation.inverse();
        }
        let end = pending * tool_in_tip;
        if rows.joint.is_some() || end != Pose::IDENTITY {
            rows.push(&chain.links()[tip.0], &end);
        }
        let mut table = GeneralizedTable { rows: rows.list, residual: 0.0 };
        table.residual = residual(chain, tip, tool_in_tip, |value| table.tip_in_root(value));
        Self { frames: rows.frames, table }
    }
}

/// The table under construction.
struct Rows {
    frames: Vec<String>,
    list: Vec<GeneralizedRow>,
    /// The joint that acts in the last frame and therefore belongs to the next row.
    joint: Option<(String, JointKind)>,
}

impl Rows {
    fn push(&mut self, name: &str, t: &Pose) {
        let joint = self.joint.take();
        if let Some(row) = exact_row(t) {
            self.list.push(with_joint(row, joint));
        } else {
            let (row, rest) = row_and_rest(t);
            self.frames.push(format!("{name}*"));
            self.list.push(with_joint(row, joint));
            self.list.push(along_z(&rest));
        }
        self.frames.push(name.to_owned());
    }
}

/// The rotation of a frame that takes its z axis onto `axis` and makes entry (3,1) of its row 0.
fn one_row_rotation(frame: &Pose, axis: Vec3) -> Rotation {
    let onto = z_onto(axis);
    let [x, y, _] = (frame.rotation * onto).rows()[2];
    // x·cos φ + y·sin φ = 0, with the smaller angle; of two quarter turns the positive one, independent of rounding.
    let angle = if x.abs() < 1e-12 { 0.0 } else { (-x / y).atan() };
    let angle = if angle < 1e-9 - FRAC_PI_2 { angle + PI } else { angle };
    onto.rotated_about(2, angle)
}

/// Prints the columns of table 1 of Reichenbach and Kovačić 2003: lengths in m, angles in rad.
impl fmt::Display for DirectTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widest = |names: &mut dyn Iterator<Item = usize>| names.max().unwrap_or(0).max(5);
        let frame = widest(&mut self.frames.iter().map(|n| n.chars().count()));
        let joint = widest(&mut self.table.rows.iter().map(|r| r.joint.as_ref().map_or(0, |n| n.chars().count())));
        let head = ["a", "b", "d", "alpha", "theta"].map(|h| format!("{h:>9}")).join("");
        write!(f, "{:<frame$}  {:<joint$}{head}", "frame", "q of")?;
        for (name, row) in self.frames.iter().zip(&self.table.rows) {
            let cells = [row.a, row.b, row.d, row.alpha, row.theta].map(|v| format!("{:>9.3}", round(v))).join("");
            write!(f, "\n{name:<frame$}  {:<joint$}{cells}", row.joint.as_deref().unwrap_or(""))?;
        }
        Ok(())
    }
}

/// Rounds to the last digit shown; adding 0 removes the sign of a zero.
fn round(v: f64) -> f64 {
    (v * 1e3).round() / 1e3 + 0.0
}
