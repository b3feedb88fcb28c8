//! Triangles clipped to voxels, slab by slab along x, y and z.

use elbowroom_spatial::Vec3;

use super::ball::ROUNDING_M;

/// A convex polygon: a triangle clipped by at most six planes.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [Vec3; 12],
    count: usize,
}

impl Polygon {
    fn range(&self, axis: usize) -> (f64, f64) {
        let values = self.corners[..self.count].iter().map(|p| p[axis]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    }

    /// The part where `sign·(p[axis] − at) <= 0` (Sutherland and Hodgman: *Reentrant polygon clipping*, 1974).
    fn clipped(&self, axis: usize, at: f64, sign: f64) -> Self {
        let mut out = Self { corners: [Vec3::ZERO; 12], count: 0 };
        let beyond = |p: Vec3| sign * (p[axis] - at);
        for i in 0..self.count {
            let (p, next) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (d, e) = (beyond(p), beyond(next));
            if d <= 0.0 {
                out.push(p);
            }
            if (d < 0.0 && e > 0.0) || (d > 0.0 && e < 0.0) {
                out.push(p.lerp(next, d / (d - e)));
            }
        }
        out
    }

    fn push(&mut self, p: Vec3) {
        if self.count < self.corners.len() {
            self.corners[self.count] = p;
            self.count += 1;
        }
    }
}

/// Voxels of one size in space; voxel (0, 0, 0) begins at the origin.
#[derive(Clone, Copy)]
pub(super) struct Lattice {
    pub origin: Vec3,
    pub step_m: f64,
}

impl Lattice {
    /// The voxels of a closed interval along an axis. A value on a border is in the voxels on both sides.
    pub fn range(&self, axis: usize, low: f64, high: f64) -> std::ops::RangeInclusive<i32> {
        let index = |v: f64| ((v - self.origin[axis]) / self.step_m).floor() as i32;
        index(low - ROUNDING_M)..=index(high + ROUNDING_M)
    }

    /// The corner of a voxel with the smallest coordinates.
    pub fn corner(&self, cell: [u32; 3]) -> Vec3 {
        let [x, y, z] = cell.map(|c| f64::from(c) * self.step_m);
        self.origin + Vec3::new(x, y, z)
    }

    fn border(&self, axis: usize, index: i32) -> f64 {
        self.origin[axis] + f64::from(index) * self.step_m
    }

    /// Calls `found` with every voxel that a triangle crosses, and the corners of the triangle's part in it.
    pub fn slice(&self, triangle: [Vec3; 3], mut found: impl FnMut([i32; 3], &[Vec3])) {
        let mut corners = [Vec3::ZERO; 12];
        corners[..3].copy_from_slice(&triangle);
        self.slice_axis(&Polygon { corners, count: 3 }, 0, [0; 3], &mut found);
    }

    fn slice_axis(&self, polygon: &Polygon, axis: usize, voxel: [i32; 3], found: &mut impl FnMut([i32; 3], &[Vec3])) {
        if axis == 3 {
            found(voxel, &polygon.corners[..polygon.count]);
            return;
        }
        let (low, high) = polygon.range(axis);
        let range = self.range(axis, low, high);
        let is_single = range.start() == range.end();
        for i in range {
            let mut at = voxel;
            at[axis] = i;
            let part = if is_single {
                *polygon
            } else {
                let above = polygon.clipped(axis, self.border(axis, i) - ROUNDING_M, -1.0);
                above.clipped(axis, self.border(axis, i + 1) + ROUNDING_M, 1.0)
            };
            if part.count > 0 {
                self.slice_axis(&part, axis + 1, at, found);
            }
        }
    }
}
