//! Batched forward kinematics: the frames of all moving joints for sixteen configurations at once.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use elbowroom_kinematics::Chain;
use elbowroom_spatial::{Pose, Rotation, Vec3};
use fearless_simd::{Simd, f32x16};

use super::joint_step::{FixedRotation, JointStep, LinkFrame, axis_rotation, moves, single, value_range};
use crate::lanes::{LANES, PointRow, Row, V3, sin_cos, splat};

/// A chain prepared for batched forward kinematics: fixed joints are folded into the poses of links.
#[derive(Debug, Clone)]
pub(crate) struct BatchedChain {
    /// Moving joints from the root outwards; step `i` moves frame `i + 1`.
    pub steps: Vec<JointStep>,
    /// Per link of the chain: its frame and its pose in the frame.
    pub links: Vec<LinkFrame>,
    pub base_in_world: Pose,
}

/// Poses of frames in the world, one per lane: columns of the rotation, and origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameLanes {
    pub columns: [PointRow; 3],
    pub origin: PointRow,
}

impl BatchedChain {
    pub fn new(chain: &Chain, base_in_world: Pose) -> Self {
        let root = LinkFrame { frame: 0, in_frame: Pose::IDENTITY };
        let mut links = vec![root; chain.links().len()];
        let mut steps = Vec::new();
        for &id in chain.topological_order() {
            let joint = &chain.joints()[id.0];
            let parent = links[joint.parent.0];
            let at_zero = parent.in_frame * joint.origin;
            let Some(coupling) = chain.coupling(id).filter(|_| moves(joint.kind)) else {
                links[joint.child.0] = LinkFrame { frame: parent.frame, in_frame: at_zero };
                continue;
            };
            let axis = axis_rotation(joint.axis);
            let limits = chain.joints()[chain.active_joints()[coupling.index].0].limits;
            // A mimic joint with multiplier 0 does not move, whatever the limits are (0·∞ is NaN).
            let turns_with_q = |q: f64| if coupling.multiplier == 0.0 { 0.0 } else { coupling.multiplier * q };
            let ends = [limits.lower, limits.upper].map(|q| turns_with_q(q) + coupling.offset);
            let [lower, upper] = value_range(!joint.kind.turns(), ends);
            steps.push(JointStep {
                parent: parent.frame,
                is_prismatic: !joint.kind.turns(),
                rotation: FixedRotation::new(at_zero.rotation * axis),
                translation: single(at_zero.translation),
                at_zero: Pose::new(at_zero.rotation * axis, at_zero.translation),
                index: coupling.index,
                multiplier: coupling.multiplier,
                offset: coupling.offset,
                lower,
                upper,
            });
            let in_frame = Pose::new(axis.inverse(), Vec3::ZERO);
            links[joint.child.0] = LinkFrame { frame: steps.len(), in_frame };
        }
        Self { steps, links, base_in_world }
    }

    /// The steps that move a frame, from the root outwards.
    pub fn steps_to(&self, frame: usize) -> Vec<usize> {
        let mut steps = Vec::new();
        let mut at = frame;
        while let Some(step) = at.checked_sub(1) {
            steps.push(step);
            at = self.steps[step].parent;
        }
        steps.reverse();
        steps
    }

    /// Memory for the frames; the root's frame is set.
    pub fn frames(&self) -> Vec<FrameLanes> {
        vec![constant_frame(&self.base_in_world); self.steps.len() + 1]
    }

    /// Computes all frames from the values of the joints, one row per step.
    #[inline(always)]
    pub fn forward<S: Simd>(&self, simd: S, values: &[Row], frames: &mut [FrameLanes]) {
        for (i, step) in self.steps.iter().enumerate() {
            let (before, after) = frames.split_at_mut(i + 1);
            step.move_frame(simd, values[i].load(simd), &before[step.parent], &mut after[0]);
        }
    }
}

impl JointStep {
    #[inline(always)]
    fn move_frame<S: Simd>(&self, simd: S, value: f32x16<S>, parent: &FrameLanes, frame: &mut FrameLanes) {
        let mut origin = parent.origin.load(simd);
        for k in 0..3 {
            if self.translation[k] != 0.0 {
                origin = parent.columns[k].load(simd).times_plus(splat(simd, self.translation[k]), origin);
            }
        }
        let x = self.rotation.column(simd, parent, 0);
        let y = self.rotation.column(simd, parent, 1);
        let z = self.rotation.column(simd, parent, 2);
        frame.columns[2].store(z);
        if self.is_prismatic {
            frame.columns[0].store(x);
            frame.columns[1].store(y);
            frame.origin.store(z.times_plus(value, origin));
        } else {
            let (sin, cos) = sin_cos(simd, value);
            frame.columns[0].store(sum(x, cos, y, sin));
            frame.columns[1].store(sum(x, splat(simd, 0.0) - sin, y, cos));
            frame.origin.store(origin);
        }
    }
}

impl FixedRotation {
    /// Column `k` of the product of the parent frame's rotation and this rotation.
    #[inline(always)]
    fn column<S: Simd>(&self, simd: S, parent: &FrameLanes, k: usize) -> V3<S> {
        match self {
            Self::Permutation { axis, sign } => {
                let (c, s) = (parent.columns[axis[k]].load(simd), splat(simd, sign[k]));
                V3(c.0 * s, c.1 * s, c.2 * s)
            }
            Self::Matrix(m) => {
                let (x, y) = (parent.columns[0].load(simd), parent.columns[1].load(simd));
                let partial = sum(x, splat(simd, m[k][0]), y, splat(simd, m[k][1]));
                parent.columns[2].load(simd).times_plus(splat(simd, m[k][2]), partial)
            }
        }
    }
}

/// `a·s + b·t`.
#[inline(always)]
fn sum<S: Simd>(a: V3<S>, s: f32x16<S>, b: V3<S>, t: f32x16<S>) -> V3<S> {
    b.times_plus(t, V3(a.0 * s, a.1 * s, a.2 * s))
}

impl FrameLanes {
    /// Converts a point from the frame to the world.
    #[inline(always)]
    pub fn point<S: Simd>(&self, simd: S, p: [f32; 3]) -> V3<S> {
        let mut at = self.origin.load(simd);
        for k in 0..3 {
            at = self.columns[k].load(simd).times_plus(splat(simd, p[k]), at);
        }
        at
    }
}

impl FrameLanes {
    /// Converts a direction from the world to the frame.
    #[inline(always)]
    pub fn local_direction<S: Simd>(&self, simd: S, v: V3<S>) -> V3<S> {
        let x = self.columns[0].load(simd).dot(v);
        let y = self.columns[1].load(simd).dot(v);
        V3(x, y, self.columns[2].load(simd).dot(v))
    }
}

/// The same pose in every lane.
fn constant_frame(pose: &Pose) -> FrameLanes {
    let row = |v: f64| Row([v as f32; LANES]);
    let point = |v: Vec3| PointRow([row(v.x), row(v.y), row(v.z)]);
    let r: Rotation = pose.rotation;
    FrameLanes { columns: [point(r.x_axis()), point(r.y_axis()), point(r.z_axis())], origin: point(pose.translation) }
}
