//! Bounding shapes of points: sphere, capsule, box. They enclose every point.
//!
//! Each fit is verified against all points in the arithmetic of the distance queries, and enlarged by a margin for rounding.
//! Fits use the vertices of the convex hull where there is one.

mod bounding_sphere;
mod capsule;
mod cuboid;
mod margin;
mod principal_axes;

use elbowroom_spatial::{Pose, Vec3};

use crate::{ConvexHull, Shape, Sphere};
use margin::{MARGIN, scale};

/// A shape that encloses given points.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Capsule, cuboid or sphere.
    pub shape: Shape,
    /// Its frame in the frame of the points.
    pub in_frame: Pose,
    /// Its volume, m³.
    pub volume: f64,
}

/// A small enclosing capsule: its axis starts at the principal axes and is rotated to a local minimum of the volume.
/// `None` without points or where one is not finite.
///
/// ```
/// use elbowroom_proximity::{Shape, fit};
/// use elbowroom_spatial::Vec3;
/// let rod = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.05, 0.0), Vec3::new(0.5, -0.05, 0.0)];
/// let fit = fit::capsule(&rod).unwrap();
/// assert!(matches!(fit.shape, Shape::Capsule(c) if c.radius < 0.06));
/// ```
pub fn capsule(points: &[Vec3]) -> Option<Fit> {
    ExtremePoints::of(points)?.capsule()
}

/// A small enclosing box: it starts flush with a face and an edge of the convex hull or along the principal axes, and is
/// rotated to a local minimum of the volume. `None` without points or where one is not finite.
///
/// ```
/// use elbowroom_proximity::fit;
/// use elbowroom_spatial::Vec3;
/// let fit = fit::cuboid(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(1.0)]).unwrap();
/// assert!(fit.volume < 1.0 + 1e-9);
/// ```
pub fn cuboid(points: &[Vec3]) -> Option<Fit> {
    ExtremePoints::of(points)?.cuboid()
}

/// The smallest enclosing sphere. `None` without points or where one is not finite.
///
/// ```
/// use elbowroom_proximity::{Shape, fit};
/// use elbowroom_spatial::Vec3;
/// let fit = fit::sphere(&[Vec3::X, -Vec3::X, Vec3::Y * 0.5]).unwrap();
/// assert!(matches!(fit.shape, Shape::Sphere(s) if (s.radius - 1.0).abs() < 1e-12));
/// ```
pub fn sphere(points: &[Vec3]) -> Option<Fit> {
    let ExtremePoints { points, .. } = ExtremePoints::of(points)?;
    let (center, _) = bounding_sphere::smallest(&points);
    let in_frame = Pose::from_translation(center);
    let reach = points.iter().fold(0.0, |r: f64, p| r.max(p.distance(center)));
    let sphere = Sphere { radius: reach + MARGIN * scale(&points) };
    Some(Fit { shape: Shape::Sphere(sphere), in_frame, volume: sphere.volume() })
}

/// The smaller of capsule and box by volume. `None` without points or where one is not finite.
///
/// ```
/// use elbowroom_proximity::{Shape, fit};
/// use elbowroom_spatial::{Obb, Pose, Vec3};
/// let corners = Obb { pose: Pose::IDENTITY, half_extents: Vec3::new(0.3, 0.2, 0.1) }.corners();
/// assert!(matches!(fit::tightest(&corners).unwrap().shape, Shape::Cuboid(_)));
/// ```
pub fn tightest(points: &[Vec3]) -> Option<Fit> {
    let extreme = ExtremePoints::of(points)?;
    let (capsule, cuboid) = (extreme.capsule()?, extreme.cuboid()?);
    Some(if capsule.volume < cuboid.volume { capsule } else { cuboid })
}

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
    /// Those of the hull, or all where there is no hull. A hull may exclude points by its tolerance, so those that are not
    /// exactly inside are kept.
    points: Vec<Vec3>,
    hull: Option<ConvexHull>,
}

impl ExtremePoints {
    /// `None` without points or where one is not finite.
    pub fn of(points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || !points.iter().all(|p| p.is_finite()) {
            return None;
        }
        let hull = ConvexHull::from_points(points).ok();
        let points = hull.as_ref().and_then(|hull| points_on_surface(points, hull)).unwrap_or_else(|| points.to_vec());
        Some(Self { points, hull })
    }

    /// The convex hull; `None` where the points are flat.
    pub fn hull(&self) -> Option<&ConvexHull> {
        self.hull.as_ref()
    }

    /// [`capsule`] of all points.
    pub fn capsule(&self) -> Option<Fit> {
        let (capsule, in_frame) = capsule::fit(&self.points)?;
        Some(Fit { shape: Shape::Capsule(capsule), in_frame, volume: capsule.volume() })
    }

    /// [`cuboid`] of all points.
    pub fn cuboid(&self) -> Option<Fit> {
        let (cuboid, in_frame) = cuboid::fit(&self.points, self.hull.as_ref())?;
        Some(Fit { shape: Shape::Cuboid(cuboid), in_frame, volume: cuboid.volume() })
    }
}

/// The hull's vertices and the points on or outside of its surface; `None` where finding them would take too long.
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
