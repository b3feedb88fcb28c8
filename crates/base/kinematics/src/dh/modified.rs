//! The modified convention (Craig).

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::generalized::{GeneralizedRow, GeneralizedTable};
use super::residual::residual;
use crate::{Chain, ChainError, Joint, JointKind, Limits, LinkId};

/// One modified row (Craig, "Introduction to Robotics", 1986): `T = Rx(α)·Tx(a)·Rz(θ)·Tz(d)`.
///
/// The joint of a row acts about or along the z axis of the frame *after* the row: its value is added to θ
/// (revolute) or d (prismatic).
#[derive(Debug, Clone, PartialEq)]
pub struct ModifiedRow {
    /// The joint whose value is added to θ (revolute) or d (prismatic); `None` in fixed and auxiliary rows.
    /// A mimic joint has its own name: its value is `multiplier · q(source) + offset`.
    pub joint: Option<String>,
    /// The joint's kind; [`JointKind::Fixed`] if there is none.
    pub kind: JointKind,
    /// Rotation about the x axis of the frame before, rad.
    pub alpha: f64,
    /// Translation along the x axis of the frame before, m.
    pub a: f64,
    /// Rotation about the new z axis at joint value 0, rad.
    pub theta: f64,
    /// Translation along the new z axis, m.
    pub d: f64,
}

impl ModifiedRow {
    /// The frame after the row in the frame before it, at the joint value `q` (rad or m; ignored without a joint).
    pub fn transform(&self, q: f64) -> Pose {
        let (theta, d) = match self.kind {
            JointKind::Fixed => (self.theta, self.d),
            JointKind::Revolute | JointKind::Continuous => (self.theta + q, self.d),
            JointKind::Prismatic => (self.theta, self.d + q),
        };
        let about_x = Rotation::from_axis_angle(Vec3::X, self.alpha);
        let translation = Vec3::X * self.a + about_x * (Vec3::Z * d);
        Pose::new(about_x * Rotation::from_axis_angle(Vec3::Z, theta), translation)
    }

    fn is_identity(&self) -> bool {
        self.joint.is_none() && self.alpha == 0.0 && self.a == 0.0 && self.theta == 0.0 && self.d == 0.0
    }
}

/// The modified rows from the root to a tip.
///
/// The table regroups the factors of the generalized table: `Tx(a)·Rx(α)` of a row and `Rz(θ)·Tz(d)` of the next row
/// are one modified row, because rotation about x and translation along x commute. So the first row of a robot whose
/// first axis is z of the root has α = a = 0, and after the last joint a row without a joint leads to the tip. A
/// generalized row with b (for axes less than a thousandth of a radian from parallel, or at the tip) becomes two
/// auxiliary rows without a joint: `Ty(b) = Rz(π/2)·Tx(b)·Rz(−π/2)`.
///
/// ```
/// use elbowroom_kinematics::dh::{ClassicalRow, ModifiedTable};
/// use elbowroom_kinematics::{Chain, JointKind, Limits};
///
/// let row = |joint: &str, a: f64| ClassicalRow {
///     joint: joint.into(), kind: JointKind::Revolute, a, alpha: 0.0, d: 0.0, theta: 0.0, limits: Limits::symmetric(3.0),
/// };
/// let planar = Chain::from_dh("planar", &[row("shoulder", 0.4), row("elbow", 0.3)])?;
/// let table = ModifiedTable::extract(&planar, planar.tip());
/// let a: Vec<f64> = table.rows.iter().map(|r| r.a).collect();
/// assert_eq!(a, [0.0, 0.4, 0.3]); // shoulder, elbow, and the transform to the tip
/// assert_eq!(table.rows[2].joint, None);
/// # Ok::<(), elbowroom_kinematics::ChainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ModifiedTable {
    /// The rows, in order from the root.
    pub rows: Vec<ModifiedRow>,
    /// The residual, as in [`GeneralizedTable::residual`].
    pub residual: f64,
}

impl ModifiedTable {
    /// Extracts the modified table of `tip` in the root link, with its residual. Works for every chain.
    pub fn extract(chain: &Chain, tip: LinkId) -> Self {
        Self::extract_to(chain, tip, Pose::IDENTITY)
    }

