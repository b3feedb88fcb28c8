//! The f32 kernel of facing: finds which of the 64 pairs of eight triangles against eight may have a local minimum.

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, dispatch, prelude::*};

use super::leaf_kernel::{LeafPair, PairMask};
use super::mesh_pair::MeshPair;
use super::surface_patch::{FacingTest, SQUARE_ERROR, SurfacePatch};
use crate::bvh::LEAF_SIZE;
use crate::lanes::{V3, W8, load8, rows8, splat8};

/// The patches of the triangles of a leaf, one per lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct LeafPatches {
    center: [[f32; LEAF_SIZE]; 3],
    axis: [[f32; LEAF_SIZE]; 3],
    radius: [f32; LEAF_SIZE],
    thickness: [f32; LEAF_SIZE],
    half_angle: [f32; LEAF_SIZE],
    cos: [f32; LEAF_SIZE],
    sin: [f32; LEAF_SIZE],
}

impl LeafPatches {
    /// The patches of up to eight triangles; lanes beyond them are not used.
    pub fn new(patches: &[SurfacePatch]) -> Self {
        let lane = |k: usize| &patches[k.min(patches.len() - 1)];
        Self {
            center: std::array::from_fn(|axis| std::array::from_fn(|k| lane(k).center[axis])),
            axis: std::array::from_fn(|axis| std::array::from_fn(|k| lane(k).cone.axis[axis])),
            radius: std::array::from_fn(|k| lane(k).radius),
            thickness: std::array::from_fn(|k| lane(k).thickness),
            half_angle: std::array::from_fn(|k| lane(k).cone.half_angle),
            cos: std::array::from_fn(|k| lane(k).cone.cos),
            sin: std::array::from_fn(|k| lane(k).cone.sin),
        }
    }

    /// False if the unit vector is outside the cone of a lane.
    #[inline]
    pub fn may_contain(&self, lane: usize, direction: Vec3) -> bool {
        let axis = Vec3::from(self.axis.map(|lanes| f64::from(lanes[lane])));
        axis.dot(direction) >= f64::from(self.cos[lane]) - 1e-6
    }
}

/// The pairs of triangles of two leaves that [may face](SurfacePatch::may_face) each other. `whole_b` is the patch of the
/// leaf of B.
pub(super) fn facing_pairs(
    meshes: &MeshPair,
    leaves: LeafPair,
    (a, b): (&LeafPatches, &LeafPatches),
    whole_b: &SurfacePatch,
    test: &FacingTest,
) -> PairMask {
    let all = leaves.all(meshes);
    dispatch!(meshes.simd_level, simd => {
        let mut rows = faces(simd, &PatchLanes::new(simd, a), &PatchLanes::of_one(simd, whole_b).placed(simd, test), test);
        if rows == 0 {
            return PairMask(0);
        }
        let of_b = PatchLanes::new(simd, b).placed(simd, test);
        let mut left = 0;
        while rows != 0 {
            let i = rows.trailing_zeros() as usize;
            rows &= rows - 1;
            left |= faces(simd, &PatchLanes::of_lane(simd, a, i), &of_b, test) << (8 * i);
        }
        PairMask(left & all.0)
    })
}

/// Patches in registers.
#[derive(Clone, Copy)]
struct PatchLanes<S: Simd> {
    center: V3<W8<S>>,
    axis: V3<W8<S>>,
    radius: W8<S>,
    thickness: W8<S>,
    half_angle: W8<S>,
    cos: W8<S>,
    sin: W8<S>,
}

impl<S: Simd> PatchLanes<S> {
    #[inline(always)]
    fn new(simd: S, patches: &LeafPatches) -> Self {
        let load = |p: &[f32; LEAF_SIZE]| W8::load_array_ref(simd, p);
        Self {
            center: load8(simd, &patches.center),
            axis: load8(simd, &patches.axis),
            radius: load(&patches.radius),
            thickness: load(&patches.thickness),
            half_angle: load(&patches.half_angle),
            cos: load(&patches.cos),
            sin: load(&patches.sin),
        }
    }

    /// The patch of lane `i` in all lanes.
    #[inline(always)]
    fn of_lane(simd: S, p: &LeafPatches, i: usize) -> Self {
        Self {
            center: splat8(simd, [p.center[0][i], p.center[1][i], p.center[2][i]]),
            axis: splat8(simd, [p.axis[0][i], p.axis[1][i], p.axis[2][i]]),
            radius: W8::splat(simd, p.radius[i]),
            thickness: W8::splat(simd, p.thickness[i]),
            half_angle: W8::splat(simd, p.half_angle[i]),
            cos: W8::splat(simd, p.cos[i]),
            sin: W8::splat(simd, p.sin[i]),
        }
    }

    /// A patch in all lanes.
    #[inline(always)]
    fn of_one(simd: S, p: &SurfacePatch) -> Self {
        Self {
            center: splat8(simd, p.center),
            axis: splat8(simd, p.cone.axis),
            radius: W8::splat(simd, p.radius),
            thickness: W8::splat(simd, p.thickness),
            half_angle: W8::splat(simd, p.cone.half_angle),
            cos: W8::splat(simd, p.cone.cos),
            sin: W8::splat(simd, p.cone.sin),
        }
    }

    /// Patches of B in A's frame and units, larger by the errors of f32.
    #[inline(always)]
    fn placed(self, simd: S, test: &FacingTest) -> Self {
        let (scale, error) = (W8::splat(simd, test.scale), W8::splat(simd, test.error));
        Self {
            center: self.center.placed(&rows8(simd, &test.scaled_rows), splat8(simd, test.shift)),
            axis: self.axis.mapped(&rows8(simd, &test.rows)),
            radius: self.radius.mul_add(scale, error),
            thickness: self.thickness.mul_add(scale, error),
            ..self
        }
    }
}

