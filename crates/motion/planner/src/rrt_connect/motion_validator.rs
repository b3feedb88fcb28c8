//! What a search asks about motions.

/// Validates straight motions in joint space.
///
/// Searches test each motion by which a tree grows, and ask for a proof of the motions of a path only: a validator may
/// therefore test quickly, for example at some configurations, and prove lazily.
pub(crate) trait MotionValidator {
    /// Whether the motion between two configurations, of which the first one is valid, passes the test.
    fn motion_is_free(&mut self, from: &[f64], to: &[f64]) -> bool;

    /// Number of motions that [`failing_motions`](Self::failing_motions) takes at once, at most 32; 1 if it knows nothing before
    /// the test.
    fn motions_at_once(&self) -> usize {
        1
    }

    /// Which of several motions certainly fail the test: one bit per motion. A motion without a bit may fail too.
    fn failing_motions(&mut self, motions: &[(&[f64], &[f64])]) -> u32 {
        let _ = motions;
        0
    }

    /// Whether a motion that passed the test is proven free. By default the test is a proof.
    fn proves_motion(&mut self, from: &[f64], to: &[f64]) -> bool {
        let _ = (from, to);
        true
    }

    /// Whether the search must end.
    fn is_exhausted(&mut self) -> bool;

    /// Longest edge of a tree, rad (and m).
    fn longest_edge(&self) -> f64;

    /// Moves a configuration so that it satisfies a constraint. False if that fails.
    fn project(&mut self, q: &mut [f64]) -> bool {
        let _ = q;
        true
    }

    /// Whether a motion passes the test and is proven free.
    fn is_valid_motion(&mut self, from: &[f64], to: &[f64]) -> bool {
        self.motion_is_free(from, to) && self.proves_motion(from, to)
    }
}
