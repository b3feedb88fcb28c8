//! Constraints on paths beyond the solids of the scene.

use std::fmt::Debug;

use crate::interpolation::lerp;

/// Margin of a proof, m, the same as for sweeps.
const TOLERANCE_M: f64 = 1e-4;
/// Number of evaluations after which a segment counts as not proven.
const MAX_EVALUATIONS: u32 = 20_000;
/// Factor on motion bounds for the rounding of their sums.
const ROUNDING_FACTOR: f64 = 1.0 + 1e-9;

/// A constraint on paths beyond the solids of the scene, for example to avoid the regions of a monitor.
///
/// Configurations are all values of the robot, rad (m for prismatic joints). NaN counts as a violation.
pub trait PathConstraint: Debug {
    /// Lower bound of the distance of all guarded points from a violation, m; 0 or less if the constraint is violated.
    /// If the distance is more than `limit_m`, the method may return any greater number.
    fn distance_m(&mut self, q: &[f64], limit_m: f64) -> f64;

    /// Like [`distance_m`](Self::distance_m), minus the margin that paths keep, which may vary with the place. A path
    /// has a smaller margin only while it leaves a start or reaches a goal with a smaller margin.
    fn margin_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.distance_m(q, limit_m)
    }

    /// Upper bound of the displacement of all guarded points, m, while all joints move straight and together from one
    /// configuration to another. A fraction of that motion displaces the points by at most the same fraction of the
    /// bound.
    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64;

    /// Describes the violation at a configuration, or the nearest one, in words: "region `press`".
    fn describe_nearest(&mut self, q: &[f64]) -> String;

    /// Longest edge of a tree, rad (and m), if the constraint leaves only a thin part of the joint space: then samples
    /// are moved by [`project`](Self::project). `None` if most configurations satisfy the constraint.
    fn projected_edge_length(&self) -> Option<f64> {
        None
    }

    /// Moves a configuration slightly to one that satisfies the constraint; does not change it if it does already.
    /// False if that fails.
    fn project(&mut self, q: &mut [f64]) -> bool {
        let _ = q;
        true
    }
}

impl<C: PathConstraint + ?Sized> PathConstraint for &mut C {
    fn distance_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        (**self).distance_m(q, limit_m)
    }

    fn margin_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        (**self).margin_m(q, limit_m)
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        (**self).motion_bound_m(from, to)
    }

    fn describe_nearest(&mut self, q: &[f64]) -> String {
        (**self).describe_nearest(q)
    }

    fn projected_edge_length(&self) -> Option<f64> {
        (**self).projected_edge_length()
    }

    fn project(&mut self, q: &mut [f64]) -> bool {
        (**self).project(q)
    }
}

/// All of several constraints: a path satisfies each of them. Distances of different kinds (1 rad counts as 1 m) are
/// compared as numbers, and the least one counts.
impl PathConstraint for Vec<Box<dyn PathConstraint + '_>> {
    fn distance_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.iter_mut().map(|c| c.distance_m(q, limit_m)).fold(f64::INFINITY, least)
    }

    fn margin_m(&mut self, q: &[f64], limit_m: f64) -> f64 {
        self.iter_mut().map(|c| c.margin_m(q, limit_m)).fold(f64::INFINITY, least)
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        self.iter_mut().map(|c| c.motion_bound_m(from, to)).fold(0.0, greatest)
    }

    fn describe_nearest(&mut self, q: &[f64]) -> String {
        let distances = self.iter_mut().map(|c| c.distance_m(q, f64::INFINITY)).enumerate();
        let nearest = distances.reduce(|a, b| if least(a.1, b.1).to_bits() == a.1.to_bits() { a } else { b });
        nearest.map_or_else(String::new, |(index, _)| self[index].describe_nearest(q))
    }

    fn projected_edge_length(&self) -> Option<f64> {
        self.iter().filter_map(|c| c.projected_edge_length()).reduce(f64::min)
    }

    /// Each constraint in turn: a later one may undo an earlier one, and the configuration is then rejected.
    fn project(&mut self, q: &mut [f64]) -> bool {
        self.iter_mut().all(|c| c.project(q))
    }
}

