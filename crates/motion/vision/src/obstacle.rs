//! Obstacles: upright prisms with an identity.

use std::fmt;
use std::sync::Arc;

use elbowroom_spatial::{Aabb, Vec3};

use crate::Point2;

/// Identity of an obstacle from entering to leaving. A tracker never uses an identity twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct ObstacleId(pub u64);

impl fmt::Display for ObstacleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// The change of an obstacle since the previous frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ObstacleChange {
    /// The obstacle is new.
    #[default]
    Entered,
    /// The prism changed.
    Moved,
    /// The prism is the same.
    Unchanged,
    /// The obstacle is gone; reported once.
    Left,
}

/// An upright prism: all points above its footprint from `z_from_m` to `z_to_m`, world frame.
///
/// The prism contains the observed outline, inflated by
/// [`TrackSettings::uncertainty_m`](crate::TrackSettings::uncertainty_m), under the assumption stated
/// in the crate's documentation (objects stand on the floor and do not overhang).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Obstacle {
    /// Identity of the obstacle.
    pub id: ObstacleId,
    /// Change since the previous frame.
    pub change: ObstacleChange,
    /// Name of the matching template, which gives the height.
    pub kind: Option<Arc<str>>,
    /// Corners of the convex footprint, counter-clockwise, world x and y, metres.
    pub footprint_m: Vec<Point2>,
    /// Lower end, world z, metres: the floor for obstacles of a camera.
    pub z_from_m: f64,
    /// Upper end, world z, metres.
    pub z_to_m: f64,
    /// Estimated centre in this frame, world x and y, metres: not a bound.
    pub centre_m: Point2,
    /// Estimated velocity of the centre, metres per second: not a bound.
    pub velocity_mps: Point2,
    /// Whether the obstacle was not observed in this frame (occluded by the arm, or missed) and keeps its last
    /// position.
    pub is_unobserved: bool,
}

impl Obstacle {
    /// The prism's corners, world frame: the lower corners, then the upper corners in the same order.
    pub fn corners(&self) -> impl Iterator<Item = Vec3> + '_ {
        [self.z_from_m, self.z_to_m]
            .into_iter()
            .flat_map(|z| self.footprint_m.iter().map(move |p| Vec3::new(p.x, p.y, z)))
    }

    /// The bounding box of the prism, world frame.
    pub fn aabb(&self) -> Aabb {
        Aabb::from_points(self.corners())
    }

    /// Overwrites `self` with `other` and reuses the memory of the footprint.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let mut footprint_m = std::mem::take(&mut self.footprint_m);
        footprint_m.clone_from(&other.footprint_m);
        let Self { id, change, ref kind, z_from_m, z_to_m, centre_m, velocity_mps, is_unobserved, .. } = *other;
        let kind = kind.clone();
        *self = Self { id, change, kind, footprint_m, z_from_m, z_to_m, centre_m, velocity_mps, is_unobserved };
    }
}
