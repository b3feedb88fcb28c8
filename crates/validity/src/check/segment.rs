//! Straight segments in joint space: the joint values of a block, and how far points move between its lanes.
//!
//! Between two neighbouring lanes every joint value changes by a constant rate. A point at `p(t)`, `t` from 0 to 1, moves no
//! farther than `Σ ρ|Δ|` (`ρ`: lever arm of a joint for the body, `Δ`: change of its value). Its second derivative is the sum of
//! `Δ_i Δ_j ∂²p/∂q_i∂q_j`. For joint `i` at or before joint `j` on the way from the base this derivative is
//! `z_i × (z_j × (p − o_j))` where both turn, at most `ρ_j`; `z_i × z_j`, at most 1, where `i` turns and `j` slides; and 0 where
//! `i` slides. So no point leaves its chord farther than an eighth of `Σ_j ρ_j |Δ_j| (|Δ_j| + 2 Σ |Δ_i|)`, the inner sum over the
//! turning joints before `j`, the first term in brackets for turning joints only.

use super::workspace::Workspace;
use crate::lanes::LANES;
use crate::model::CoveredRobot;

/// Intervals between the lanes of a block.
pub(crate) const INTERVALS: usize = LANES - 1;
/// Rounding of the sums in single precision.
const ROUNDED_UP: f32 = 1.000_01;
/// A joint value that changes by more than this within one block is not tested, rad or m.
const MAX_CHANGE: f64 = 4.5;

/// A stretch of a straight segment from `from` to `to`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stretch<'q> {
    pub from: &'q [f64],
    pub to: &'q [f64],
    /// Where it begins and ends, as shares of the segment.
    pub begin: f64,
    pub end: f64,
}

impl Workspace {
    /// Sets the joint values of the lanes to evenly spaced configurations of a stretch, and the bounds of the motion between
    /// them. False where values change too much or are not finite.
    pub fn set_stretch(&mut self, robot: &CoveredRobot, stretch: &Stretch) -> bool {
        self.half_chord_m.fill(0.0);
        self.sag_m.fill(0.0);
        // Per frame: how much the turning joints that carry it change between lanes.
        self.turned.fill(0.0);
        let mut is_valid = true;
        for (i, step) in robot.chain.steps.iter().enumerate() {
            let (from, to) = (stretch.from[step.index], stretch.to[step.index]);
            let value = |t: f64| step.multiplier * (from + t * (to - from)) + step.offset;
            let first = value(stretch.begin);
            let change = step.multiplier * (to - from) * (stretch.end - stretch.begin);
            is_valid &= change.abs() <= MAX_CHANGE && first.is_finite();
            let first = if step.is_prismatic { first } else { reduced(first) };
            for (lane, v) in self.values[i].0.iter_mut().enumerate() {
                *v = (first + change * (lane as f64 / INTERVALS as f64)) as f32;
            }
            let delta = (change.abs() / INTERVALS as f64) as f32 * ROUNDED_UP;
            let before = self.turned[step.parent];
            self.turned[i + 1] = if step.is_prismatic { before } else { before + delta };
            if delta == 0.0 {
                continue;
            }
            let own = if step.is_prismatic { 0.0 } else { delta };
            let curved = delta * (own + 2.0 * before) * (0.125 * ROUNDED_UP);
            for (b, body) in robot.bodies.iter().enumerate() {
                let lever = body.lever_m[i];
                self.half_chord_m[b] += 0.5 * delta * lever * ROUNDED_UP;
                self.sag_m[b] += curved * lever;
            }
        }
        is_valid
    }

    /// Sets the joint values of one lane. False where they are not finite.
    pub fn set_lane(&mut self, robot: &CoveredRobot, lane: usize, q: &[f64]) -> bool {
        let mut is_valid = true;
        for (i, step) in robot.chain.steps.iter().enumerate() {
            let value = step.multiplier * q[step.index] + step.offset;
            is_valid &= value.is_finite();
            self.values[i].0[lane] = if step.is_prismatic { value as f32 } else { reduced(value) as f32 };
        }
        is_valid
    }
}

/// The angle less whole turns.
fn reduced(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round_ties_even()
}

/// Largest displacement of any point of the robot on the way between two configurations, m.
pub(crate) fn displacement_m(robot: &CoveredRobot, from: &[f64], to: &[f64]) -> f64 {
    let mut longest = 0.0_f64;
    for body in &robot.bodies {
        let mut length = 0.0;
        for (step, &lever) in robot.chain.steps.iter().zip(&body.lever_m) {
            let change = (step.multiplier * (to[step.index] - from[step.index])).abs();
            if change > 0.0 {
                length += change * f64::from(lever);
            }
        }
        longest = longest.max(length);
    }
    longest
}