/// The lanes in which the patches face each other, as [`SurfacePatch::may_face`] explains.
#[inline(always)]
fn faces<S: Simd>(simd: S, a: &PatchLanes<S>, b: &PatchLanes<S>, test: &FacingTest) -> u64 {
    let opposite = a.axis.dot(b.axis);
    let cones =
        (a.half_angle + b.half_angle).simd_ge(std::f32::consts::PI) | (a.sin * b.sin - a.cos * b.cos).simd_ge(opposite);
    let way = b.center.minus(a.center);
    let (along_a, along_b) = (way.dot(a.axis), way.dot(b.axis) * -1.0);
    let limit = W8::splat(simd, test.limit);
    let is_between = |along: W8<S>, cos: W8<S>, reach: W8<S>| {
        let below = cos.simd_lt(0.0).select(limit, W8::splat(simd, 0.0));
        (along + reach + below).simd_ge(0.0) & along.simd_le(reach + limit)
    };
    let near = is_between(along_a, a.cos, a.thickness + b.radius) & is_between(along_b, b.cos, a.radius + b.thickness);
    let narrower_a = a.half_angle.simd_le(b.half_angle);
    let along = narrower_a.select(along_a, along_b);
    let widest = narrower_a.select(a.sin, b.sin).mul_add(limit, a.radius + b.radius);
    let beside = (way.dot(way) * (1.0 - SQUARE_ERROR)).simd_le(along.mul_add(along, widest * widest));
    let every_direction = a.cos.max(b.cos).simd_lt(0.0);
    (cones & near & (beside | every_direction)).to_bitmask() & 0xff
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Rotation;
    use elbowroom_testkit::random::Random;

    use super::super::surface_patch::NormalCone;
    use super::*;
    use crate::lanes::detected_simd_level;

    fn vector(random: &mut Random) -> Vec3 {
        Vec3::from(random.within(1.0))
    }

    /// A small flat part, a curved one, or one with normals in every direction.
    fn patch(random: &mut Random) -> SurfacePatch {
        let axis = vector(random).try_normalize().unwrap_or(Vec3::Z);
        let cone = match random.index(4) {
            0 => NormalCone::every_direction(axis),
            1 => NormalCone::around(&[(axis, 0.0)].into_iter(), axis),
            _ => NormalCone::around(&[(axis, 1.5 * random.unit())].into_iter(), axis),
        };
        let radius = 0.3 * random.unit() as f32;
        let center = (vector(random) * 0.6).to_array().map(|v| v as f32);
        SurfacePatch { center, radius, thickness: radius * random.unit() as f32, cone }
    }

    fn facing_test(random: &mut Random) -> FacingTest {
        let rotation =
            Rotation::from_axis_angle(vector(random).try_normalize().unwrap_or(Vec3::X), 3.0 * random.unit());
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| rotation * axis);
        let rows: [[f32; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i] as f32));
        let scale = 0.5 + random.unit() as f32;
        FacingTest {
            rows,
            scaled_rows: rows.map(|row| row.map(|v| v * scale)),
            shift: vector(random).to_array().map(|v| v as f32),
            scale,
            error: 1e-5,
            limit: 0.5 * random.unit() as f32,
        }
    }

    /// The kernel and the scalar test agree but where rounding decides: within 1e-4 of a limit, or of the edge of a cone.
    #[test]
    fn eight_patches_at_once_are_tested_as_one() {
        let (level, mut random) = (detected_simd_level(), Random(23));
        let (mut facing, mut apart, mut undecided) = (0, 0, 0);
        for _ in 0..3_000 {
            let test = facing_test(&mut random);
            let [a, b]: [Vec<SurfacePatch>; 2] = std::array::from_fn(|_| (0..8).map(|_| patch(&mut random)).collect());
            let (leaf_a, leaf_b) = (LeafPatches::new(&a), LeafPatches::new(&b));
            for (i, one) in a.iter().enumerate() {
                let mask = dispatch!(level, simd => {
                    let of_b = PatchLanes::new(simd, &leaf_b).placed(simd, &test);
                    faces(simd, &PatchLanes::of_lane(simd, &leaf_a, i), &of_b, &test)
                });
                for (j, other) in b.iter().enumerate() {
                    let with = |by: f32| {
                        let opened = |p: &SurfacePatch| {
                            let half_angle = (p.cone.half_angle + by).clamp(0.0, std::f32::consts::PI);
                            let cone =
                                NormalCone { half_angle, cos: half_angle.cos(), sin: half_angle.sin(), ..p.cone };
                            SurfacePatch { cone: if p.cone.cos < 0.0 { p.cone } else { cone }, ..*p }
                        };
                        let FacingTest { rows, scaled_rows, shift, scale, error, limit } = test;
                        let test = FacingTest { rows, scaled_rows, shift, scale, error: error + by, limit: limit + by };
                        opened(one).may_face(&opened(other), &test)
                    };
                    let [least, most] = [with(-1e-4), with(1e-4)];
                    let is_facing = mask >> j & 1 == 1;
                    assert!((is_facing || !least) && (!is_facing || most), "{one:?} and {other:?}, {i}, {j}");
                    facing += usize::from(least);
                    apart += usize::from(!most);
                    undecided += usize::from(least != most);
                }
            }
        }
        assert!(facing > 1_000 && apart > 50_000 && undecided < 2_000, "{facing}, {apart}, {undecided}");
    }
}
