//! Sampler of configurations that may be on a shorter path (Gammell, Srinivasa, Barfoot: *Informed RRT\**, 2014): it
//! draws from the ellipsoid whose foci are the start and a goal.

use crate::interpolation::length;
use crate::rrt_connect::{Random, SamplingRegion};

/// Number of draws outside the limits after which a sample is drawn from the region instead.
const TRIALS: usize = 16;

/// Draws from the ellipsoids of a start and several goals, within a region.
pub(super) struct InformedSampler<'r> {
    start: Vec<f64>,
    goals: Vec<Vec<f64>>,
    region: SamplingRegion,
    /// Joints that are not held. In an ellipsoid of all joints, hardly any configuration leaves the held ones in place.
    moving: Vec<usize>,
    random: &'r mut Random,
}

impl<'r> InformedSampler<'r> {
    pub fn new(start: Vec<f64>, goals: Vec<Vec<f64>>, region: SamplingRegion, random: &'r mut Random) -> Self {
        let moving = region.moving();
        Self { start, goals, region, moving, random }
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.random.between(low, high)
    }

    /// Draws a configuration through which a path shorter than `bound` may lead. False if no path can be shorter.
    pub fn sample(&mut self, bound: f64, out: &mut [f64]) -> bool {
        let open: Vec<&Vec<f64>> = self.goals.iter().filter(|goal| length(&self.start, goal) < bound).collect();
        if open.is_empty() {
            return false;
        }
        let goal = open[((self.random.unit() * open.len() as f64) as usize).min(open.len() - 1)].clone();
        let [from, to] = [&self.start, &goal].map(|q| -> Vec<f64> { self.moving.iter().map(|&i| q[i]).collect() });
        let mut values = from.clone();
        out.copy_from_slice(&self.start);
        for _ in 0..TRIALS {
            in_ellipsoid(&from, &to, bound, self.random, &mut values);
            self.moving.iter().zip(&values).for_each(|(&i, &value)| out[i] = value);
            if self.region.contains(out) {
                return true;
            }
        }
        self.fall_back(&goal, bound, out);
        true
    }

    /// Replaces a draw from the ellipsoid that is outside the region, as nearly all are if a joint has a narrow range.
    fn fall_back(&mut self, goal: &[f64], bound: f64, out: &mut [f64]) {
        let drawn = out.to_vec();
        self.region.sample(1.0, self.random, out);
        if length(&self.start, out) + length(out, goal) >= bound {
            // Both foci are in the region, so the nearest configuration in it is in the ellipsoid, too.
            out.copy_from_slice(&drawn);
            self.region.clamp(out);
        }
    }
}

/// Draws uniformly from the ellipsoid of points whose distances from two foci add up to at most `sum`.
fn in_ellipsoid(a: &[f64], b: &[f64], sum: f64, random: &mut Random, out: &mut [f64]) {
    let distance = length(a, b);
    in_unit_ball(random, out);
    let across = 0.5 * (sum * sum - distance * distance).max(0.0).sqrt();
    for (i, value) in out.iter_mut().enumerate() {
        *value *= if i == 0 { 0.5 * sum } else { across };
    }
    reflect_to(a, b, distance, out);
    for ((value, a), b) in out.iter_mut().zip(a).zip(b) {
        *value += 0.5 * (a + b);
    }
}

/// Reflects the first axis to the direction from `a` to `b` (Householder).
fn reflect_to(a: &[f64], b: &[f64], distance: f64, out: &mut [f64]) {
    if distance == 0.0 {
        return;
    }
    let normal = |i: usize| (b[i] - a[i]) / distance - if i == 0 { 1.0 } else { 0.0 };
    let (mut square, mut product) = (0.0, 0.0);
    for (i, value) in out.iter().enumerate() {
        square += normal(i) * normal(i);
        product += normal(i) * value;
    }
    if square > 1e-24 {
        let factor = 2.0 * product / square;
        for (i, value) in out.iter_mut().enumerate() {
            *value -= factor * normal(i);
        }
    }
}

/// Draws uniformly from the unit ball: a normally distributed direction and a radius.
fn in_unit_ball(random: &mut Random, out: &mut [f64]) {
    let mut square = 0.0;
    for value in out.iter_mut() {
        // Box-Muller transform.
        let (u, v) = (1.0 - random.unit(), random.unit());
        *value = (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos();
        square += *value * *value;
    }
    let radius = random.unit().powf(1.0 / out.len() as f64);
    let factor = if square > 0.0 { radius / square.sqrt() } else { 0.0 };
    for value in out.iter_mut() {
        *value *= factor;
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_robot::example;

    use super::*;
    use crate::rrt_connect::JointBounds;

    #[test]
    fn samples_are_in_the_ellipsoid_if_a_joint_is_held_or_hardly_moves() {
        for most in [0.3, 0.34] {
            let mut bounds = JointBounds::new(&example::arm().unwrap().chain);
            let free = (f64::NEG_INFINITY, f64::INFINITY);
            bounds.narrow([free, (0.3, most), free].into_iter());
            let ends = [vec![-0.4, 0.3, 0.1], vec![0.5, most, -0.2]];
            let (mut random, mut q, bound) = (Random::new(2), vec![0.0; 3], 1.05);
            let region = bounds.sampling_region_of(ends.iter().map(Vec::as_slice));
            let mut sampler = InformedSampler::new(ends[0].clone(), vec![ends[1].clone()], region, &mut random);
            for _ in 0..1000 {
                assert!(sampler.sample(bound, &mut q));
                assert!((0.3..=most).contains(&q[1]), "{q:?}");
                assert!(length(&ends[0], &q) + length(&q, &ends[1]) <= bound * (1.0 + 1e-12), "{q:?}");
            }
        }
    }

    #[test]
    fn samples_fill_the_ellipsoid_evenly_and_never_leave_it() {
        let mut random = Random::new(3);
        for (a, b) in [([0.0, 0.0, 0.0], [1.0, 2.0, -0.5]), ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]), ([0.5; 3], [0.5; 3])] {
            let (sum, mut q, mut inner, mut mean) = (length(&a, &b) + 0.7, [0.0; 3], 0, [0.0; 3]);
            for _ in 0..20_000 {
                in_ellipsoid(&a, &b, sum, &mut random, &mut q);
                assert!(length(&a, &q) + length(&q, &b) <= sum * (1.0 + 1e-12));
                let half = |i: usize| 0.5 * (a[i] + b[i]) + 2.0 * (q[i] - 0.5 * (a[i] + b[i]));
                let twice: Vec<f64> = (0..3).map(half).collect();
                // Half the size has an eighth of the volume.
                inner += usize::from(length(&a, &twice) + length(&twice, &b) <= sum);
                (0..3).for_each(|i| mean[i] += (q[i] - 0.5 * (a[i] + b[i])) / 20_000.0);
            }
            assert!((f64::from(inner as u32) / 20_000.0 - 0.125).abs() < 0.01, "{inner}");
            assert!(mean.iter().all(|m| m.abs() < 0.02), "{mean:?}");
        }
    }
}
