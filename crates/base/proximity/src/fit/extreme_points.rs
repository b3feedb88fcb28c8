//! The points of a set that determine its enclosing shapes.

use elbowroom_spatial::{Pose, Vec3};

use super::margin::scale;
use super::{capsule, cuboid};
use crate::{Capsule, ConvexHull, Cuboid};

/// The extreme points of a set and their convex hull, computed once for several fits.
///
/// ```
/// use elbowroom_proximity::fit::ExtremePoints;
/// use elbowroom_spatial::Vec3;
/// let points = ExtremePoints::of(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(0.1)]).unwrap();
/// assert_eq!(points.hull().unwrap().vertices().len(), 4);
/// assert!(points.capsule().is_some() && points.cuboid().is_some());
/// ```
#[derive(Debug, Clone)]
pub struct ExtremePoints {
    /// The corners of the hull, or all points if they are flat. A hull may exclude points by its tolerance, so points
    /// that are not exactly inside are kept.
    points: Vec<Vec3>,
    hull: Option<ConvexHull>,
}

impl ExtremePoints {
    /// Computes the extreme points; `None` without points or if one is not finite.
    pub fn of(points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || !points.iter().all(|p| p.is_finite()) {
            return None;
        }
        Some(Self::with_hull(points, ConvexHull::from_points(points).ok()))
    }

    /// Computes the extreme points of at least one finite point, with a known hull.
    pub(crate) fn with_hull(points: &[Vec3], hull: Option<ConvexHull>) -> Self {
        let points = hull.as_ref().and_then(|hull| points_on_surface(points, hull)).unwrap_or_else(|| points.to_vec());
        Self { points, hull }
    }

    /// The convex hull; `None` if the points are flat.
    pub fn hull(&self) -> Option<&ConvexHull> {
        self.hull.as_ref()
    }

    pub(super) fn points(&self) -> &[Vec3] {
        &self.points
    }

    /// A small enclosing capsule and its frame in the frame of the points.
    pub(crate) fn enclosing_capsule(&self) -> Option<(Capsule, Pose)> {
        capsule::fit(&self.points)
    }

    /// A small enclosing box and its frame in the frame of the points.
    pub(crate) fn enclosing_cuboid(&self) -> Option<(Cuboid, Pose)> {
        cuboid::fit(&self.points, self.hull.as_ref())
    }
}

/// The hull's vertices and the points on or outside its surface; `None` if finding them would take too long.
fn points_on_surface(points: &[Vec3], hull: &ConvexHull) -> Option<Vec<Vec3>> {
    let mut kept = hull.vertices().to_vec();
    let margin = 1e-13 * scale(points);
    let near_surface = |p: Vec3| hull.planes().iter().any(|(n, offset)| n.dot(p) > offset - margin);
    if points.len() > 4096 && points.len() * hull.planes().len() >= 50_000_000 {
        return None;
    }
    kept.extend(points.iter().copied().filter(|&p| near_surface(p)));
    Some(kept)
}
