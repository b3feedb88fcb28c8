//! The kernels that test sixteen balls of the robot in one box of joint space.
//!
//! A box is free of a ball if a plane separates the ball from the obstacle in the whole box. The plane is perpendicular
//! to the shortest connection from the obstacle at the centre of the box. Towards the plane, the ball moves at most by
//! its displacements by half the box along the normal, plus a bound of the curvature.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use elbowroom_validity::lanes::simd::{Simd, f32x16, prelude::*};
use elbowroom_validity::lanes::{PointRow, V3, splat};

use super::block_level::Frame;
use super::cover_class::{CoverGroup, CoverPath, GroupMotion};
use super::obstacle_lanes::CellPose;
use super::solid_core::SolidCore;

/// Half widths of a box: of the axis in lanes, times the joint's multiplier, and of the other axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfWidths {
    pub lanes: f32,
    pub lanes_turn: bool,
    pub others: [f32; 2],
}

/// Sixteen balls at the centre of a box, relative to the first joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroupPlace {
    /// Centres, m.
    pub centres: PointRow,
    /// Displacements by half the box along each of the two axes that are not in lanes, to first order, m.
    pub along: [PointRow; 2],
}

impl GroupPlace {
    pub const ZERO: Self = Self { centres: PointRow::ZERO, along: [PointRow::ZERO; 2] };

    #[inline(always)]
    pub fn compute<S: Simd>(
        &mut self,
        simd: S,
        group: &CoverGroup,
        path: &CoverPath,
        frames: &[Frame],
        half: HalfWidths,
    ) {
        let Frame { columns: [x, y, z], origin } = &frames[path.last as usize];
        let local = group.centres.load(simd);
        let p = V3::splat(simd, *x).times_plus(local.0, V3::splat(simd, *origin));
        let p = V3::splat(simd, *y).times_plus(local.1, p);
        let p = V3::splat(simd, *z).times_plus(local.2, p);
        self.centres.store(p);
        self.along = [PointRow::ZERO; 2];
        for step in &path.steps {
            let Frame { columns: [_, _, z], origin } = &frames[step.step as usize];
            let by = step.multiplier * half.others[step.axis];
            let along = V3::splat(simd, [z[0] * by, z[1] * by, z[2] * by]);
            let velocity = if step.turns { cross(along, p.minus(V3::splat(simd, *origin))) } else { along };
            let sum = self.along[step.axis].load(simd).plus(velocity);
            self.along[step.axis].store(sum);
        }
    }
}

/// A solid around a point of the obstacle's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub core: SolidCore,
    pub centre: [f32; 3],
    /// Radius of the solid, with an allowance for rounding errors, m.
    pub reach: f32,
}

/// Balls of a group that are not proven apart from a solid in the whole box, one bit each.
#[inline(always)]
pub(super) fn near_balls<S: Simd>(
    simd: S,
    group: &CoverGroup,
    place: &GroupPlace,
    motion: &GroupMotion,
    pose: &CellPose,
    target: &Target,
    half: HalfWidths,
) -> u32 {
    let arm = place.centres.load(simd);
    let PoseSplat { x, y, z, origin } = PoseSplat::new(simd, pose, target.centre);
    let p = z.times_plus(arm.2, y.times_plus(arm.1, x.times_plus(arm.0, origin)));
    let vector = target.core.vector_to(simd, p);
    let squared = vector.dot(vector);
    let reach = group.radii.load(simd) + splat(simd, target.reach);
    let far = reach + motion.paths.load(simd);
    let near = group.lanes & !(squared.simd_gt(far * far).to_bitmask() as u32);
    if near == 0 {
        return 0;
    }
    let u = V3(x.dot(vector), y.dot(vector), z.dot(vector));
    let mut needed = squared.sqrt() * (reach + motion.curvatures.load(simd));
    let lanes = splat(simd, half.lanes);
    let along_lanes = if half.lanes_turn { u.1 * arm.0 - u.0 * arm.1 } else { u.2 };
    needed += (along_lanes * lanes).abs();
    needed += u.dot(place.along[0].load(simd)).abs();
    needed += u.dot(place.along[1].load(simd)).abs();
    near & !(squared.simd_gt(needed).to_bitmask() as u32)
}

/// Distances of a group's balls from a solid at the centre of the box, minus the sums of the radii: at most 0 if they
/// touch. `reach` of the target is its radius minus rounding errors.
#[inline(always)]
pub(super) fn gaps<S: Simd>(
    simd: S,
    group: &CoverGroup,
    place: &GroupPlace,
    pose: &CellPose,
    target: &Target,
) -> f32x16<S> {
    let arm = place.centres.load(simd);
    let PoseSplat { x, y, z, origin } = PoseSplat::new(simd, pose, target.centre);
    let p = z.times_plus(arm.2, y.times_plus(arm.1, x.times_plus(arm.0, origin)));
    let reach = group.radii.load(simd) + splat(simd, target.reach);
    target.core.signed_distance(simd, p) - reach
}

/// Lanes whose value is at most a limit, one bit each; false for NaN.
#[inline(always)]
pub(super) fn at_most<S: Simd>(v: f32x16<S>, limit: f32x16<S>) -> u32 {
    v.simd_le(limit).to_bitmask() as u32
}

#[inline(always)]
fn cross<S: Simd>(a: V3<S>, b: V3<S>) -> V3<S> {
    V3(a.1 * b.2 - a.2 * b.1, a.2 * b.0 - a.0 * b.2, a.0 * b.1 - a.1 * b.0)
}

/// A pose in all lanes, with its origin relative to a point.
struct PoseSplat<S: Simd> {
    x: V3<S>,
    y: V3<S>,
    z: V3<S>,
    origin: V3<S>,
}

// Without closures, because closures are compiled for the lowest instruction set.
impl<S: Simd> PoseSplat<S> {
    #[inline(always)]
    fn new(simd: S, pose: &CellPose, from: [f32; 3]) -> Self {
        let [x, y, z] = pose.columns;
        let at = [pose.origin[0] - from[0], pose.origin[1] - from[1], pose.origin[2] - from[2]];
        Self { x: V3::splat(simd, x), y: V3::splat(simd, y), z: V3::splat(simd, z), origin: V3::splat(simd, at) }
    }
}
