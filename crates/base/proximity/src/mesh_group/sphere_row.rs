//! Sixteen spheres of a mesh, and the overlap of the spheres of two meshes.

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::group_frame::PoseF32;
use crate::lanes::{W16, load16, rows16, splat16, store16};

/// Number of spheres of a row.
pub(super) const LANES: usize = 16;

/// Up to sixteen spheres; unused lanes repeat the first one.
#[derive(Debug, Clone, Copy)]
pub(super) struct SphereRow {
    centres: [[f32; LANES]; 3],
    /// Radii, m.
    radii: [f32; LANES],
    used: usize,
}

impl SphereRow {
    pub const EMPTY: Self = Self { centres: [[0.0; LANES]; 3], radii: [0.0; LANES], used: 0 };

    /// Creates a row from centres and radii, m; uses at most the first sixteen.
    pub fn new(spheres: &[(Vec3, f64)]) -> Self {
        let mut row = Self { used: spheres.len().min(LANES), ..Self::EMPTY };
        for lane in 0..LANES {
            let Some((centre, radius)) = spheres.get(lane).or(spheres.first()) else { return row };
            for (axis, x) in centre.to_array().into_iter().enumerate() {
                row.centres[axis][lane] = x as f32;
            }
            row.radii[lane] = *radius as f32;
        }
        row
    }

    pub fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Places the spheres at a pose.
    #[inline(always)]
    pub fn place<S: Simd>(&self, simd: S, pose: &PoseF32, placed: &mut Self) {
        let centres = load16(simd, &self.centres).placed(&rows16(simd, &pose.rows), splat16(simd, pose.shift));
        placed.centres = store16(centres);
        placed.radii = self.radii;
        placed.used = self.used;
    }

    /// The largest difference (m²) over all pairs of spheres: the square of the sum of both radii and `more`, minus the
    /// square of the distance of the centres.
    ///
    /// If it is positive, two spheres overlap, even if each pair's radii are less by `-more` metres; if it is negative,
    /// none do. Negative infinity if a row is empty.
    #[inline(always)]
    pub fn deepest<S: Simd>(&self, simd: S, other: &Self, more: f32) -> f32 {
        if other.is_empty() {
            return f32::NEG_INFINITY;
        }
        let centres = load16(simd, &other.centres);
        let radii = W16::load_array_ref(simd, &other.radii) + W16::splat(simd, more);
        let zero = W16::splat(simd, 0.0);
        let mut deepest = W16::splat(simd, f32::NEG_INFINITY);
        for lane in 0..self.used {
            let centre = [self.centres[0][lane], self.centres[1][lane], self.centres[2][lane]];
            let apart = centres.minus(splat16(simd, centre));
            let reach = (radii + W16::splat(simd, self.radii[lane])).max(zero);
            deepest = deepest.max(reach * reach - apart.dot(apart));
        }
        deepest.reduce_max()
    }
}
