//! Joint limits, and the region from which configurations are sampled.

use elbowroom_kinematics::{Chain, JointId, JointKind};

use super::error::{JointUnit, RrtConnectError};
use super::random::Random;
use crate::grid_path::PathEnd;

/// Distance beyond both ends within which a prismatic joint without limits is sampled, m.
const UNBOUNDED_SLIDE_M: f64 = 1.0;
/// Excess over a limit up to which a value is clamped to it, rad or m.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// Limits of a robot's values.
#[derive(Debug, Clone)]
pub(crate) struct JointBounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
    names: Vec<String>,
    prismatic: Vec<bool>,
    /// Whether a full turn of the joint leads to the same posture.
    repeats: Vec<bool>,
}

/// The values that a joint may have, rad or m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointRange {
    /// Lower limit, or -∞.
    pub lower: f64,
    /// Upper limit, or +∞.
    pub upper: f64,
    pub is_prismatic: bool,
    /// Whether a full turn of the joint leads to the same posture.
    pub repeats: bool,
}

/// Whether all joints that follow a value turn by whole turns with it.
fn repeats(chain: &Chain, index: usize) -> bool {
    let follows = |id: usize| chain.coupling(JointId(id)).filter(|c| c.index == index);
    (0..chain.joints().len())
        .all(|id| follows(id).is_none_or(|c| chain.joints()[id].kind.turns() && c.multiplier.fract() == 0.0))
}

impl JointBounds {
    pub fn new(chain: &Chain) -> Self {
        let joints = || chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
        Self {
            lower: chain.lower(),
            upper: chain.upper(),
            names: joints().map(|j| j.name.clone()).collect(),
            prismatic: joints().map(|j| j.kind == JointKind::Prismatic).collect(),
            repeats: (0..chain.dof()).map(|i| repeats(chain, i)).collect(),
        }
    }

    /// The values that each joint may have.
    pub fn ranges(&self) -> Vec<JointRange> {
        let range = |i: usize| JointRange {
            lower: self.lower[i],
            upper: self.upper[i],
            is_prismatic: self.prismatic[i],
            repeats: self.repeats[i],
        };
        (0..self.dof()).map(range).collect()
    }

    /// Name of a joint.
    pub fn name(&self, index: usize) -> &str {
        &self.names[index]
    }

    pub fn dof(&self) -> usize {
        self.lower.len()
    }

    /// Returns the values, clamped if they exceed a limit by rounding only.
    pub fn clamped_end(&self, end: PathEnd, q: &[f64]) -> Result<Vec<f64>, RrtConnectError> {
        for (i, &value) in q.iter().enumerate() {
            if !(value >= self.lower[i] - LIMIT_TOLERANCE && value <= self.upper[i] + LIMIT_TOLERANCE) {
                let unit = if self.prismatic[i] { JointUnit::Metres } else { JointUnit::Radians };
                let joint = self.names[i].clone();
                return Err(RrtConnectError::OutOfLimits {
                    end,
                    joint,
                    value,
                    lower: self.lower[i],
                    upper: self.upper[i],
                    unit,
                });
            }
        }
        let mut q = q.to_vec();
        self.clamp(&mut q);
        Ok(q)
    }

    /// Whether all values are within the limits.
    pub fn contains(&self, q: &[f64]) -> bool {
        q.iter().enumerate().all(|(i, v)| *v >= self.lower[i] && *v <= self.upper[i])
    }

    /// Narrows the limits.
    pub fn narrow(&mut self, limits: impl Iterator<Item = (f64, f64)>) {
        for ((lower, upper), (low, high)) in self.lower.iter_mut().zip(&mut self.upper).zip(limits) {
            (*lower, *upper) = (lower.max(low), upper.min(high));
        }
    }

    /// A chain whose independent joints have these limits, so that inverse kinematics leaves a joint that is held where it
    /// is.
    pub fn narrowed_chain(&self, chain: &Chain) -> Chain {
        let mut joints = chain.joints().to_vec();
        for (i, id) in chain.active_joints().iter().enumerate() {
            let joint = &mut joints[id.0];
            (joint.limits.lower, joint.limits.upper) = (self.lower[i], self.upper[i]);
            // A joint that turns for ever has no limits.
            if joint.kind == JointKind::Continuous && self.lower[i].is_finite() && self.upper[i].is_finite() {
                joint.kind = JointKind::Revolute;
            }
        }
        // Contradictory limits, which no configuration satisfies, are not a chain.
        Chain::new(chain.name(), chain.links().to_vec(), joints).unwrap_or_else(|_| chain.clone())
    }

    /// Clamps values to the limits.
    pub fn clamp(&self, q: &mut [f64]) {
        q.iter_mut().enumerate().for_each(|(i, v)| *v = v.max(self.lower[i]).min(self.upper[i]));
    }

    /// Joints with another value for the same posture, full turns away and nearer to the start, and that value.
    pub fn equivalent_goals(&self, from: &[f64], to: &[f64]) -> Vec<(String, f64)> {
        let turn = std::f64::consts::TAU;
        let other = |i: usize| {
            let value = to[i] + ((from[i] - to[i]) / turn).round() * turn;
            let within = value >= self.lower[i] && value <= self.upper[i];
            (!self.prismatic[i] && value != to[i] && within).then(|| (self.names[i].clone(), value))
        };
        (0..self.dof()).filter_map(other).collect()
    }

