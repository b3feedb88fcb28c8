//! Covers that are built only once: they take nearly all the time of a small map, and most cases use the arm of the
//! examples.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoverSource, SphereCover};

/// Covers by slack and shapes in printed form: the digits of a printed number suffice to read it again.
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
