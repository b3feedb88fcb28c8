//! Covers that are built once: nearly all time of a small map goes into them, and most cases have the arm of the examples.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoverSource, SphereCover};

/// By slack and shapes, as they are printed: the digits of a number are all that it takes to read it again.
static KEPT: Mutex<BTreeMap<String, Option<SphereCover>>> = Mutex::new(BTreeMap::new());

/// The source of covers for the tests of this program.
#[derive(Debug)]
pub struct KeptCovers;

impl CoverSource for KeptCovers {
    fn cover(&self, shapes: &[(&Shape, Pose)], slack_m: f64) -> Option<SphereCover> {
        let key = format!("{slack_m:?} {shapes:?}");
        let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        kept.unwrap_or_else(|| {
            let cover = SphereCover::new(shapes, slack_m);
            KEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(key, cover.clone());
            cover
        })
    }
}