/// The smaller number; NaN if either is.
fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// The greater number; NaN if either is.
fn greatest(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// Checks configurations and motions against a constraint.
#[derive(Debug)]
pub(crate) struct ConstraintChecker<'c> {
    constraint: Box<dyn PathConstraint + 'c>,
}

impl<'c> ConstraintChecker<'c> {
    pub fn new(constraint: impl PathConstraint + 'c) -> Self {
        Self { constraint: Box::new(constraint) }
    }

    /// The violation at a configuration in words, and its distance; `None` if the constraint is satisfied.
    pub fn violation(&mut self, q: &[f64]) -> Option<(String, f64)> {
        let distance = self.constraint.distance_m(q, 0.0);
        // Comparisons with NaN are false.
        (!(distance > 0.0)).then(|| (self.constraint.describe_nearest(q), distance))
    }

    /// See [`PathConstraint::projected_edge_length`].
    pub fn projected_edge_length(&self) -> Option<f64> {
        self.constraint.projected_edge_length()
    }

    /// See [`PathConstraint::project`].
    pub fn project(&mut self, q: &mut [f64]) -> bool {
        self.constraint.project(q)
    }

    /// Whether a configuration keeps the margin of paths, with a margin for a proof.
    pub fn is_free(&mut self, q: &[f64]) -> bool {
        self.constraint.margin_m(q, TOLERANCE_M) > TOLERANCE_M
    }

    /// Proves that the straight segment keeps the margin of paths.
    pub fn proves_motion(&mut self, from: &[f64], to: &[f64]) -> bool {
        let motion_bound = self.constraint.motion_bound_m(from, to);
        proves_segment(from, to, motion_bound, TOLERANCE_M, |q, limit| self.constraint.margin_m(q, limit))
    }

    /// Like [`proves_motion`](Self::proves_motion), but `from` may have a smaller margin. Then the segment comes no
    /// nearer to a violation than `from` is, up to a tolerance that is less than the distance of `from` from a
    /// violation.
    pub fn proves_departure(&mut self, from: &[f64], to: &[f64]) -> bool {
        if self.is_free(from) {
            return self.proves_motion(from, to);
        }
        let distance = self.constraint.distance_m(from, f64::INFINITY);
        let tolerance = if distance > 0.0 { TOLERANCE_M.min(0.5 * distance) } else { TOLERANCE_M };
        let kept = distance - tolerance;
        let motion_bound = self.constraint.motion_bound_m(from, to);
        proves_segment(from, to, motion_bound, 0.5 * tolerance, |q, limit| {
            self.constraint.distance_m(q, limit + kept.max(0.0)) - kept
        })
    }
}

