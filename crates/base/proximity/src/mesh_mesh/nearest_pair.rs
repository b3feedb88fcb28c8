//! The result of a search for the nearest pair of triangles.

use super::warm_start::WarmStart;
use crate::triangle::ClosestPoints;

/// The nearest pair of triangles so far, units of A.
#[derive(Clone, Copy)]
pub(super) struct NearestPair {
    pub distance: f64,
    pub points: ClosestPoints,
    pub triangles: (u32, u32),
    pub warm_start: WarmStart,
    /// Lower bound of the sum of the distances between the points of tied pairs and the points of this pair.
    pub spread: f64,
}