    /// Like [`ModifiedTable::extract`], up to a frame fixed on the link `tip` (m): a tool, or a point of a surface.
    pub fn extract_to(chain: &Chain, tip: LinkId, tool_in_tip: Pose) -> Self {
        let mut table = Self::from(&GeneralizedTable::extract_to(chain, tip, tool_in_tip));
        table.residual = residual(chain, tip, tool_in_tip, |value| table.tip_in_root(value));
        table
    }

    /// The product of the rows: the tip in the root. `value` returns a joint's value for its name, rad or m.
    pub fn tip_in_root(&self, mut value: impl FnMut(&str) -> f64) -> Pose {
        self.rows.iter().fold(Pose::IDENTITY, |at, row| {
            let q = row.joint.as_deref().map_or(0.0, &mut value);
            at * row.transform(q)
        })
    }

    /// Builds the serial chain of the table without limits. Its links are `base` and, for each row i (from 1), `link_i`:
    /// the row's frame. Rows without a joint become fixed joints `fixed_i`; mimic joints become independent joints.
    ///
    /// # Errors
    /// [`ChainError`] as in [`Chain::new`].
    pub fn to_chain(&self, name: impl Into<String>) -> Result<Chain, ChainError> {
        let mut links = vec!["base".to_owned()];
        let mut joints = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            links.push(format!("link_{}", i + 1));
            joints.push(Joint {
                name: row.joint.clone().unwrap_or_else(|| format!("fixed_{}", i + 1)),
                kind: row.kind,
                parent: LinkId(i),
                child: LinkId(i + 1),
                // Rotation about and translation along z commute with the joint.
                origin: ModifiedRow { kind: JointKind::Fixed, ..row.clone() }.transform(0.0),
                axis: Vec3::Z,
                limits: Limits::UNLIMITED,
                mimic: None,
            });
        }
        Chain::new(name, links, joints)
    }
}

/// Keeps the product and the residual.
impl From<&GeneralizedTable> for ModifiedTable {
    fn from(table: &GeneralizedTable) -> Self {
        let mut rows = Vec::new();
        let mut push = |row: ModifiedRow| {
            if !row.is_identity() {
                rows.push(row);
            }
        };
        let fixed = ModifiedRow { joint: None, kind: JointKind::Fixed, alpha: 0.0, a: 0.0, theta: 0.0, d: 0.0 };
        let (mut alpha, mut a, mut b) = (0.0, 0.0, 0.0);
        for row in &table.rows {
            push_lateral(&mut a, b, &mut push);
            let (joint, kind) = (row.joint.clone(), row.kind);
            push(ModifiedRow { joint, kind, alpha, a, theta: row.theta, d: row.d });
            (alpha, a, b) = (row.alpha, row.a, row.b);
        }
        push_lateral(&mut a, b, &mut push);
        push(ModifiedRow { alpha, a, ..fixed });
        Self { rows, residual: table.residual }
    }
}

/// Pushes `Tx(a)·Ty(b)` as auxiliary rows, before a row that has only α; if b is 0, leaves `a` to that row.
fn push_lateral(a: &mut f64, b: f64, push: &mut impl FnMut(ModifiedRow)) {
    if b == 0.0 {
        return;
    }
    let quarter = std::f64::consts::FRAC_PI_2;
    let auxiliary = |a, theta| ModifiedRow { joint: None, kind: JointKind::Fixed, alpha: 0.0, a, theta, d: 0.0 };
    push(auxiliary(*a, quarter));
    push(auxiliary(b, -quarter));
    *a = 0.0;
}

/// Keeps the product and the residual; all b are 0. If the first row has α or a, a row without a joint precedes it.
impl From<&ModifiedTable> for GeneralizedTable {
    fn from(table: &ModifiedTable) -> Self {
        let mut rows: Vec<GeneralizedRow> = Vec::new();
        for row in &table.rows {
            match rows.last_mut() {
                Some(last) => (last.alpha, last.a) = (row.alpha, row.a),
                None if row.alpha != 0.0 || row.a != 0.0 => {
                    rows.push(GeneralizedRow { alpha: row.alpha, a: row.a, ..GeneralizedRow::IDENTITY });
                }
                None => {}
            }
            let (joint, kind) = (row.joint.clone(), row.kind);
            rows.push(GeneralizedRow { joint, kind, theta: row.theta, d: row.d, ..GeneralizedRow::IDENTITY });
        }
        Self { rows, residual: table.residual }
    }
}
