//! Simple shapes around points, always enclosing every one of them.
//!
//! Each fit is verified against all the points by the arithmetic that the distance queries use, and grown by what
//! rounding asks for. Fits work on the convex hull's vertices where there is one.

mod ball;
mod capsule;
mod cuboid;
mod frame;

use elbowroom_spatial::{Pose, Vec3};

use crate::{ConvexHull, Shape, Sphere};

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

/// Room for the rounding of a pose that is composed with others later, as a fraction of the coordinates.
const GROWTH: f64 = 4.0 * f64::EPSILON;

/// A small enclosing capsule: axis from the principal axes, then turned to the least volume (a local minimum).
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
    Outermost::of(points)?.capsule()
}

/// A small enclosing box: flush with a face and an edge of the convex hull or along the principal axes, then turned to
/// the least volume (a local minimum). `None` without points or where one is not finite.
///
/// ```
/// use elbowroom_proximity::fit;
/// use elbowroom_spatial::Vec3;
/// let fit = fit::cuboid(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(1.0)]).unwrap();
/// assert!(fit.volume < 1.0 + 1e-9);
/// ```
pub fn cuboid(points: &[Vec3]) -> Option<Fit> {
    Outermost::of(points)?.cuboid()
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
    let Outermost { points, .. } = Outermost::of(points)?;
    let (center, _) = ball::smallest(&points);
    let in_frame = Pose::from_translation(center);
    let reach = points.iter().fold(0.0, |r: f64, p| r.max(p.distance(center)));
    let sphere = Sphere { radius: reach + GROWTH * scale(&points) };
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
    let outermost = Outermost::of(points)?;
    let (capsule, cuboid) = (outermost.capsule()?, outermost.cuboid()?);
    Some(if capsule.volume < cuboid.volume { capsule } else { cuboid })
}

/// The points that matter to a fit and their convex hull, found once for several fits.
///
/// ```
/// use elbowroom_proximity::fit::Outermost;
/// use elbowroom_spatial::Vec3;
/// let points = Outermost::of(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(0.1)]).unwrap();
/// assert_eq!(points.hull().unwrap().vertices().len(), 4);
/// assert!(points.capsule().is_some() && points.cuboid().is_some());
/// ```
#[derive(Debug, Clone)]
pub struct Outermost {
    /// Those of the hull, or all where there is no hull. A hull may leave points out by its tolerance, so those that it
    /// does not hold exactly stay in.
    points: Vec<Vec3>,
    hull: Option<ConvexHull>,
}

impl Outermost {
    /// `None` without points or where one is not finite.
    pub fn of(points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || !points.iter().all(|p| p.is_finite()) {
            return None;
        }
        let hull = ConvexHull::from_points(points).ok();
        let points = hull.as_ref().and_then(|hull| extreme(points, hull)).unwrap_or_else(|| points.to_vec());
        Some(Self { points, hull })
    }

    /// The convex hull; `None` where the points have no inside.
    pub fn hull(&self) -> Option<&ConvexHull> {
        self.hull.as_ref()
    }

    /// Like [`capsule`] of all the points.
    pub fn capsule(&self) -> Option<Fit> {
        let (capsule, in_frame) = capsule::fit(&self.points)?;
        Some(Fit { shape: Shape::Capsule(capsule), in_frame, volume: capsule.volume() })
    }

    /// Like [`cuboid`] of all the points.
    pub fn cuboid(&self) -> Option<Fit> {
        let (cuboid, in_frame) = cuboid::fit(&self.points, self.hull.as_ref())?;
        Some(Fit { shape: Shape::Cuboid(cuboid), in_frame, volume: cuboid.volume() })
    }
}

/// The hull's vertices and what is on or outside of its surface; `None` where finding out would take too long.
fn extreme(points: &[Vec3], hull: &ConvexHull) -> Option<Vec<Vec3>> {
    let mut kept = hull.vertices().to_vec();
    let margin = 1e-13 * scale(points);
    let near_surface = |p: Vec3| hull.planes().iter().any(|(n, offset)| n.dot(p) > offset - margin);
    if points.len() > 4096 && points.len() * hull.planes().len() >= 50_000_000 {
        return None;
    }
    kept.extend(points.iter().copied().filter(|&p| near_surface(p)));
    Some(kept)
}

fn scale(points: &[Vec3]) -> f64 {
    points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()))
}
