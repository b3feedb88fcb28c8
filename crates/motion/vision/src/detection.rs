//! What one frame shows of an obstacle.

use crate::Point2;

/// A blob or cluster on the floor: metres, world x and y.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detection {
    /// Convex outline.
    pub(crate) outline_m: Vec<Point2>,
    pub(crate) centre_m: Point2,
    pub(crate) area: f64,
    /// Mean grey level, or any other feature on that scale.
    pub(crate) brightness: f64,
    /// It touches the arm's silhouette: a part of it may be occluded.
    pub(crate) touches_arm: bool,
    /// It touches the image border: a part of it may lie outside.
    pub(crate) touches_border: bool,
    pub(crate) z_from_m: f64,
    pub(crate) z_to_m: f64,
}
