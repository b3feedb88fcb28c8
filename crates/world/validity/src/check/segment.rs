//! Straight segments in joint space: the joint values of a block, and how far points move between its lanes.
//!
//! Between two neighbouring lanes every joint value changes at a constant rate. A point at `p(t)`, `t` from 0 to 1, moves
//! at most `Σ ρ|Δ|` (`ρ`: lever arm of a joint for the body, `Δ`: change of its value). Its second derivative is the sum
//! of `Δ_i Δ_j ∂²p/∂q_i∂q_j`. For joint `i` at or before joint `j` on the path from the base, this derivative is:
//! - `z_i × (z_j × (p − o_j))` if both joints turn: at most `ρ_j`;
//! - `z_i × z_j` if `i` turns and `j` slides: at most 1;
//! - 0 if `i` slides.
//!
//! So the distance of a point from its chord is at most an eighth of `Σ_j ρ_j |Δ_j| (|Δ_j| + 2 Σ |Δ_i|)`. The inner sum
//! is over the turning joints before `j`; the first term in brackets applies to turning joints only.
//!
//! The motion of two links against each other is computed in the frame of the last joint that moves both: joints that
//! move both do not move one against the other. The same sums over the joints after it bound the relative motion.
//!
//! All sums are matrix products: a row of lever arms per joint ([`MotionTable`]), a lane per body or pair.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::Simd;

use super::joint_stretch::{INTERVALS, JointStretch};
use super::motion_table::MotionTable;
use super::workspace::Workspace;
use crate::lanes::{Fused, LANES, Row, splat};
use crate::model::{CoveredRobot, JointStep};

/// Factor for the rounding of the sums in single precision.
const ROUNDED_UP: f32 = 1.000_02;
/// Largest change of a joint value within one tested block, rad or m.
const MAX_CHANGE: f64 = 4.5;
/// A stretch of a straight segment from `from` to `to`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch<'q> {
    pub from: &'q [f64],
    pub to: &'q [f64],
    /// Start and end of the stretch, as fractions of the segment.
    pub begin: f64,
    pub end: f64,
}

impl Workspace {
    /// Prepares a block of evenly spaced configurations of a stretch.
    ///
    /// False if a value changes too much, or if the bounds do not hold for it.
    pub fn set_stretch(&mut self, robot: &CoveredRobot, stretch: &Stretch) -> bool {
        let mut is_valid = true;
        for (i, step) in robot.chain.steps.iter().enumerate() {
            let (from, to) = (stretch.from[step.index], stretch.to[step.index]);
            let first = step.multiplier * (from + stretch.begin * (to - from)) + step.offset;
            let change = step.multiplier * (to - from) * (stretch.end - stretch.begin);
            is_valid &= change.abs() <= MAX_CHANGE && step.accepts(first) && step.accepts(first + change);
            let first = if step.is_prismatic { first } else { reduced(first) };
            self.stretch[i] = JointStretch { first: first as f32, change: change as f32 };
        }
        is_valid
    }

    /// Computes the joint values in the lanes, and the bounds of the motion between lanes.
    #[inline(always)]
    pub fn spread<S: Simd>(&mut self, simd: S, robot: &CoveredRobot, table: &MotionTable) {
        let rows = table.columns / LANES;
        self.half_chord_m.fill(Row::ZERO);
        self.sag_m.fill(Row::ZERO);
        for (i, step) in robot.chain.steps.iter().enumerate() {
            let joint = self.stretch[i];
            self.values[i].store(joint.values(simd));
            let delta = joint.change.abs() * (ROUNDED_UP / INTERVALS as f32);
            self.deltas[i] = delta;
            let before = self.turned[step.parent];
            self.turned[i + 1] = if step.is_prismatic { before } else { before + delta };
            if delta == 0.0 {
                continue;
            }
            let own = if step.is_prismatic { 0.0 } else { delta };
            let (chord, curved) =
                (splat(simd, 0.5 * delta * ROUNDED_UP), splat(simd, 0.125 * delta * (own + 2.0 * before) * ROUNDED_UP));
            for r in 0..rows {
                let lever = table.lever_m[i * rows + r].load(simd);
                let (half_chord, sag) = (self.half_chord_m[r].load(simd), self.sag_m[r].load(simd));
                self.half_chord_m[r].store(lever.fused(chord, half_chord));
                self.sag_m[r].store(lever.fused(curved, sag));
            }
        }
    }

    /// Half of the longest chord of a body and its largest deviation from a chord, m.
    #[inline(always)]
    pub fn body_motion(&self, body: usize) -> (f32, f32) {
        let at = |rows: &[Row]| rows[body / LANES].0[body % LANES];
        (at(&self.half_chord_m), at(&self.sag_m))
    }

    /// Like `body_motion`, for two links against each other. Turns that both links share are not in the deviation.
    #[inline(always)]
    pub fn pair_motion(&self, column: usize, common_frame: usize) -> (f32, f32) {
        let (half_chord, sag) = self.body_motion(column);
        if !half_chord.is_finite() {
            return (f32::INFINITY, f32::INFINITY);
        }
        let common = 0.5 * half_chord * self.turned[common_frame];
        // The sum also has the rounding errors of the subtracted part.
        (half_chord, (sag * ROUNDED_UP - common).max(0.0))
    }

    /// Puts evenly spaced configurations of the prepared stretch into some lanes, the last one at its end.
    pub fn put_stretch(&mut self, first: usize, count: usize) {
        for (values, joint) in self.values.iter_mut().zip(&self.stretch) {
            for (k, value) in values.0[first..first + count].iter_mut().enumerate() {
                *value = joint.first + joint.change * ((k + 1) as f32 / count as f32);
            }
        }
    }

    /// Copies the configurations of some lanes into others.
    pub fn copy_lanes(&mut self, from: usize, to: usize, count: usize) {
        self.values.iter_mut().for_each(|values| values.0.copy_within(from..from + count, to));
    }

    /// Sets the joint values of one lane. False if the bounds do not hold for them.
    pub fn set_lane(&mut self, robot: &CoveredRobot, lane: usize, q: &[f64]) -> bool {
        let mut is_valid = true;
        for (i, step) in robot.chain.steps.iter().enumerate() {
            let (value, accepted) = joint_value(step, q);
            is_valid &= accepted;
            self.values[i].0[lane] = value;
        }
        is_valid
    }
}

/// The value of a joint in single precision (an angle is reduced by whole turns), and whether the bounds hold for it.
#[inline(always)]
pub(crate) fn joint_value(step: &JointStep, q: &[f64]) -> (f32, bool) {
    let value = step.multiplier * q[step.index] + step.offset;
    let single = if step.is_prismatic { value } else { reduced(value) };
    (single as f32, step.accepts(value))
}

/// The angle reduced by whole turns, rad.
#[inline(always)]
fn reduced(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round_ties_even()
}
