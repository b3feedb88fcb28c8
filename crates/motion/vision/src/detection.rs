//! Detections: the observation of an obstacle in one frame.

use crate::Point2;

/// A blob or cluster on the floor: metres, world x and y.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detection {
    /// Convex outline.
    pub(crate) outline_m: Vec<Point2>,
    pub(crate) centre_m: Point2,
    pub(crate) area: f64,
    /// Mean grey level, or another feature on this scale.
    pub(crate) brightness: f64,
    /// Whether the blob touches the arm's silhouette, so that a part may be occluded.
    pub(crate) touches_arm: bool,
    /// Whether the blob touches the image border, so that a part may be outside.
    pub(crate) touches_border: bool,
    pub(crate) z_from_m: f64,
    pub(crate) z_to_m: f64,
}
