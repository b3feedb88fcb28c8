//! Settings of a distance query.

use crate::mesh_mesh::WarmStart;

/// Settings of a distance query.
///
/// ```
/// use elbowroom_proximity::{DistanceSettings, WarmStart};
/// let mut warm_start = WarmStart::default();
/// let settings = DistanceSettings { limit: 0.5, warm_start: Some(&mut warm_start), ..DistanceSettings::default() };
/// assert!(settings.limit < DistanceSettings::default().limit);
/// ```
#[derive(Debug)]
pub struct DistanceSettings<'w> {
    /// Largest distance of interest, metres: the query may end as soon as the shapes are proven to be farther apart.
    pub limit: f64,
    /// Which witness points are returned where they are not unique.
    pub witness_points: WitnessPoints,
    /// For two meshes: where the search begins, replaced by where the next query of the same two meshes should begin. It changes
    /// the time, never the answer. Other pairs of shapes ignore it.
    pub warm_start: Option<&'w mut WarmStart>,
}

impl Default for DistanceSettings<'_> {
    /// No limit, continuous witness points, a cold start.
    fn default() -> Self {
        Self { limit: f64::INFINITY, witness_points: WitnessPoints::Continuous, warm_start: None }
    }
}

/// Which witness points are returned where they are not unique.
///
/// That is where faces, edges or sides of two shapes (other than spheres and half-spaces) are so nearly parallel that many pairs
/// of points are within 2e-8 of the sizes (radii, added) of the least distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WitnessPoints {
    /// The pair nearest to a point between the centres of the shapes, near that of the smaller: it changes continuously with the
    /// poses where the nearest pair itself would jump. It is farther apart than the distance by no more than that tolerance.
    #[default]
    Continuous,
    /// The pair found first: faster, for queries in which only the distance matters.
    Any,
}
