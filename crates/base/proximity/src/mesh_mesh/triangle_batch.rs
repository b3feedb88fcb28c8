//! Pairs of triangles that are measured together in f64, and the exact measurement of a single one.

use elbowroom_spatial::Vec3;
use fearless_simd::{Level as SimdLevel, dispatch};

use super::relative_placement::RelativePlacement;
use super::triangle_kernel::{BATCH, Corners, Distances, distances};
use crate::TriMesh;
use crate::triangle::{ClosestPoints, triangle_triangle};

/// Up to eight pairs of triangles that are measured together.
#[derive(Debug, Clone)]
pub(super) struct TriangleBatch {
    pub triangles: [(u32, u32); BATCH],
    len: usize,
    corners: Corners,
}

impl TriangleBatch {
    pub const fn new() -> Self {
        Self { triangles: [(0, 0); BATCH], len: 0, corners: Corners::ZERO }
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a pair of slots; true if the batch is full.
    #[inline(always)]
    pub fn push(&mut self, a: &TriMesh, slot_a: u32, b: &TriMesh, slot_b: u32) -> bool {
        let (ta, tb) = (a.bvh.triangle(slot_a), b.bvh.triangle(slot_b));
        let lane = self.len;
        self.triangles[lane] = (ta as u32, tb as u32);
        let (pa, pb) = (a.triangles()[ta], b.triangles()[tb]);
        for k in 0..3 {
            let (p, q) = (a.vertices()[pa[k] as usize], b.vertices()[pb[k] as usize]);
            let (to_a, to_b) = (&mut self.corners.a[k], &mut self.corners.b[k]);
            (to_a[0][lane], to_a[1][lane], to_a[2][lane]) = (p.x, p.y, p.z);
            (to_b[0][lane], to_b[1][lane], to_b[2][lane]) = (q.x, q.y, q.z);
        }
        self.len += 1;
        self.len == BATCH
    }

    /// Measures all pairs and empties the batch. The second value is the number `len` of pairs; lanes from `len` on are
    /// undefined.
    pub fn measure(&mut self, simd_level: SimdLevel, placement: &RelativePlacement) -> (Distances, usize) {
        let len = std::mem::take(&mut self.len);
        (dispatch!(simd_level, simd => distances(simd, &self.corners, placement)), len)
    }
}

/// Corners of a triangle in its mesh's unit frame.
#[inline(always)]
fn unit_corners(mesh: &TriMesh, triangle: usize) -> [Vec3; 3] {
    let [p, q, r] = mesh.triangles()[triangle];
    let at = |i: u32| mesh.bvh.frame.to_units(mesh.vertices()[i as usize]);
    [at(p), at(q), at(r)]
}

/// Corners of a triangle of each mesh, in units and axes of A.
#[inline(always)]
pub(super) fn corners_in_a(
    a: &TriMesh,
    ta: usize,
    b: &TriMesh,
    tb: usize,
    placement: &RelativePlacement,
) -> ([Vec3; 3], [Vec3; 3]) {
    let [p, q, r] = unit_corners(b, tb);
    (unit_corners(a, ta), [placement.map_to_a(p), placement.map_to_a(q), placement.map_to_a(r)])
}

/// Closest points of two triangles by the robust scalar method, in units and axes of A.
pub(super) fn robust_closest_points(
    a: &TriMesh,
    ta: usize,
    b: &TriMesh,
    tb: usize,
    placement: &RelativePlacement,
) -> ClosestPoints {
    let (s, t) = corners_in_a(a, ta, b, tb, placement);
    triangle_triangle(s, t)
}
