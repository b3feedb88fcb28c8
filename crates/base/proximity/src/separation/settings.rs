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
    /// The witness points to return if they are not unique.
    pub witness_points: WitnessPoints,
    /// For two meshes: the start of the search, which is replaced by the start for the next query of the same two
    /// meshes. It changes the time, never the answer. Other pairs of shapes ignore it.
    pub warm_start: Option<&'w mut WarmStart>,
}

impl Default for DistanceSettings<'_> {
    /// No limit, continuous witness points, a cold start.
    fn default() -> Self {
        Self { limit: f64::INFINITY, witness_points: WitnessPoints::Continuous, warm_start: None }
    }
}

/// The witness points to return if they are not unique.
///
/// They are not unique if faces, edges or sides of two shapes (other than spheres and half-spaces) are so nearly
/// parallel that the distances of many pairs of points are within 2e-8 of the sizes (radii, added) of the smallest
/// distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WitnessPoints {
    /// The pair nearest to a point between the centres of the shapes, close to the centre of the smaller shape. This
    /// pair changes continuously with the poses, while the nearest pair itself would jump. The distance of its points
    /// exceeds the smallest distance by at most that tolerance.
    #[default]
    Continuous,
    /// The pair found first. Faster, for queries in which only the distance matters.
    Any,
}
