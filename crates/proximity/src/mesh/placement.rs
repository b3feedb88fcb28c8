//! Where the second mesh is in the first, in both precisions, and how far f32 may be wrong about it.

use elbowroom_spatial::{Pose, Vec3};

use super::tree::{Frame, Tree};

/// One mesh (Y) seen from the other (X), in units of X: `x = m·y + t`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    /// Rotation alone.
    pub r: [[f32; 3]; 3],
    /// Rotation times the ratio of units.
    pub m: [[f32; 3]; 3],
    pub abs: [[f32; 3]; 3],
    pub t: [f32; 3],
    /// Units of X per unit of Y.
    pub scale: f32,
}

/// Both directions, and the same in f64.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pairing {
    pub ab: Placement,
    pub ba: Placement,
    pub frame_a: Frame,
    pub frame_b: Frame,
    /// Rows of the map from units of B to units of A, translation last.
    pub exact: [[f64; 4]; 3],
    /// No f32 gap of boxes, slabs or triangles is off by more, in units of A. See README.md, "Error bounds".
    pub doubt: f64,
    /// No f64 distance of two triangles is off by more, in units of A; nearer than this is contact.
    pub slack: f64,
}

impl Pairing {
    pub fn new(a: &Tree, a_in_world: &Pose, b: &Tree, b_in_world: &Pose) -> Self {
        let rows = (a_in_world.rotation.inverse() * b_in_world.rotation).rows();
        let t = offset(&a.frame, a_in_world, &b.frame, b_in_world);
        let t = (a_in_world.rotation.inverse_rotate(t) / a.frame.unit).to_array();
        let scale = b.frame.unit / a.frame.unit;
        let exact = std::array::from_fn(|i| [rows[i][0] * scale, rows[i][1] * scale, rows[i][2] * scale, t[i]]);
        let columns: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        let back =
            std::array::from_fn(|i| -(columns[i][0] * t[0] + columns[i][1] * t[1] + columns[i][2] * t[2]) / scale);
        // Bounds every coordinate in units of A, up to √3.
        let extent = 1.0 + scale + t[0].abs().max(t[1].abs()).max(t[2].abs());
        let lost = lost_in_world(&a.frame, a_in_world, &b.frame, b_in_world) / a.frame.unit;
        Self {
            ab: placement(rows, t, scale),
            ba: placement(columns, back, 1.0 / scale),
            exact,
            frame_a: a.frame,
            frame_b: b.frame,
            doubt: extent * F32_DOUBT,
            slack: extent * F64_SLACK + lost,
        }
    }

    /// False where numbers are NaN, infinite or so large beside the meshes that f64 has no digits left for them.
    #[inline]
    pub fn is_usable(&self) -> bool {
        self.slack.is_finite() && self.doubt < F32_DOUBT * 1e15
    }

    /// A point of B's tree frame in A's.
    #[inline]
    pub fn in_a(&self, p: Vec3) -> Vec3 {
        let row = |r: &[f64; 4]| r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
        Vec3::new(row(&self.exact[0]), row(&self.exact[1]), row(&self.exact[2]))
    }
}

/// 2⁻¹⁷ = 128 half-units of rounding per unit of extent; README.md counts 75 for the worst test.
const F32_DOUBT: f64 = 1.0 / 131_072.0;
/// 2⁻⁴⁰; README.md, "Triangles in f64".
const F64_SLACK: f64 = 1.0 / 1_099_511_627_776.0;

/// From centre to centre, metres, world axes.
#[inline]
fn offset(a: &Frame, a_in_world: &Pose, b: &Frame, b_in_world: &Pose) -> Vec3 {
    let apart = b_in_world.translation - a_in_world.translation;
    apart + b_in_world.rotation * b.center - a_in_world.rotation * a.center
}

/// What rounding of positions in the world, and of the frames' places in their meshes, may be worth, metres.
#[inline]
fn lost_in_world(a: &Frame, a_in_world: &Pose, b: &Frame, b_in_world: &Pose) -> f64 {
    let reach = |p: &Pose, f: &Frame| p.translation.abs().max_element() + f.center.abs().max_element();
    16.0 * f64::EPSILON * (reach(a_in_world, a) + reach(b_in_world, b))
}

/// True where the balls around two meshes are so much farther apart than `limit` metres that triangles would be, too,
/// however they are rounded: at least twice [`Pairing::slack`].
#[inline]
pub(super) fn apart(a: &Tree, a_in_world: &Pose, b: &Tree, b_in_world: &Pose, limit: f64) -> bool {
    let between = offset(&a.frame, a_in_world, &b.frame, b_in_world);
    let extent = a.frame.unit + b.frame.unit + between.x.abs() + between.y.abs() + between.z.abs();
    let slack = extent * F64_SLACK + lost_in_world(&a.frame, a_in_world, &b.frame, b_in_world);
    let reach = (a.radius + b.radius + limit) * (1.0 + 1e-12) + 2.0 * slack;
    // Infinite and NaN are left to those who can say so.
    let squared = between.length_squared();
    squared.is_finite() && squared > reach * reach && a_in_world.is_finite() && b_in_world.is_finite()
}

fn placement(rows: [[f64; 3]; 3], t: [f64; 3], scale: f64) -> Placement {
    let m = rows.map(|row| row.map(|x| (x * scale) as f32));
    Placement {
        r: rows.map(|row| row.map(|x| x as f32)),
        m,
        abs: m.map(|row| row.map(f32::abs)),
        t: t.map(|x| x as f32),
        scale: scale as f32,
    }
}
