//! Obstacle update: the result of one frame.

use elbowroom_proximity::{ConvexHull, HullError, Shape};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::{FrameStatus, ObstacleId, Point2, polygon};

use crate::prism_boxes::prism_boxes;
use crate::times::PerceptionTimes;

/// One observed obstacle, as in the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Prism {
    /// Identity of the obstacle.
    pub id: ObstacleId,
    /// Name of the matching template.
    pub kind: Option<String>,
    /// Corners of the footprint at the time of the frame, dilated by the uncertainty, world x and y, metres.
    pub footprint_m: Vec<Point2>,
    /// Footprint that covers the present one and the predicted one
    /// [`PerceptionSettings::prediction_s`](crate::PerceptionSettings::prediction_s) later.
    pub swept_m: Vec<Point2>,
    /// Lower end, world z, metres.
    pub z_from_m: f64,
    /// Upper end, world z, metres.
    pub z_to_m: f64,
    /// Estimated centre, world x and y, metres.
    pub centre_m: Point2,
    /// Velocity of the centre, metres per second.
    pub velocity_mps: Point2,
    /// Whether the obstacle was not visible in this frame and keeps its last position.
    pub is_unobserved: bool,
}

impl Prism {
    /// The solid over the observed footprint, in the world frame.
    ///
    /// # Errors
    /// The prism has no volume.
    pub fn observed_solid(&self) -> Result<ConvexHull, HullError> {
        prism_hull(&self.footprint_m, [self.z_from_m, self.z_to_m])
    }

    /// The solid over the observed and the predicted footprint, in the world frame.
    ///
    /// # Errors
    /// The prism has no volume.
    pub fn predicted_solid(&self) -> Result<ConvexHull, HullError> {
        prism_hull(&self.swept_m, [self.z_from_m, self.z_to_m])
    }

    /// Boxes that together contain the [observed solid](Self::observed_solid), each with its pose in the world. A
    /// joint-space map of boxes takes a hundredth of the time of a map of other hulls.
    pub fn observed_boxes(&self) -> Vec<(Shape, Pose)> {
        prism_boxes(&self.footprint_m, [self.z_from_m, self.z_to_m])
    }

    /// Boxes that together contain the [predicted solid](Self::predicted_solid), each with its pose in the world.
    pub fn predicted_boxes(&self) -> Vec<(Shape, Pose)> {
        prism_boxes(&self.swept_m, [self.z_from_m, self.z_to_m])
    }

    /// Whether the observed footprint contains a convex footprint (world x and y, metres).
    pub fn contains(&self, footprint_m: &[Point2]) -> bool {
        footprint_m.iter().all(|&p| polygon::convex_contains(&self.footprint_m, p))
    }
}

/// The changes by one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ObstacleUpdate {
    /// Time stamp of the frame, seconds.
    pub stamp_s: f64,
    /// Whether the frame was accepted.
    pub status: FrameStatus,
    /// All obstacles in the map.
    pub prisms: Vec<Prism>,
    /// Obstacles that entered.
    pub entered: Vec<ObstacleId>,
    /// Obstacles that left.
    pub left: Vec<ObstacleId>,
    /// Cells that became blocked, summed over the obstacles.
    pub blocked: usize,
    /// Cells that became free, summed over the obstacles.
    pub freed: usize,
    /// Wall-clock time per stage.
    pub times: PerceptionTimes,
}

impl ObstacleUpdate {
    /// Whether the frame was accepted and the map is up to date.
    pub fn is_accepted(&self) -> bool {
        self.status == FrameStatus::Accepted
    }
}

/// The convex hull of an upright prism.
pub(super) fn prism_hull(footprint_m: &[Point2], heights_m: [f64; 2]) -> Result<ConvexHull, HullError> {
    let at = |z: f64| footprint_m.iter().map(move |p| Vec3::new(p.x, p.y, z));
    let points: Vec<Vec3> = heights_m.into_iter().flat_map(at).collect();
    ConvexHull::from_points(&points)
}
