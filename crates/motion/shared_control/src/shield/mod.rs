//! Shields: a surface that protects a solid and is opened along a target.

mod error;
mod level_set;
mod opening;
mod target;

use std::sync::Arc;

use elbowroom_proximity::{Shape, TriMesh, project_point};
use elbowroom_spatial::{Aabb, Pose, Vec3};

pub use error::ShieldError;
use level_set::{Field, level_set};
use opening::{Cut, Foot, Opening};
pub use target::ShieldTarget;
use target::TargetSurface;

use crate::NavigatorError;
use crate::protected_surface::check_solid;

/// Dimensions of a shield, metres and radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShieldSettings {
    /// Distance of the shield from the protected surface.
    pub offset_m: f64,
    /// Width of the opening at its ground.
    pub width_m: f64,
    /// Depth of the ground below the surface.
    pub depth_m: f64,
    /// Angle between the wall of the opening and its axis: 0 for parallel walls.
    pub flare_rad: f64,
    /// Largest error of the shield. Nothing farther than this outside the opening is bare, and nothing farther than this
    /// inside is blocked. The edge of the grid is a part of it, so time and triangles grow with its inverse square.
    pub tolerance_m: f64,
}

/// A closed surface around a protected solid, opened along a target.
#[derive(Debug, Clone)]
pub struct Shield {
    /// The surface, in the frame of the protected mesh.
    pub mesh: Arc<TriMesh>,
    /// Points of the target on the protected surface, each with the direction in which a tool leaves it.
    pub passage: Vec<(Vec3, Vec3)>,
}

/// The solid moved outwards, without the opening: negative inside. It changes by at most 1 per metre.
struct ShieldField<'a> {
    solid: &'a Shape,
    opening: &'a Opening,
    offset_m: f64,
}

impl Field for ShieldField<'_> {
    fn value(&self, p: Vec3) -> f64 {
        let solid = project_point(self.solid, &Pose::IDENTITY, p).signed_distance - self.offset_m;
        solid.max(-self.opening.distance(p))
    }
}

/// Generates the shield of a solid for a target on its surface.
///
/// The shield is the level of a distance field (README.md of the crate), so it is closed, faces outwards and does not
/// cross itself. Points of the target may be off the surface by the tolerance.
///
/// # Errors
/// A mesh that bounds no solid, dimensions that are not usable, a target off the surface, or a tolerance too fine for
/// the size of the solid.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere, contact::triangle_surface};
/// use elbowroom_shared_control::{ShieldSettings, ShieldTarget, generate_shield};
/// use elbowroom_spatial::Vec3;
/// let skull = triangle_surface(&Shape::Sphere(Sphere { radius: 0.05 }), 1e-4).unwrap();
/// let cut = ShieldTarget::Line((-3..=3).map(|k| Vec3::new(0.2 * f64::from(k), 0.0, 1.0)).map(|p| p * (0.05 / p.length())).collect());
/// let settings = ShieldSettings { offset_m: 0.005, width_m: 0.01, depth_m: 0.004, flare_rad: 0.2, tolerance_m: 0.003 };
/// let shield = generate_shield(&skull, &cut, &settings)?;
/// assert!(shield.mesh.report().closed && !shield.mesh.report().inside_out);
/// // The target is outside the shield, the rest of the surface inside.
/// assert!(!shield.mesh.contains(Vec3::Z * 0.05) && shield.mesh.contains(Vec3::Y * 0.05));
/// # Ok::<(), elbowroom_shared_control::ShieldError>(())
/// ```
pub fn generate_shield(
    protected: &Arc<TriMesh>,
    target: &ShieldTarget,
    settings: &ShieldSettings,
) -> Result<Shield, ShieldError> {
    check_solid(protected)?;
    settings.check()?;
    let edge_m = settings.tolerance_m / EDGES_PER_TOLERANCE;
    check_fineness(protected, settings.tolerance_m)?;
    let solid = Shape::Mesh(protected.clone());
    let corners = protected.triangles().iter().map(|t| t.map(|v| protected.vertices()[v as usize])).collect();
    let surface = TargetSurface::new(&solid, corners, settings.tolerance_m);
    // Openings this far apart leave ridges of a quarter of the tolerance between them.
    let spacing_m = (settings.width_m * settings.tolerance_m).sqrt();
    let feet = surface.feet(target, spacing_m, settings.width_m)?;
    // The level lies half the tolerance outside, so that no facet cuts into what is protected; the opening is wider by as
    // much.
    let level = 0.5 * settings.tolerance_m;
    let opening = Opening::new(&feet, settings.cut(level));
    let field = ShieldField { solid: &solid, opening: &opening, offset_m: settings.offset_m };
    let margin = Vec3::splat(settings.offset_m + 2.0 * settings.tolerance_m);
    let bounds = Aabb { min: protected.aabb().min - margin, max: protected.aabb().max + margin };
    let (vertices, triangles) = level_set(&field, level, &bounds, edge_m);
    let mesh = TriMesh::new(vertices, triangles).map_err(|_| ShieldError::EmptyArea)?;
    let passage = feet.iter().map(|Foot { point, axis }| (*point, *axis)).collect();
    Ok(Shield { mesh: Arc::new(mesh), passage })
}

impl ShieldSettings {
    fn check(&self) -> Result<(), ShieldError> {
        let positive = [("width_m", self.width_m), ("tolerance_m", self.tolerance_m)];
        let not_negative = [("offset_m", self.offset_m), ("depth_m", self.depth_m), ("flare_rad", self.flare_rad)];
        if let Some(&(name, value)) = positive.iter().find(|(_, x)| !(x.is_finite() && *x > 0.0)) {
            return Err(NavigatorError::Setting { name, value, wanted: "a positive number" }.into());
        }
        if let Some(&(name, value)) = not_negative.iter().find(|(_, x)| !(x.is_finite() && *x >= 0.0)) {
            return Err(NavigatorError::Setting { name, value, wanted: "0 or more" }.into());
        }
        if self.flare_rad > 1.4 {
            let (name, value) = ("flare_rad", self.flare_rad);
            return Err(NavigatorError::Setting { name, value, wanted: "at most 1.4 (80°)" }.into());
        }
        Ok(())
    }

    /// The opening, wider by `margin_m` on all sides.
    fn cut(&self, margin_m: f64) -> Cut {
        Cut {
            radius_m: 0.5 * self.width_m + margin_m,
            depth_m: self.depth_m + margin_m,
            // Through the shield, and no farther: a flare without an end would open what overhangs.
            height_m: 2.0 * self.offset_m + 4.0 * self.tolerance_m,
            flare: self.flare_rad.sin_cos(),
        }
    }
}

/// Facets cut corners of the field by up to 0.6 edges, measured; half the tolerance is 0.63 edges.
const EDGES_PER_TOLERANCE: f64 = 1.25;

/// Marching tetrahedra give about nine triangles per square of the grid.
fn check_fineness(mesh: &TriMesh, tolerance_m: f64) -> Result<(), ShieldError> {
    let edge_m = tolerance_m / EDGES_PER_TOLERANCE;
    let corner = |v: u32| mesh.vertices()[v as usize];
    let area = |&[a, b, c]: &[u32; 3]| 0.5 * (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
    let triangles = 9.0 * mesh.triangles().iter().map(area).sum::<f64>() / (edge_m * edge_m);
    if triangles > ShieldError::MOST_TRIANGLES as f64 {
        return Err(ShieldError::TooFine { tolerance_m, triangles: triangles as usize });
    }
    Ok(())
}
