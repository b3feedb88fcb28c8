//! Forward kinematics of one configuration, with coordinates as lanes.
//!
//! Sums and rounding equal those for sixteen configurations.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, f32x4, prelude::*};

use super::forward::BatchedChain;
use super::joint_step::{FixedRotation, JointStep};
use crate::lanes::{LANES, Row, sin_cos};

/// A vector of coordinates; the fourth is unused.
type Vec4 = [f32; 4];

/// Pose of a frame in the world: columns of the rotation, and origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub columns: [Vec4; 3],
    pub origin: Vec4,
}

/// Sines and cosines of all joints, in rows of sixteen.
#[derive(Debug, Clone)]
pub(crate) struct JointTurns {
    sin: Vec<Row>,
    cos: Vec<Row>,
}

impl JointTurns {
    pub fn new(rows: usize) -> Self {
        Self { sin: vec![Row::ZERO; rows], cos: vec![Row::ZERO; rows] }
    }
}

impl BatchedChain {
    /// Memory for the frames of one configuration; the root's frame is set.
    pub fn single_frames(&self) -> Vec<Frame> {
        let r = self.base_in_world.rotation;
        let vec4 = |v: elbowroom_spatial::Vec3| [v.x as f32, v.y as f32, v.z as f32, 0.0];
        let columns = [vec4(r.x_axis()), vec4(r.y_axis()), vec4(r.z_axis())];
        vec![Frame { columns, origin: vec4(self.base_in_world.translation) }; self.steps.len() + 1]
    }

    /// Computes all frames from the values of the joints, in rows of sixteen.
    #[inline(always)]
    pub fn forward_single<S: Simd>(&self, simd: S, values: &[Row], turns: &mut JointTurns, frames: &mut [Frame]) {
        for (r, row) in values.iter().enumerate() {
            let (sin, cos) = sin_cos(simd, row.load(simd));
            turns.sin[r].store(sin);
            turns.cos[r].store(cos);
        }
        for (i, step) in self.steps.iter().enumerate() {
            let (row, lane) = (i / LANES, i % LANES);
            let (sin, cos) = (turns.sin[row].0[lane], turns.cos[row].0[lane]);
            frames[i + 1] = step.moved(simd, values[row].0[lane], sin, cos, &frames[step.parent]);
        }
    }
}

impl JointStep {
    #[inline(always)]
    fn moved<S: Simd>(&self, simd: S, value: f32, sin: f32, cos: f32, parent: &Frame) -> Frame {
        let [x, y, z] = parent.columns;
        let columns = [vector(simd, x), vector(simd, y), vector(simd, z)];
        let mut origin = vector(simd, parent.origin);
        for k in 0..3 {
            if self.translation[k] != 0.0 {
                origin = times_plus(simd, columns[k], self.translation[k], origin);
            }
        }
        let [x, y, z] = self.rotation.times(simd, columns);
        if self.is_prismatic {
            origin = times_plus(simd, z, value, origin);
            return Frame { columns: [x.into(), y.into(), z.into()], origin: origin.into() };
        }
        let turned = [sum(simd, x, cos, y, sin), sum(simd, x, 0.0 - sin, y, cos)];
        Frame { columns: [turned[0].into(), turned[1].into(), z.into()], origin: origin.into() }
    }
}

impl FixedRotation {
    /// The product of a rotation, given by its columns, and this rotation.
    #[inline(always)]
    fn times<S: Simd>(&self, simd: S, c: [f32x4<S>; 3]) -> [f32x4<S>; 3] {
        match self {
            Self::Permutation { axis, sign } => [c[axis[0]] * sign[0], c[axis[1]] * sign[1], c[axis[2]] * sign[2]],
            Self::Matrix([x, y, z]) => [combined(simd, c, x), combined(simd, c, y), combined(simd, c, z)],
        }
    }
}

impl Frame {
    /// Converts a point from the frame to the world.
    #[inline(always)]
    pub fn point<S: Simd>(&self, simd: S, p: [f32; 3]) -> Vec4 {
        let mut at = vector(simd, self.origin);
        for k in 0..3 {
            at = times_plus(simd, vector(simd, self.columns[k]), p[k], at);
        }
        at.into()
    }
}

#[inline(always)]
fn vector<S: Simd>(simd: S, v: Vec4) -> f32x4<S> {
    f32x4::simd_from(simd, v)
}

/// `a·k + c`.
#[inline(always)]
fn times_plus<S: Simd>(simd: S, a: f32x4<S>, k: f32, c: f32x4<S>) -> f32x4<S> {
    a.mul_add_precise(f32x4::splat(simd, k), c)
}

/// `a·s + b·t`.
#[inline(always)]
fn sum<S: Simd>(simd: S, a: f32x4<S>, s: f32, b: f32x4<S>, t: f32) -> f32x4<S> {
    times_plus(simd, b, t, a * s)
}

#[inline(always)]
fn combined<S: Simd>(simd: S, c: [f32x4<S>; 3], m: &[f32; 3]) -> f32x4<S> {
    times_plus(simd, c[2], m[2], sum(simd, c[0], m[0], c[1], m[1]))
}
