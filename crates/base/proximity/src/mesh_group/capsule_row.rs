//! Sixteen capsules around meshes, and the test which of them may touch another capsule.

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, prelude::*};

use super::sphere_row::LANES;
use crate::TriMesh;
use crate::lanes::{V3, W16, load16, splat16};

/// Squared sine of the angle of two axes below which they count as parallel.
const PARALLEL: f32 = 1e-5;

/// A capsule around a mesh, in the frame of the mesh; lengths in m.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundingCapsule {
    pub middle: Vec3,
    /// Direction of the axis, of length 1.
    pub axis: Vec3,
    pub half_length: f64,
    pub radius: f64,
    /// Upper bound of the distance from the origin to the farthest point of the mesh.
    pub reach: f64,
}

/// Lengths of up to sixteen capsules, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct CapsuleRow {
    pub half_length: [f32; LANES],
    pub radius: [f32; LANES],
    /// Bit mask of the lanes in use.
    pub used: u32,
}

/// Positions of the capsules of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedRow {
    pub middle: [[f32; LANES]; 3],
    pub axis: [[f32; LANES]; 3],
}

/// One capsule of a row, with its position.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedCapsule {
    middle: [f32; 3],
    axis: [f32; 3],
    half_length: f32,
    radius: f32,
}

impl BoundingCapsule {
    pub fn of(mesh: &TriMesh) -> Self {
        let reach = mesh.aabb().max_distance(Vec3::ZERO);
        if let Some((capsule, in_mesh)) = mesh.enclosing_capsule() {
            let (middle, axis) = (in_mesh.translation, in_mesh.rotation * Vec3::Z);
            return Self { middle, axis, half_length: capsule.half_length, radius: capsule.radius, reach };
        }
        let (middle, radius) = (mesh.aabb().center(), 0.5 * mesh.aabb().extent().length());
        Self { middle, axis: Vec3::Z, half_length: 0.0, radius, reach }
    }
}

impl PlacedRow {
    pub const EMPTY: Self = Self { middle: [[0.0; LANES]; 3], axis: [[0.0; LANES]; 3] };
}

impl CapsuleRow {
    pub fn new(capsules: &[BoundingCapsule]) -> Self {
        let mut row = Self { half_length: [0.0; LANES], radius: [0.0; LANES], used: 0 };
        for (lane, capsule) in capsules.iter().enumerate().take(LANES) {
            row.half_length[lane] = capsule.half_length as f32;
            row.radius[lane] = capsule.radius as f32;
            row.used |= 1 << lane;
        }
        row
    }

    #[inline(always)]
    pub fn capsule(&self, placed: &PlacedRow, lane: usize) -> PlacedCapsule {
        let of = |rows: &[[f32; LANES]; 3]| [rows[0][lane], rows[1][lane], rows[2][lane]];
        PlacedCapsule {
            middle: of(&placed.middle),
            axis: of(&placed.axis),
            half_length: self.half_length[lane],
            radius: self.radius[lane],
        }
    }

    /// The lanes whose bounding spheres are not proven to be farther than `error` from the bounding sphere of a capsule.
    /// The axes are not read.
    #[inline(always)]
    pub fn near_spheres<S: Simd>(&self, simd: S, placed: &PlacedRow, one: &PlacedCapsule, error: f32) -> u32 {
        let between = splat16(simd, one.middle).minus(load16(simd, &placed.middle));
        let own = W16::load_array_ref(simd, &self.radius) + W16::load_array_ref(simd, &self.half_length);
        let reach = own + W16::splat(simd, one.radius + one.half_length + error);
        !(between.dot(between).simd_gt(reach * reach).to_bitmask() as u32) & self.used
    }

    /// The lanes whose capsules are not proven to be farther than `error` from a capsule.
    #[inline(always)]
    pub fn near_capsules<S: Simd>(&self, simd: S, placed: &PlacedRow, one: &PlacedCapsule, error: f32) -> u32 {
        let between = splat16(simd, one.middle).minus(load16(simd, &placed.middle));
        let (u, v) = (splat16(simd, one.axis), load16(simd, &placed.axis));
        let half_lengths = [W16::splat(simd, one.half_length), W16::load_array_ref(simd, &self.half_length)];
        let n = separating_direction(simd, between, [u, v], half_lengths);
        // For any direction, the gap along it is a lower bound.
        let gap = n.dot(between) - (n.dot(u).abs() * half_lengths[0] + n.dot(v).abs() * half_lengths[1]);
        let radii = W16::load_array_ref(simd, &self.radius) + W16::splat(simd, one.radius + error);
        let is_apart = gap.simd_gt(W16::splat(simd, 0.0)) & (gap * gap).simd_gt(radii * radii * n.dot(n));
        !(is_apart.to_bitmask() as u32) & self.used
    }
}