    /// The region between and around two configurations: up to the limits, or half a turn beyond both ends if a joint
    /// has no limits (for prismatic joints 1 m).
    pub fn sampling_region(&self, from: &[f64], to: &[f64]) -> SamplingRegion {
        self.sampling_region_of([from, to])
    }

    /// The sampling region of several configurations.
    pub fn sampling_region_of<'q>(&self, ends: impl IntoIterator<Item = &'q [f64]>) -> SamplingRegion {
        let mut extremes = vec![(f64::INFINITY, f64::NEG_INFINITY); self.dof()];
        for q in ends {
            for ((low, high), &value) in extremes.iter_mut().zip(q) {
                (*low, *high) = (low.min(value), high.max(value));
            }
        }
        let each = |i: usize| {
            let (low, high) = extremes[i];
            let beyond = if self.prismatic[i] { UNBOUNDED_SLIDE_M } else { std::f64::consts::PI };
            let least = if self.lower[i].is_finite() { self.lower[i] } else { low - beyond };
            let most = if self.upper[i].is_finite() { self.upper[i] } else { high + beyond };
            [least.min(low), low, high, most.max(high)]
        };
        SamplingRegion { each: (0..self.dof()).map(each).collect() }
    }
}

/// Sampling region: per value the lower bound, the smaller end, the greater end, the upper bound.
#[derive(Debug, Clone)]
pub(crate) struct SamplingRegion {
    each: Vec<[f64; 4]>,
}

impl SamplingRegion {
    /// Draws a sample between the ends and within a fraction of the region beyond them.
    pub fn sample(&self, share: f64, random: &mut Random, out: &mut [f64]) {
        for (value, [least, low, high, most]) in out.iter_mut().zip(&self.each) {
            let (from, to) = (low + (least - low) * share, high + (most - high) * share);
            *value = random.between(from, to).clamp(*least, *most);
        }
    }

    /// Indices of the values that are not held at one value.
    pub fn moving(&self) -> Vec<usize> {
        (0..self.each.len()).filter(|&i| self.each[i][0] < self.each[i][3]).collect()
    }

    /// Moves a configuration into the region.
    pub fn clamp(&self, q: &mut [f64]) {
        for (value, [least, _, _, most]) in q.iter_mut().zip(&self.each) {
            *value = value.clamp(*least, *most);
        }
    }

    /// Whether a configuration is in the region.
    pub fn contains(&self, q: &[f64]) -> bool {
        q.iter().zip(&self.each).all(|(value, [least, _, _, most])| value >= least && value <= most)
    }

    /// Like [`around`](Self::around), but values beyond the limits are clamped to them.
    pub fn clamped_around(&self, q: &[f64], distance: f64, random: &mut Random, out: &mut [f64]) {
        for ((value, &at), [least, _, _, most]) in out.iter_mut().zip(q).zip(&self.each) {
            *value = random.between(at - distance, at + distance).clamp(*least, *most);
        }
    }

    /// Draws a sample within a distance of a configuration in each value.
    pub fn around(&self, q: &[f64], distance: f64, random: &mut Random, out: &mut [f64]) {
        for ((value, &at), [least, _, _, most]) in out.iter_mut().zip(q).zip(&self.each) {
            *value = random.between((at - distance).max(*least), (at + distance).min(*most));
        }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_robot::example;

    use super::*;

    #[test]
    fn a_joint_that_turns_for_ever_is_held_in_the_narrowed_chain_too() {
        let chain = example::arm().unwrap().chain;
        let mut joints = chain.joints().to_vec();
        let waist = &mut joints[chain.active_joints()[0].0];
        waist.kind = JointKind::Continuous;
        let endless = Chain::new("endless", chain.links().to_vec(), joints).unwrap();
        assert_eq!(endless.upper()[0], f64::INFINITY);
        let mut bounds = JointBounds::new(&endless);
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        bounds.narrow([(0.3, 0.3), free, free].into_iter());
        let narrowed = bounds.narrowed_chain(&endless);
        assert_eq!((narrowed.lower(), narrowed.upper()), (bounds.lower.clone(), bounds.upper.clone()));
        // One that is not held still turns for ever.
        let whole = JointBounds::new(&endless).narrowed_chain(&endless);
        assert_eq!(whole.upper()[0], f64::INFINITY);
    }

    #[test]
    fn a_goal_one_turn_nearer_is_reported_within_the_limits() {
        let mut bounds = JointBounds::new(&example::arm().unwrap().chain);
        (bounds.lower, bounds.upper) = (vec![f64::NEG_INFINITY, -6.3, -3.0], vec![f64::INFINITY, 6.3, 3.0]);
        assert_eq!(bounds.equivalent_goals(&[3.0, -1.0, 2.9], &[2.0, 1.0, -2.9]), []);
        let found = bounds.equivalent_goals(&[10.0, -1.0, 2.9], &[-3.0, 2.9, -2.9]);
        let names: Vec<&str> = found.iter().map(|f| f.0.as_str()).collect();
        assert_eq!(names, ["waist", "shoulder"]);
        assert!(
            (found[0].1 - 9.566_370_614_359_172).abs() < 1e-12 && (found[1].1 + 3.383_185_307_179_586).abs() < 1e-12
        );
    }
}
