//! Bounding shapes of points: sphere, capsule, box. Each encloses every point.
//!
//! Each fit is verified against all points in the arithmetic of the distance queries, and enlarged by a margin for
//! rounding. Fits use the vertices of the convex hull if it exists.

mod bounding_sphere;
mod capsule;
mod cuboid;
mod extreme_points;
mod margin;
mod principal_axes;

use elbowroom_spatial::{Pose, Vec3};

use crate::{Capsule, Cuboid, Shape, Sphere, TriMesh};
pub use extreme_points::ExtremePoints;
use margin::{MARGIN, scale};

/// A shape that encloses given points.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Capsule, cuboid or sphere.
    pub shape: Shape,
    /// Pose of the shape's frame in the frame of the points.
    pub in_frame: Pose,
    /// Volume of the shape, m³.
    pub volume: f64,
}

/// A small enclosing capsule. `None` without points or if one is not finite.
///
/// Its axis starts at the principal axes and is rotated to a local minimum of the volume.
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

/// A small enclosing box. `None` without points or if one is not finite.
///
/// It starts flush with a face and an edge of the convex hull, or along the principal axes, and is rotated to a
/// local minimum of the volume.
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

/// The smallest enclosing sphere. `None` without points or if one is not finite.
///
/// ```
/// use elbowroom_proximity::{Shape, fit};
/// use elbowroom_spatial::Vec3;
/// let fit = fit::sphere(&[Vec3::X, -Vec3::X, Vec3::Y * 0.5]).unwrap();
/// assert!(matches!(fit.shape, Shape::Sphere(s) if (s.radius - 1.0).abs() < 1e-12));
/// ```
pub fn sphere(points: &[Vec3]) -> Option<Fit> {
    let extreme = ExtremePoints::of(points)?;
    let points = extreme.points();
    let (center, _) = bounding_sphere::smallest(points);
    let in_frame = Pose::from_translation(center);
    let reach = points.iter().fold(0.0, |r: f64, p| r.max(p.distance(center)));
    let sphere = Sphere { radius: reach + MARGIN * scale(points) };
    Some(Fit { shape: Shape::Sphere(sphere), in_frame, volume: sphere.volume() })
}

/// The smaller of capsule and box by volume. `None` without points or if one is not finite.
///
/// ```
/// use elbowroom_proximity::{Shape, fit};
/// use elbowroom_spatial::{Obb, Pose, Vec3};
/// let corners = Obb { pose: Pose::IDENTITY, half_extents: Vec3::new(0.3, 0.2, 0.1) }.corners();
/// assert!(matches!(fit::tightest(&corners).unwrap().shape, Shape::Cuboid(_)));
/// ```
pub fn tightest(points: &[Vec3]) -> Option<Fit> {
    let extreme = ExtremePoints::of(points)?;
    smaller(extreme.capsule(), extreme.cuboid())
}

/// Like [`capsule`], for the vertices of a mesh; stored with the mesh.
pub(crate) fn capsule_of_mesh(mesh: &TriMesh) -> Option<Fit> {
    mesh.enclosing_capsule().map(Fit::from)
}

/// Like [`cuboid`], for the vertices of a mesh; stored with the mesh.
pub(crate) fn cuboid_of_mesh(mesh: &TriMesh) -> Option<Fit> {
    mesh.enclosing_cuboid().map(Fit::from)
}

/// Like [`tightest`], for the vertices of a mesh; stored with the mesh.
pub(crate) fn tightest_of_mesh(mesh: &TriMesh) -> Option<Fit> {
    smaller(capsule_of_mesh(mesh), cuboid_of_mesh(mesh))
}

fn smaller(capsule: Option<Fit>, cuboid: Option<Fit>) -> Option<Fit> {
    let (capsule, cuboid) = (capsule?, cuboid?);
    Some(if capsule.volume < cuboid.volume { capsule } else { cuboid })
}

impl From<(Capsule, Pose)> for Fit {
    fn from((capsule, in_frame): (Capsule, Pose)) -> Self {
        Self { shape: Shape::Capsule(capsule), in_frame, volume: capsule.volume() }
    }
}

impl From<(Cuboid, Pose)> for Fit {
    fn from((cuboid, in_frame): (Cuboid, Pose)) -> Self {
        Self { shape: Shape::Cuboid(cuboid), in_frame, volume: cuboid.volume() }
    }
}

impl ExtremePoints {
    /// Like [`capsule`], for all points.
    pub fn capsule(&self) -> Option<Fit> {
        self.enclosing_capsule().map(Fit::from)
    }

    /// Like [`cuboid`], for all points.
    pub fn cuboid(&self) -> Option<Fit> {
        self.enclosing_cuboid().map(Fit::from)
    }
}
