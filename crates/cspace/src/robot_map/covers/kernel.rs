//! The kernels: sixteen balls of the robot in one box of joint space, and one ball in sixteen boxes.
//!
//! A box is free of a ball if a plane separates the ball from the obstacle in the whole box. The plane is the one across the
//! shortest way from the obstacle at the centre of the box; toward it the ball moves by no more than its displacements by half
//! the box along the normal, and a bound of the curvature.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use elbowroom_validity::lanes::{PointRow, V3, splat};
use fearless_simd::{Simd, f32x16, prelude::*};

use super::block_level::Frame;
use super::cover_class::{CoverGroup, CoverPath, GroupMotion, Probe};
use super::obstacle_lanes::{CellPose, ContactCore, PoseLanes, of_lane};
use super::solid_core::SolidCore;

/// Half widths of a box: of the axis in lanes, times the joint's multiplier, and of the others.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfWidths {
    pub lanes: f32,
    pub lanes_turn: bool,
    pub others: [f32; 2],
}

/// Sixteen balls at the centre of a box, seen from the first joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroupPlace {
    /// m.
    centres: PointRow,
    /// Displacements by half the box along the two axes that are not in lanes, to first order, m.
    along: [PointRow; 2],
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

/// A solid about a point of the obstacle's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub core: SolidCore,
    pub centre: [f32; 3],
    /// Its radius, and rounding errors, m.
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
    needed = needed + (along_lanes * lanes).abs();
    needed = needed + u.dot(place.along[0].load(simd)).abs();
    needed = needed + u.dot(place.along[1].load(simd)).abs();
    near & !(squared.simd_gt(needed).to_bitmask() as u32)
}

/// Balls of a group that touch what proves a contact at the centre of the box, one bit each.
#[inline(always)]
pub(super) fn touching_balls<S: Simd>(
    simd: S,
    group: &CoverGroup,
    place: &GroupPlace,
    pose: &CellPose,
    centre: [f32; 3],
    contact: ContactCore,
    rounding: f32,
) -> u32 {
    let arm = place.centres.load(simd);
    let PoseSplat { x, y, z, origin } = PoseSplat::new(simd, pose, centre);
    let p = z.times_plus(arm.2, y.times_plus(arm.1, x.times_plus(arm.0, origin)));
    let limit = group.radii.load(simd) + splat(simd, contact.radius - rounding);
    group.lanes & contact.core.signed_distance(simd, p).simd_le(limit).to_bitmask() as u32
}

/// Which of sixteen boxes have a ball of a group not proven apart from a solid.
#[inline(always)]
pub(super) fn near_boxes<S: Simd>(
    simd: S,
    group: &CoverGroup,
    place: &GroupPlace,
    ball: usize,
    motion: &GroupMotion,
    poses: &PoseLanes,
    target: &Target,
    half: HalfWidths,
) -> u32 {
    let arm = of_lane(&place.centres, ball);
    let p = to_obstacle(simd, poses, arm).minus(V3::splat(simd, target.centre));
    let vector = target.core.vector_to(simd, p);
    let squared = vector.dot(vector);
    let reach = group.radii.0[ball] + target.reach;
    let [x, y, z] = &poses.columns;
    let u = V3(x.load(simd).dot(vector), y.load(simd).dot(vector), z.load(simd).dot(vector));
    let first = if half.lanes_turn { [-arm[1], arm[0], 0.0] } else { [0.0, 0.0, 1.0] };
    let mut needed = squared.sqrt() * splat(simd, reach + motion.curvatures.0[ball]);
    needed = (u.dot(V3::splat(simd, first)) * splat(simd, half.lanes)).abs() + needed;
    needed = u.dot(V3::splat(simd, of_lane(&place.along[0], ball))).abs() + needed;
    needed = u.dot(V3::splat(simd, of_lane(&place.along[1], ball))).abs() + needed;
    0xffff & !(squared.simd_gt(needed).to_bitmask() as u32)
}

/// A point of the first joint's frame in that of the obstacle.
#[inline(always)]
fn to_obstacle<S: Simd>(simd: S, poses: &PoseLanes, p: [f32; 3]) -> V3<S> {
    let at = poses.columns[0].load(simd).times_plus(splat(simd, p[0]), poses.origin.load(simd));
    let at = poses.columns[1].load(simd).times_plus(splat(simd, p[1]), at);
    poses.columns[2].load(simd).times_plus(splat(simd, p[2]), at)
}

/// The centre of a ball at the centre of a box, seen from the first joint.
#[inline(always)]
pub(super) fn probe_centre(probe: &Probe, frame: &Frame) -> [f32; 3] {
    let mut p = frame.origin;
    for (column, at) in frame.columns.iter().zip(probe.centre) {
        for k in 0..3 {
            p[k] += column[k] * at;
        }
    }
    p
}

/// Distances of a ball's centre from a core at the centres of sixteen boxes; it is seen from the first joint, `offset` is the
/// core's place.
#[inline(always)]
pub(super) fn distance_from_core<S: Simd>(
    simd: S,
    poses: &PoseLanes,
    ball: [f32; 3],
    core: SolidCore,
    offset: [f32; 3],
) -> f32x16<S> {
    core.signed_distance(simd, to_obstacle(simd, poses, ball).minus(V3::splat(simd, offset)))
}

/// Lanes that are at most a limit, one bit each; NaN is not.
#[inline(always)]
pub(super) fn at_most<S: Simd>(simd: S, v: f32x16<S>, limit: f32) -> u32 {
    v.simd_le(splat(simd, limit)).to_bitmask() as u32
}

#[inline(always)]
fn cross<S: Simd>(a: V3<S>, b: V3<S>) -> V3<S> {
    V3(a.1 * b.2 - a.2 * b.1, a.2 * b.0 - a.0 * b.2, a.0 * b.1 - a.1 * b.0)
}

/// A pose in all lanes, its origin seen from a point.
struct PoseSplat<S: Simd> {
    x: V3<S>,
    y: V3<S>,
    z: V3<S>,
    origin: V3<S>,
}

// No closures: they are compiled for the lowest instruction set.
impl<S: Simd> PoseSplat<S> {
    #[inline(always)]
    fn new(simd: S, pose: &CellPose, from: [f32; 3]) -> Self {
        let [x, y, z] = pose.columns;
        let at = [pose.origin[0] - from[0], pose.origin[1] - from[1], pose.origin[2] - from[2]];
        Self { x: V3::splat(simd, x), y: V3::splat(simd, y), z: V3::splat(simd, z), origin: V3::splat(simd, at) }
    }
}
