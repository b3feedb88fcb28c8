//! Exits from path ends that have less than the clearance.

use super::motion_validator::MotionValidator as _;
use super::random::Random;
use super::scene_validator::SceneValidator;
use crate::grid_path::PathEnd;

/// Distance of the first samples from the end, as rad (or m) of the joint that moves solids most.
const FIRST_RADIUS: f64 = 0.01;
/// Distance of the last samples from the end, measured like the first distance.
const LAST_RADIUS: f64 = 1.0;
/// Factor from one distance to the next.
const RADIUS_FACTOR: f64 = 1.4;
/// Samples at each distance.
const SAMPLES_PER_RADIUS: usize = 32;

/// Why an end has no exit.
#[derive(Debug)]
pub(super) enum ExitError {
    /// The end violates the constraint.
    Violation {
        /// The violation in words.
        what: String,
        /// Distance from the violation in metres: 0 or less, or NaN.
        distance_m: f64,
    },
    /// No exit was found.
    NotFound,
}

/// Samples exits.
pub(super) struct ClearanceExit<'a, 's> {
    pub validator: &'a mut SceneValidator<'s>,
    pub random: &'a mut Random,
}

impl ClearanceExit<'_, '_> {
    /// Returns the end itself if it has the clearance. Otherwise returns a nearby configuration with the clearance,
    /// and a straight segment to it is proven: the segment keeps half of the distance at the end and comes no nearer to
    /// a violation of the constraint. Restores the settings of the sweep.
    pub fn find(mut self, end: PathEnd, q: &[f64], clearance_m: f64) -> Result<Vec<f64>, ExitError> {
        let violation = self.validator.constraint.as_mut().and_then(|constraint| constraint.violation(q));
        let violation = violation.map(|(what, distance_m)| ExitError::Violation { what, distance_m });
        if end == PathEnd::Goal
            && let Some(violation) = violation
        {
            return Err(violation);
        }
        let before = self.validator.sweep;
        let distance = self.validator.nearest_pair(q).map_or(f64::INFINITY, |d| d.metres);
        let has_clearance = distance > clearance_m + before.tolerance_m;
        let found = if has_clearance && self.validator.satisfies_constraint(q) {
            Some(q.to_vec())
        } else {
            let kept_m = if has_clearance { clearance_m } else { 0.5 * distance };
            self.sample(q, clearance_m, kept_m)
        };
        self.validator.sweep = before;
        found.ok_or(violation.unwrap_or(ExitError::NotFound))
    }

    /// Samples a configuration with the clearance to which a segment is proven that keeps `kept_m`.
    fn sample(&mut self, end: &[f64], clearance_m: f64, kept_m: f64) -> Option<Vec<f64>> {
        let mut radius = FIRST_RADIUS;
        let mut candidate = end.to_vec();
        while radius <= LAST_RADIUS {
            for _ in 0..SAMPLES_PER_RADIUS {
                if self.validator.is_exhausted() {
                    return None;
                }
                sample_at_distance(self.validator, end, radius, self.random, &mut candidate);
                self.validator.bounds.clamp(&mut candidate);
                self.validator.sweep.clearance_m = clearance_m;
                if !self.validator.is_free(&candidate) {
                    continue;
                }
                self.validator.sweep.clearance_m = kept_m;
                if self.validator.proves_departure(end, &candidate) {
                    return Some(candidate);
                }
            }
            radius *= RADIUS_FACTOR;
        }
        None
    }
}

/// A random configuration at a weighted distance.
fn sample_at_distance(validator: &SceneValidator<'_>, from: &[f64], radius: f64, random: &mut Random, out: &mut [f64]) {
    for ((to, q), rad) in out.iter_mut().zip(from).zip(validator.equivalent_steps(1.0)) {
        *to = q + random.between(-1.0, 1.0) * rad;
    }
    let far = validator.distance(from, out);
    let scale = if far > 0.0 { radius / far } else { 0.0 };
    out.iter_mut().zip(from).for_each(|(to, q)| *to = q + (*to - q) * scale);
}
