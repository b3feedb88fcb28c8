//! The kernel: a sphere of the robot in sixteen boxes of joint space.
//!
//! The boxes differ in the value of the axis in lanes alone. Seen from the first joint, the centre of the sphere is the same at
//! the centres of all of them, and so are its displacements by half a box along each axis: only the obstacle turns.
//!
//! A box is free of a sphere if a plane separates the sphere from the obstacle in the whole box. The plane is the one across
//! the shortest way from the obstacle at the centre of the box; toward it the sphere moves by no more than the displacements
//! along the normal, and a bound of the curvature.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use elbowroom_validity::lanes::{V3, splat};
use fearless_simd::{Simd, prelude::*};

use super::block_level::Frame;
use super::cover_class::{CoverNode, CoverPath, NodeMotion};
use super::obstacle_lanes::{ContactCore, PoseLanes};
use super::solid_core::SolidCore;

/// A sphere at the centre of a box, seen from the first joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodePlace {
    /// m.
    pub centre: [f32; 3],
    /// Displacement by half the box along the axis in lanes, and along the two others, to first order, m.
    pub along: [[f32; 3]; 3],
}

/// Half widths of a box: of the axis in lanes, times the joint's multiplier, and of the others.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfWidths {
    pub lanes: f32,
    pub lanes_turn: bool,
    pub others: [f32; 2],
}

impl NodePlace {
    #[inline(always)]
    pub fn new(node: &CoverNode, path: &CoverPath, frames: &[Frame], half: HalfWidths) -> Self {
        let frame = &frames[path.last as usize];
        let mut p = frame.origin;
        for (column, at) in frame.columns.iter().zip(node.centre) {
            for k in 0..3 {
                p[k] = column[k] * at + p[k];
            }
        }
        let h = half.lanes;
        let first = if half.lanes_turn { [-h * p[1], h * p[0], 0.0] } else { [0.0, 0.0, h] };
        let mut along = [first, [0.0; 3], [0.0; 3]];
        for step in &path.steps {
            let Frame { columns: [_, _, z], origin } = &frames[step.step as usize];
            let r = [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
            let cross = [z[1] * r[2] - z[2] * r[1], z[2] * r[0] - z[0] * r[2], z[0] * r[1] - z[1] * r[0]];
            let velocity = if step.turns { cross } else { *z };
            let by = step.multiplier * half.others[step.axis];
            for k in 0..3 {
                along[1 + step.axis][k] += by * velocity[k];
            }
        }
        Self { centre: p, along }
    }
}

/// A solid about a point of the obstacle's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target<'a> {
    pub poses: &'a PoseLanes,
    pub core: SolidCore,
    pub centre: [f32; 3],
    /// Sum of the radii of both, and of rounding errors, m.
    pub reach: f32,
    /// What proves a contact: the sum of the radii, less rounding errors.
    pub contact: Option<ContactCore>,
}

/// What is known of a pair in sixteen boxes, one bit each.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PairLanes {
    /// Not proven apart.
    pub near: u32,
    /// In contact at every configuration of the box (in a cell: at one, at least).
    pub contact: u32,
}

/// A sphere and a solid in the boxes `live`.
#[inline(always)]
pub(super) fn assess<S: Simd>(
    simd: S,
    place: &NodePlace,
    target: &Target<'_>,
    motion: NodeMotion,
    are_cells: bool,
    live: u32,
) -> PairLanes {
    let p = point(simd, target.poses, place.centre).minus(V3::splat(simd, target.centre));
    let vector = target.core.vector_to(simd, p);
    let squared = vector.dot(vector);
    let far = target.reach + motion.path;
    let near = not_above(squared.simd_gt(splat(simd, far * far)).to_bitmask() as u32, live);
    if near == 0 {
        return PairLanes::default();
    }
    let distance = squared.sqrt();
    let u = to_arm(simd, target.poses, vector);
    let mut needed = distance * splat(simd, target.reach + motion.curvature);
    needed = needed + u.dot(V3::splat(simd, place.along[0])).abs();
    needed = needed + u.dot(V3::splat(simd, place.along[1])).abs();
    needed = needed + u.dot(V3::splat(simd, place.along[2])).abs();
    let near = not_above(squared.simd_gt(needed).to_bitmask() as u32, near);
    let mut lanes = PairLanes { near, contact: 0 };
    if let Some(contact) = target.contact.filter(|_| near != 0) {
        let stays = if are_cells { 0.0 } else { motion.path };
        let limit = splat(simd, contact.radius - stays);
        let inside = contact.core.signed_distance(simd, p);
        lanes.contact = inside.simd_le(limit).to_bitmask() as u32 & near;
    }
    lanes
}

/// The lanes of `live` without those that are certainly above a limit; NaN is not.
#[inline(always)]
fn not_above(above: u32, live: u32) -> u32 {
    live & !above
}

/// A point of the first joint's frame in that of the obstacle.
#[inline(always)]
fn point<S: Simd>(simd: S, poses: &PoseLanes, p: [f32; 3]) -> V3<S> {
    let at = poses.columns[0].load(simd).times_plus(splat(simd, p[0]), poses.origin.load(simd));
    let at = poses.columns[1].load(simd).times_plus(splat(simd, p[1]), at);
    poses.columns[2].load(simd).times_plus(splat(simd, p[2]), at)
}

/// A vector of the obstacle's frame in that of the first joint.
#[inline(always)]
fn to_arm<S: Simd>(simd: S, poses: &PoseLanes, v: V3<S>) -> V3<S> {
    V3(
        poses.columns[0].load(simd).dot(v),
        poses.columns[1].load(simd).dot(v),
        poses.columns[2].load(simd).dot(v),
    )
}