/// The direction between approximate nearest points of two segments in each lane; `between` joins the segments'
/// middles.
#[inline(always)]
fn separating_direction<S: Simd>(
    simd: S,
    between: V3<W16<S>>,
    [u, v]: [V3<W16<S>>; 2],
    [half_u, half_v]: [W16<S>; 2],
) -> V3<W16<S>> {
    let cosine = u.dot(v);
    let (along_u, along_v) = (u.dot(between), v.dot(between));
    let square_sine = (W16::splat(simd, 1.0) - cosine * cosine).max(W16::splat(simd, PARALLEL));
    let s = clamped((cosine * along_v - along_u) / square_sine, half_u);
    let t = clamped(along_v + s * cosine, half_v);
    let s = clamped(t * cosine - along_u, half_u);
    between.plus(u.times(s)).minus(v.times(t))
}

#[inline(always)]
fn clamped<S: Simd>(x: W16<S>, limit: W16<S>) -> W16<S> {
    x.min(limit).max(-limit)
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Pose, Rotation};
    use elbowroom_testkit::random::SplitMix;
    use fearless_simd::dispatch;

    use super::*;
    use crate::Shape;
    use crate::lanes::{detected_simd_level, narrow};
    use crate::{Capsule, separation};

    /// Excluded lanes are apart by the exact distance; few lanes that are apart by a millimetre are kept.
    #[test]
    fn capsules_that_are_left_out_are_apart() {
        let mut random = SplitMix(8);
        let error = 1e-5;
        let (mut apart, mut kept) = (0, 0);
        for _ in 0..3000 {
            let mut draw = || {
                let axis = Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
                // Some are parallel to an axis, some are balls.
                let axis =
                    if random.between(0.0, 1.0) < 0.3 { Vec3::X } else { axis.try_normalize().unwrap_or(Vec3::Y) };
                let half_length = if random.between(0.0, 1.0) < 0.2 { 0.0 } else { random.between(0.0, 0.5) };
                let middle = Vec3::new(random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-0.5, 0.5));
                BoundingCapsule { middle, axis, half_length, radius: random.between(0.01, 0.2), reach: 1.0 }
            };
            let all: Vec<_> = (0..13).map(|_| draw()).collect();
            let (row, mut placed) = (CapsuleRow::new(&all), PlacedRow::EMPTY);
            for (lane, c) in all.iter().enumerate() {
                for k in 0..3 {
                    placed.middle[k][lane] = narrow(c.middle)[k];
                    placed.axis[k][lane] = narrow(c.axis)[k];
                }
            }
            let one = row.capsule(&placed, 0);
            let near = dispatch!(detected_simd_level(), simd => row.near_capsules(simd, &placed, &one, error));
            let spheres = dispatch!(detected_simd_level(), simd => row.near_spheres(simd, &placed, &one, error));
            assert_eq!((near | spheres) >> all.len(), 0, "lanes not in use");
            for (lane, c) in all.iter().enumerate() {
                let solid = |c: &BoundingCapsule| {
                    let capsule = Capsule { half_length: c.half_length, radius: c.radius };
                    (Shape::Capsule(capsule), Pose::new(Rotation::from_z(c.axis), c.middle))
                };
                let ((a, at), (b, there)) = (solid(&all[0]), solid(c));
                let metres = separation(&a, &at, &b, &there).distance;
                let is_kept = near >> lane & 1 == 1;
                assert!(is_kept || metres > 0.0, "{:?} {c:?}", all[0]);
                assert!(spheres >> lane & 1 == 1 || metres > 0.0, "{:?} {c:?}", all[0]);
                apart += usize::from(metres > 1e-3);
                kept += usize::from(metres > 1e-3 && is_kept);
            }
        }
        assert!(kept * 50 < apart, "{kept} of {apart}");
    }
}
