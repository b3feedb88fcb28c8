//! The line of a target along the surface.

use std::sync::Arc;

use elbowroom_proximity::{Shape, TriMesh};
use elbowroom_spatial::Vec3;

use super::error::ShieldError;
use super::settings::ShieldSettings;
use super::target::TargetSurface;

/// The line of a [`ShieldTarget`](super::ShieldTarget) along the surface of a mesh: the given points and points between
/// them, in the frame of the mesh. A closed line is the border of an area; its first point is repeated at its end.
///
/// # Errors
/// The errors of [`generate_shield`](super::generate_shield) that concern the line: points off the surface, a line that
/// leaves it, or too few points.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, contact::triangle_surface};
/// use elbowroom_shared_control::{ShieldError, ShieldSettings, line_on_surface};
/// use elbowroom_spatial::Vec3;
/// let skull = triangle_surface(&Shape::Sphere(Sphere { radius: 0.05 }), 1e-4).unwrap();
/// let settings = ShieldSettings::with_width(0.005);
/// let quarter = line_on_surface(&skull, &[Vec3::X * 0.05, Vec3::Y * 0.05], false, &settings)?;
/// assert!(quarter.iter().all(|p| (p.length() - 0.05).abs() < 1e-4) && quarter.len() > 20);
/// let off = line_on_surface(&skull, &[Vec3::X * 0.05, Vec3::Y * 0.08], false, &settings);
/// assert!(matches!(off, Err(ShieldError::OffSurface { number: 2, .. })));
/// # Ok::<(), ShieldError>(())
/// ```
pub fn line_on_surface(
    protected: &Arc<TriMesh>,
    points: &[Vec3],
    is_closed: bool,
    settings: &ShieldSettings,
) -> Result<Vec<Vec3>, ShieldError> {
    settings.check()?;
    let shape = Shape::Mesh(protected.clone());
    TargetSurface::new(&shape, protected, settings).line(points, if is_closed { 3 } else { 2 })
}
