//! Where joints may be, and where it is worth to look.

use elbowroom_kinematics::{Chain, JointKind};

use super::error::RouteError;
use super::random::Random;
use crate::path::End;

/// A slide without limits is looked at so far beyond both ends, m.
const SLIDE_M: f64 = 1.0;
/// Values beyond a limit by no more than this are taken for it, rad or m.
const SAME: f64 = 1e-9;

/// The limits of a robot's values.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
    names: Vec<String>,
    slides: Vec<bool>,
}

impl Bounds {
    pub fn new(chain: &Chain) -> Self {
        let joints = || chain.active_joints().iter().map(|id| &chain.joints()[id.0]);
        Self {
            lower: chain.lower(),
            upper: chain.upper(),
            names: joints().map(|j| j.name.clone()).collect(),
            slides: joints().map(|j| j.kind == JointKind::Prismatic).collect(),
        }
    }

    pub fn dof(&self) -> usize {
        self.lower.len()
    }

    /// The values, pulled onto limits that they miss by a rounding.
    pub fn checked(&self, end: End, q: &[f64]) -> Result<Vec<f64>, RouteError> {
        for (i, &value) in q.iter().enumerate() {
            if !(value >= self.lower[i] - SAME && value <= self.upper[i] + SAME) {
                let (joint, unit) = (self.names[i].clone(), if self.slides[i] { "m" } else { "rad" });
                return Err(RouteError::Beyond { end, joint, value, lower: self.lower[i], upper: self.upper[i], unit });
            }
        }
        let mut q = q.to_vec();
        self.clamp(&mut q);
        Ok(q)
    }

    /// No wider than these.
    pub fn narrow(&mut self, limits: impl Iterator<Item = (f64, f64)>) {
        for ((lower, upper), (low, high)) in self.lower.iter_mut().zip(&mut self.upper).zip(limits) {
            (*lower, *upper) = (lower.max(low), upper.min(high));
        }
    }

    /// The nearest values within limits.
    pub fn clamp(&self, q: &mut [f64]) {
        q.iter_mut().enumerate().for_each(|(i, v)| *v = v.max(self.lower[i]).min(self.upper[i]));
    }

    /// Joints that reach the same posture by whole turns nearer to where they are, with that value.
    pub fn nearer(&self, from: &[f64], to: &[f64]) -> Vec<(String, f64)> {
        let turn = std::f64::consts::TAU;
        let other = |i: usize| {
            let value = to[i] + ((from[i] - to[i]) / turn).round() * turn;
            let within = value >= self.lower[i] && value <= self.upper[i];
            (!self.slides[i] && value != to[i] && within).then(|| (self.names[i].clone(), value))
        };
        (0..self.dof()).filter_map(other).collect()
    }

    /// What is looked through on the way between two places: everything, where there are limits; a turn beyond them where
    /// there are none.
    pub fn window(&self, from: &[f64], to: &[f64]) -> Window {
        let each = |i: usize| {
            let (low, high) = (from[i].min(to[i]), from[i].max(to[i]));
            let beyond = if self.slides[i] { SLIDE_M } else { std::f64::consts::PI };
            let least = if self.lower[i].is_finite() { self.lower[i] } else { low - beyond };
            let most = if self.upper[i].is_finite() { self.upper[i] } else { high + beyond };
            [least.min(low), low, high, most.max(high)]
        };
        Window { each: (0..self.dof()).map(each).collect() }
    }
}

/// Per value: least, the smaller end, the greater end, most.
#[derive(Debug, Clone)]
pub(super) struct Window {
    each: Vec<[f64; 4]>,
}

impl Window {
    /// Anywhere between the ends and a share of what lies beyond them; all of it at 1.
    pub fn sample(&self, share: f64, random: &mut Random, out: &mut [f64]) {
        for (value, [least, low, high, most]) in out.iter_mut().zip(&self.each) {
            let (from, to) = (low + (least - low) * share, high + (most - high) * share);
            *value = random.between(from, to).clamp(*least, *most);
        }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_scene::example;

    use super::*;

    #[test]
    fn a_whole_turn_is_told_where_the_limits_allow_it() {
        let mut bounds = Bounds::new(&example::arm().unwrap().chain);
        (bounds.lower, bounds.upper) = (vec![f64::NEG_INFINITY, -6.3, -3.0], vec![f64::INFINITY, 6.3, 3.0]);
        assert_eq!(bounds.nearer(&[3.0, -1.0, 2.9], &[2.0, 1.0, -2.9]), []);
        let found = bounds.nearer(&[10.0, -1.0, 2.9], &[-3.0, 2.9, -2.9]);
        let names: Vec<&str> = found.iter().map(|f| f.0.as_str()).collect();
        assert_eq!(names, ["waist", "shoulder"]);
        assert!(
            (found[0].1 - 9.566_370_614_359_172).abs() < 1e-12 && (found[1].1 + 3.383_185_307_179_586).abs() < 1e-12
        );
    }
}
