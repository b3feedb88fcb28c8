//! The placement of the second mesh relative to the first in f32 and f64, and the error bounds of f32 and f64.

use elbowroom_spatial::{Pose, Vec3};

use crate::bvh::{Bvh16, UnitFrame};
use crate::lanes::F32_ERROR;

/// The placement of one mesh (Y) in the other (X), in units of X: `x = m·y + t`.
#[derive(Debug, Clone, Copy)]
pub(super) struct AffineF32 {
    /// Rotation alone.
    pub r: [[f32; 3]; 3],
    /// Rotation times the ratio of units.
    pub m: [[f32; 3]; 3],
    pub abs: [[f32; 3]; 3],
    pub t: [f32; 3],
    /// Units of X per unit of Y.
    pub scale: f32,
}

/// Both directions in f32, and B in A in f64.
#[derive(Debug, Clone, Copy)]
pub(super) struct RelativePlacement {
    pub b_in_a: AffineF32,
    pub a_in_b: AffineF32,
    pub frame_a: UnitFrame,
    pub frame_b: UnitFrame,
    /// Rows of the map from units of B to units of A; translation in the last column.
    pub exact: [[f64; 4]; 3],
    /// Upper bound of the error of every f32 gap of boxes, slabs or triangles, in units of A. See README.md, "Error
    /// bounds".
    pub f32_error: f64,
    /// Upper bound of the error of every f64 distance of two triangles, in units of A; smaller distances are contact.
    pub f64_error: f64,
}

impl RelativePlacement {
    pub fn new(a: &Bvh16, a_in_world: &Pose, b: &Bvh16, b_in_world: &Pose) -> Self {
        let rows = (a_in_world.rotation.inverse() * b_in_world.rotation).rows();
        let t = offset(&a.frame, a_in_world, &b.frame, b_in_world);
        let t = (a_in_world.rotation.inverse_rotate(t) / a.frame.unit).to_array();
        let scale = b.frame.unit / a.frame.unit;
        let exact = std::array::from_fn(|i| [rows[i][0] * scale, rows[i][1] * scale, rows[i][2] * scale, t[i]]);
        let columns: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        let back =
            std::array::from_fn(|i| -(columns[i][0] * t[0] + columns[i][1] * t[1] + columns[i][2] * t[2]) / scale);
        // Bounds every coordinate in units of A, up to a factor of √3.
        let extent = 1.0 + scale + t[0].abs().max(t[1].abs()).max(t[2].abs());
        let world_rounding = world_rounding(&a.frame, a_in_world, &b.frame, b_in_world) / a.frame.unit;
        Self {
            b_in_a: affine_f32(rows, t, scale),
            a_in_b: affine_f32(columns, back, 1.0 / scale),
            exact,
            frame_a: a.frame,
            frame_b: b.frame,
            f32_error: extent * F32_ERROR,
            f64_error: extent * F64_ERROR + world_rounding,
        }
    }

    /// False if numbers are NaN, infinite, or so large compared with the meshes that f64 has no digits left for the
    /// meshes.
    #[inline]
    pub fn is_usable(&self) -> bool {
        self.f64_error.is_finite() && self.f32_error < F32_ERROR * 1e15
    }

    /// Rotates a unit vector from A's axes to B's axes.
    #[inline]
    pub fn direction_to_b(&self, d: Vec3) -> Vec3 {
        let [x, y, z] = &self.exact;
        let along = |k: usize| (x[k] * d.x + y[k] * d.y + z[k] * d.z) * (self.frame_a.unit * self.frame_b.inverse);
        Vec3::new(along(0), along(1), along(2))
    }

    /// Maps a point from B's unit frame to A's unit frame.
    #[inline]
    pub fn map_to_a(&self, p: Vec3) -> Vec3 {
        let row = |r: &[f64; 4]| r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
        Vec3::new(row(&self.exact[0]), row(&self.exact[1]), row(&self.exact[2]))
    }
}

/// 2⁻⁴⁰; README.md, "Triangles in f64".
const F64_ERROR: f64 = 1.0 / 1_099_511_627_776.0;

/// Vector from centre to centre, metres, world axes.
#[inline]
fn offset(a: &UnitFrame, a_in_world: &Pose, b: &UnitFrame, b_in_world: &Pose) -> Vec3 {
    let apart = b_in_world.translation - a_in_world.translation;
    apart + b_in_world.rotation * b.center - a_in_world.rotation * a.center
}

/// Upper bound of the rounding of positions in the world and of the unit frames' centres in their meshes, metres.
#[inline]
fn world_rounding(a: &UnitFrame, a_in_world: &Pose, b: &UnitFrame, b_in_world: &Pose) -> f64 {
    let reach = |p: &Pose, f: &UnitFrame| p.translation.abs().max_element() + f.center.abs().max_element();
    16.0 * f64::EPSILON * (reach(a_in_world, a) + reach(b_in_world, b))
}

/// True if the bounding spheres of two meshes are so much farther apart than `limit` metres that the triangles are
/// too, whatever the rounding: by at least twice [`RelativePlacement::f64_error`].
#[inline]
pub(super) fn spheres_farther_than(a: &Bvh16, a_in_world: &Pose, b: &Bvh16, b_in_world: &Pose, limit: f64) -> bool {
    let between = offset(&a.frame, a_in_world, &b.frame, b_in_world);
    let extent = a.frame.unit + b.frame.unit + between.x.abs() + between.y.abs() + between.z.abs();
    let error = extent * F64_ERROR + world_rounding(&a.frame, a_in_world, &b.frame, b_in_world);
    let reach = (a.radius + b.radius + limit) * (1.0 + 1e-12) + 2.0 * error;
    // An infinity or NaN proves nothing here; `is_usable` reports it.
    let squared = between.length_squared();
    squared.is_finite() && squared > reach * reach && a_in_world.is_finite() && b_in_world.is_finite()
}

fn affine_f32(rows: [[f64; 3]; 3], t: [f64; 3], scale: f64) -> AffineF32 {
    let m = rows.map(|row| row.map(|x| (x * scale) as f32));
    AffineF32 {
        r: rows.map(|row| row.map(|x| x as f32)),
        m,
        abs: m.map(|row| row.map(f32::abs)),
        t: t.map(|x| x as f32),
        scale: scale as f32,
    }
}
