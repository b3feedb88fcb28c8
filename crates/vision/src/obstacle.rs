//! What vision knows: upright prisms with an identity.

use std::fmt;
use std::sync::Arc;

use elbowroom_proximity::{ConvexHull, HullError};
use elbowroom_spatial::{Aabb, Vec3};

use crate::Point2;

/// Who an obstacle is, from its entering to its leaving. Never used twice by one tracker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct ObstacleId(pub u64);

impl fmt::Display for ObstacleId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// What became of an obstacle since the frame before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Change {
    /// It is new.
    #[default]
    Entered,
    /// Its prism is another one.
    Moved,
    /// Its prism is the same: nothing to do.
    Still,
    /// It is gone; told once.
    Left,
}

/// An upright prism: all points above its footprint from `z_from_m` to `z_to_m`, world frame.
///
/// The prism contains what was seen, grown by [`Settings::uncertainty_m`](crate::Settings::uncertainty_m), under the
/// assumption stated in the crate's documentation (things stand on the floor and do not overhang).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Obstacle {
    /// Who it is.
    pub id: ObstacleId,
    /// What became of it.
    pub change: Change,
    /// The template that it fits; its height is then known.
    pub kind: Option<Arc<str>>,
    /// Corners of its convex footprint, counter-clockwise, world x and y, metres.
    pub footprint_m: Vec<Point2>,
    /// Its lower end, world z, metres: the floor, for what a camera sees.
    pub z_from_m: f64,
    /// Its upper end, world z, metres.
    pub z_to_m: f64,
    /// Where its middle is believed to be in this frame, world x and y, metres: no bound, but the best guess.
    pub centre_m: Point2,
    /// How that moves, metres per second: no bound either.
    pub velocity_mps: Point2,
    /// It was not seen in this frame (hidden by the arm, or lost for a moment) and is kept where it was.
    pub is_remembered: bool,
}

impl Obstacle {
    /// The prism's corners, world frame: first the lower ones, then the upper ones in the same order.
    pub fn corners(&self) -> impl Iterator<Item = Vec3> + '_ {
        [self.z_from_m, self.z_to_m]
            .into_iter()
            .flat_map(|z| self.footprint_m.iter().map(move |p| Vec3::new(p.x, p.y, z)))
    }

    /// The prism as a solid of the world.
    ///
    /// # Errors
    /// A footprint without an area or a prism without a height, which no obstacle of this crate has.
    pub fn to_hull(&self) -> Result<ConvexHull, HullError> {
        ConvexHull::from_points(&self.corners().collect::<Vec<_>>())
    }

    /// The box around the prism, world frame.
    pub fn aabb(&self) -> Aabb {
        Aabb::from_points(self.corners())
    }

    /// Overwrites `self` with `other`, keeping the memory.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        let mut footprint_m = std::mem::take(&mut self.footprint_m);
        footprint_m.clone_from(&other.footprint_m);
        *self = Self { footprint_m, kind: other.kind.clone(), ..Self::plain(other) };
    }

    /// All but the lists.
    fn plain(other: &Self) -> Self {
        Self {
            id: other.id,
            change: other.change,
            kind: None,
            footprint_m: Vec::new(),
            z_from_m: other.z_from_m,
            z_to_m: other.z_to_m,
            centre_m: other.centre_m,
            velocity_mps: other.velocity_mps,
            is_remembered: other.is_remembered,
        }
    }
}
