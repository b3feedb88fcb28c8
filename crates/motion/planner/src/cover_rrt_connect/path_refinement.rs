//! Random local changes that make a proven path shorter; every new edge is proven, too.

use crate::interpolation::{length, lerp, path_length};
use crate::rrt_connect::{MotionValidator, Random, SamplingRegion};

/// Number of failed changes in a row, per corner, after which a path is left as it is.
const TRIALS: usize = 10;
/// Smallest gain of a change, as a fraction of the length.
const LEAST_GAIN: f64 = 5e-4;
/// Largest random share of an edge that is cut off; from 1 on, the whole edge goes.
const MAX_CUT: f64 = 1.25;
/// Largest sideways move of a corner, in each value, as a fraction of its distance from the segment between its neighbours.
const MAX_SIDE: f64 = 0.5;

/// Changes corners of a path at random, as long as that makes it shorter.
pub(super) struct PathRefinement<'v, V> {
    pub validator: &'v mut V,
    pub region: &'v SamplingRegion,
    pub random: &'v mut Random,
}

impl<V: MotionValidator> PathRefinement<'_, V> {
    pub fn run(&mut self, path: &mut Vec<Vec<f64>>) {
        let least_gain = LEAST_GAIN * path_length(path);
        let mut failures = 0;
        while path.len() > 2 && failures < TRIALS * (path.len() - 2) && !self.validator.is_exhausted() {
            let corner = 1 + ((self.random.unit() * (path.len() - 2) as f64) as usize).min(path.len() - 3);
            let is_shorter = if self.random.unit() < 0.5 {
                self.cut(path, corner, least_gain)
            } else {
                self.shift(path, corner, least_gain)
            };
            failures = if is_shorter { 0 } else { failures + 1 };
        }
    }

    /// Replaces a corner by an edge between random points before and after it.
    fn cut(&mut self, path: &mut Vec<Vec<f64>>, corner: usize, least_gain: f64) -> bool {
        let shares = [0, 1].map(|_| (MAX_CUT * self.random.unit()).min(1.0));
        let neighbours = [corner - 1, corner + 1];
        let mut ends = [path[corner].clone(), path[corner].clone()];
        let mut gain = 0.0;
        for ((end, share), other) in ends.iter_mut().zip(shares).zip(neighbours) {
            if share < 1.0 {
                lerp(&path[corner], &path[other], share, end);
            } else {
                end.clone_from(&path[other]);
            }
            gain += share * length(&path[corner], &path[other]);
        }
        gain -= length(&ends[0], &ends[1]);
        if gain <= least_gain || !self.validator.is_valid_motion(&ends[0], &ends[1]) {
            return false;
        }
        // A whole edge ends at the neighbour itself, which stays.
        let kept = ends.into_iter().zip(shares).filter(|(_, share)| *share < 1.0).map(|(end, _)| end);
        path.splice(corner..=corner, kept.collect::<Vec<_>>());
        true
    }

    /// Moves a corner towards the segment between its neighbours, and a little to the side.
    fn shift(&mut self, path: &mut [Vec<f64>], corner: usize, least_gain: f64) -> bool {
        let [before, at, after] = [&path[corner - 1], &path[corner], &path[corner + 1]];
        let edges = [length(before, at), length(at, after)];
        let [mut middle, mut moved] = [at.clone(), at.clone()];
        lerp(before, after, edges[0] / (edges[0] + edges[1]), &mut middle);
        lerp(at, &middle, self.random.unit(), &mut moved);
        let side = MAX_SIDE * self.random.unit() * length(at, &middle);
        for value in &mut moved {
            *value += self.random.between(-side, side);
        }
        self.region.clamp(&mut moved);
        if !self.validator.project(&mut moved) {
            return false;
        }
        let gain = edges[0] + edges[1] - length(before, &moved) - length(&moved, after);
        let is_shorter = gain > least_gain
            && self.validator.is_valid_motion(before, &moved)
            && self.validator.is_valid_motion(&moved, after);
        if is_shorter {
            path[corner] = moved;
        }
        is_shorter
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_robot::example;

    use super::*;
    use crate::rrt_connect::JointBounds;

    /// Free outside a ball of radius 0.5 about the origin.
    struct Ball {
        is_exhausted: bool,
    }

    const BALL: Ball = Ball { is_exhausted: false };

    impl MotionValidator for Ball {
        fn motion_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
            let mut at = from.to_vec();
            (0..=100).all(|i| {
                lerp(from, to, f64::from(i) / 100.0, &mut at);
                length(&at, &[0.0; 3]) >= 0.5
            })
        }

        fn is_exhausted(&mut self) -> bool {
            self.is_exhausted
        }

        fn longest_edge(&self) -> f64 {
            1.0
        }
    }

    #[test]
    fn a_detour_becomes_almost_as_short_as_possible_and_stays_free() {
        let bounds = JointBounds::new(&example::arm().unwrap().chain);
        let ends = [[-1.0, 0.05, 0.0], [1.0, 0.0, 0.05]];
        let region = bounds.sampling_region_of(ends.iter().map(|q| &q[..]));
        // Tangents, and the arc between them.
        let shortest = 2.0 * 0.75_f64.sqrt() + std::f64::consts::FRAC_PI_6;
        let mut sum = 0.0;
        for seed in 0..20 {
            let mut path = vec![ends[0].to_vec(), vec![0.1, 1.0, -0.7], ends[1].to_vec()];
            let before = path_length(&path);
            let mut random = Random::new(seed);
            PathRefinement { validator: &mut { BALL }, region: &region, random: &mut random }.run(&mut path);
            assert!(path_length(&path) < before);
            assert!(path.windows(2).all(|edge| { BALL }.motion_is_free(&edge[0], &edge[1])));
            assert_eq!((&path[0][..], &path[path.len() - 1][..]), (&ends[0][..], &ends[1][..]));
            sum += path_length(&path) / shortest;
        }
        assert!(sum / 20.0 < 1.1, "{}", sum / 20.0);
    }

    #[test]
    fn degenerate_paths_stay_finite_and_an_exhausted_search_changes_nothing() {
        let bounds = JointBounds::new(&example::arm().unwrap().chain);
        let [a, b, c] = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]].map(|q| q.to_vec());
        let region = bounds.sampling_region_of([&a[..], &b[..], &c[..]]);
        let refine = |path: &[&Vec<f64>], is_exhausted: bool| {
            let (mut path, mut random) = (path.iter().copied().cloned().collect::<Vec<_>>(), Random::new(1));
            PathRefinement { validator: &mut Ball { is_exhausted }, region: &region, random: &mut random }
                .run(&mut path);
            path
        };
        for path in [&[&a][..], &[&a, &a], &[&a, &a, &a], &[&a, &b, &b, &c], &[&a, &a, &b, &c, &c]] {
            let refined = refine(path, false);
            assert_eq!((refined.first(), refined.last()), (path.first().copied(), path.last().copied()));
            assert!(refined.iter().flatten().all(|value| value.is_finite()), "{refined:?}");
            assert_eq!(refine(path, true), path.iter().copied().cloned().collect::<Vec<_>>());
        }
    }
}