/// Conservative advancement from the middle outwards: a margin at a configuration proves the part of the segment on
/// which no point moves farther than the margin. If less than `need` is left, nothing is proven, because the proof
/// might not terminate.
fn proves_segment(
    from: &[f64],
    to: &[f64],
    motion_bound: f64,
    need: f64,
    mut margin: impl FnMut(&[f64], f64) -> f64,
) -> bool {
    let motion_bound = motion_bound * ROUNDING_FACTOR;
    if !motion_bound.is_finite() {
        return false;
    }
    let mut q = from.to_vec();
    let mut open = vec![(0.0, 1.0)];
    for _ in 0..MAX_EVALUATIONS {
        let Some((begin, end)) = open.pop() else { return true };
        let middle = 0.5 * (begin + end);
        lerp(from, to, middle, &mut q);
        let half = 0.5 * (end - begin) * motion_bound;
        let left = margin(&q, half + need);
        // Comparisons with NaN are false.
        if !(left > need) {
            return false;
        }
        if left <= half {
            let free = left / motion_bound;
            open.push((middle + free, end));
            open.push((begin, middle - free));
        }
    }
    open.is_empty()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]
        /// A ball in the plane and a straight segment. If a segment is proven, every sample has a positive distance. If
        /// every sample has a positive distance (and slightly more than a proof needs), the segment is proven.
        #[test]
        fn proofs_agree_with_fine_sampling(
            from in prop::array::uniform2(-1.0..1.0_f64),
            to in prop::array::uniform2(-1.0..1.0_f64),
            radius in 0.0..0.7_f64,
            loose in 1.0..5.0_f64,
        ) {
            let distance = |q: &[f64]| q[0].hypot(q[1]) - radius;
            let motion_bound = (from[0] - to[0]).hypot(from[1] - to[1]) * loose;
            let proven = proves_segment(&from, &to, motion_bound, TOLERANCE_M, |q, _| distance(q));
            let mut q = [0.0; 2];
            let least = (0..=2_000).map(|n| {
                lerp(&from, &to, f64::from(n) / 2_000.0, &mut q);
                distance(&q)
            }).fold(f64::INFINITY, f64::min);
            prop_assert!(!proven || least > 0.0, "{least}");
            // Every sample is within 0.75 mm of the nearest point of all.
            prop_assert!(proven || least < TOLERANCE_M + 7.5e-4, "{least}");
        }
    }

    /// A ball that a point of the plane keeps out of.
    #[derive(Debug)]
    struct Ball {
        x: f64,
        projects: bool,
    }

    impl PathConstraint for Ball {
        fn distance_m(&mut self, q: &[f64], _: f64) -> f64 {
            (q[0] - self.x).hypot(q[1]) - 0.1
        }

        fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
            (from[0] - to[0]).hypot(from[1] - to[1])
        }

        fn describe_nearest(&mut self, _: &[f64]) -> String {
            format!("ball {}", self.x)
        }

        fn projected_edge_length(&self) -> Option<f64> {
            self.projects.then_some(self.x.abs())
        }

        fn project(&mut self, q: &mut [f64]) -> bool {
            q[1] += self.x;
            self.projects
        }
    }

    #[test]
    fn of_several_constraints_the_nearest_counts() {
        let ball = |x, projects| Box::new(Ball { x, projects }) as Box<dyn PathConstraint>;
        let mut both = vec![ball(0.5, true), ball(-0.4, true)];
        assert!((both.distance_m(&[0.2, 0.0], 1.0) - 0.2).abs() < 1e-12);
        assert!((both.distance_m(&[-0.2, 0.0], 1.0) - 0.1).abs() < 1e-12);
        assert_eq!(
            (both.describe_nearest(&[0.2, 0.0]), both.describe_nearest(&[-0.2, 0.0])),
            ("ball 0.5".into(), "ball -0.4".into())
        );
        assert!(
            both.distance_m(&[f64::NAN, 0.0], 1.0).is_nan()
                && both.motion_bound_m(&[0.0; 2], &[f64::NAN, 0.0]).is_nan()
        );
        assert!((both.motion_bound_m(&[0.0, 0.0], &[0.0, 2.0]) - 2.0).abs() < 1e-12);
        let mut q = [0.0, 0.0];
        assert!(both.project(&mut q) && (q[1] - 0.1).abs() < 1e-12);
        assert_eq!(both.projected_edge_length(), Some(0.4));
        assert_eq!(vec![ball(0.5, false)].projected_edge_length(), None);
        let mut none: Vec<Box<dyn PathConstraint>> = Vec::new();
        assert!(
            none.distance_m(&[0.0], 1.0) == f64::INFINITY
                && none.project(&mut q)
                && none.describe_nearest(&q).is_empty()
        );
        // A proof for both: between the balls, not through one of them.
        let mut checker = ConstraintChecker::new(both);
        assert!(checker.proves_motion(&[0.0, -1.0], &[0.1, 1.0]));
        assert!(
            !checker.proves_motion(&[-0.4, -1.0], &[-0.4, 1.0]) && !checker.proves_motion(&[0.5, -1.0], &[0.5, 1.0])
        );
    }

    #[test]
    fn nan_is_not_proven() {
        let (from, to) = ([0.0], [1.0]);
        for (motion_bound, left) in [(f64::NAN, 1.0), (f64::INFINITY, 1.0), (1.0, f64::NAN), (0.0, f64::NAN)] {
            assert!(!proves_segment(&from, &to, motion_bound, 1e-4, |_, _| left));
        }
        assert!(proves_segment(&from, &to, 1.0, 1e-4, |_, _| 0.6));
        assert!(proves_segment(&from, &from, 0.0, 1e-4, |_, _| f64::INFINITY));
        // Unknown at a configuration in between.
        let unknown = |q: &[f64]| if q[0] > 0.7 && q[0] < 0.8 { f64::NAN } else { 0.1 };
        assert!(!proves_segment(&from, &to, 1.0, 1e-4, |q, _| unknown(q)));
    }
}
