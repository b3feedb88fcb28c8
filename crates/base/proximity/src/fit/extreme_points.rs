//! The points of a set that determine its enclosing shapes.

use std::collections::HashSet;

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::margin::scale;
use super::{capsule, cuboid, principal_axes};
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
    /// Principal axes of the points, each as often as it is given.
    principal: Rotation,
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
        let found = hull.as_ref().and_then(|hull| points_on_surface(points, hull));
        let points = found.as_deref().unwrap_or(points);
        Self { points: distinct(points), principal: principal_axes::principal(points), hull }
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
        capsule::fit(&self.points, self.principal)
    }

    /// A small enclosing box and its frame in the frame of the points.
    pub(crate) fn enclosing_cuboid(&self) -> Option<(Cuboid, Pose)> {
        cuboid::fit(&self.points, self.principal, self.hull.as_ref())
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

/// Each point once: meshes and the corners of their hulls repeat most of them. Of equal points the last one is kept, since
/// of points that are equally far away the last one counts; the first point of all stays the first.
fn distinct(points: &[Vec3]) -> Vec<Vec3> {
    let mut seen = HashSet::with_capacity(points.len());
    let is_new = |p: &&Vec3| seen.insert(p.to_array().map(f64::to_bits));
    let mut kept: Vec<Vec3> = points.iter().rev().filter(is_new).copied().collect();
    kept.extend(points.first());
    kept.reverse();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::bounding_sphere;
    use elbowroom_testkit::random::Random;

    #[test]
    fn the_order_of_the_last_ones_is_kept() {
        let [a, b, c] = [Vec3::X, Vec3::Y, Vec3::Z];
        assert_eq!(distinct(&[a, b, a, c, b]), [a, a, c, b]);
        assert_eq!(distinct(&[b]), [b, b]);
        assert!(distinct(&[]).is_empty());
    }

    #[test]
    fn repeated_points_change_no_fit() {
        let mut random = Random(3);
        for _ in 0..20 {
            // Coordinates on a grid, so that many points are equally far away, and some are equal.
            let few: Vec<Vec3> =
                (0..60).map(|_| Vec3::from([(); 3].map(|()| (4.0 * random.unit()).round() + 0.1))).collect();
            let points: Vec<Vec3> = few.iter().chain(few[7..30].iter().rev()).copied().collect();
            let (once, axes) = (distinct(&points), principal_axes::principal(&points));
            assert!(once.len() < points.len());
            assert_eq!(bounding_sphere::smallest(&once), bounding_sphere::smallest(&points));
            let fits = |points| format!("{:?} {:?}", capsule::fit(points, axes), cuboid::fit(points, axes, None));
            assert_eq!(fits(&once), fits(&points));
        }
    }
}
