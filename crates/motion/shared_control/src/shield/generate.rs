//! Generation of a shield: the level of a distance field.

use std::sync::Arc;

use elbowroom_proximity::{Shape, TriMesh, project_point};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::error::ShieldError;
use super::level_set::{Field, level_set};
use super::opening::{Foot, Opening};
use super::settings::ShieldSettings;
use super::target::{ShieldTarget, TargetSurface};
use crate::NavigatorError;
use crate::protected_surface::check_solid;

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
    check_fineness(protected, settings)?;
    let solid = Shape::Mesh(protected.clone());
    let surface = TargetSurface::new(&solid, protected, settings);
    // A target on triangles that face inwards seems to come from inside.
    let feet = surface
        .feet(target)
        .map_err(|e| if protected.is_oriented() { e } else { NavigatorError::Unoriented.into() })?;
    // The level lies half the tolerance outside, so that no facet cuts into what is protected; the opening is wider by as
    // much.
    let level = 0.5 * settings.tolerance_m;
    let obliqueness = feet.iter().map(|f| surface.cosine(f)).fold(1.0, f64::min);
    let opening = Opening::new(&feet, settings.cut(level, obliqueness));
    let field = ShieldField { solid: &solid, opening: &opening, offset_m: settings.offset_m };
    let margin = Vec3::splat(settings.offset_m + 2.0 * settings.tolerance_m);
    let bounds = Aabb { min: protected.aabb().min - margin, max: protected.aabb().max + margin };
    let (vertices, triangles) = level_set(&field, level, &bounds, edge_m);
    let mesh = TriMesh::new(vertices, triangles).map_err(|_| ShieldError::NothingLeft)?;
    if !mesh.report().closed || mesh.report().inside_out {
        return Err(ShieldError::NotClosed);
    }
    let passage = feet.iter().map(|Foot { point, axis }| (*point, *axis)).collect();
    Ok(Shield { mesh: Arc::new(mesh), passage })
}

/// A point of a tetrahedron of the grid is at most 0.87 edges from its corners, averaged as the field is interpolated,
/// and vertices keep 1/64 of an edge from them. Half the tolerance is 0.9 edges, so the surface lies between the field's
/// values 0 and the tolerance.
const EDGES_PER_TOLERANCE: f64 = 1.8;
/// Most cubes along an axis of the grid.
const MOST_CUBES: f64 = 1_048_576.0;

/// Marching tetrahedra give about nine triangles per square of the grid.
fn check_fineness(mesh: &TriMesh, settings: &ShieldSettings) -> Result<(), ShieldError> {
    let edge_m = settings.tolerance_m / EDGES_PER_TOLERANCE;
    let corner = |v: u32| mesh.vertices()[v as usize];
    let area = |&[a, b, c]: &[u32; 3]| 0.5 * (corner(b) - corner(a)).cross(corner(c) - corner(a)).length();
    // The surface of a box around the offset solid bounds what the offset adds.
    let box_area = |e: Vec3| 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
    let (size, grown) = (mesh.aabb().extent(), mesh.aabb().extent() + Vec3::splat(2.0 * settings.offset_m));
    let area = mesh.triangles().iter().map(area).sum::<f64>() + box_area(grown) - box_area(size);
    let triangles = 9.0 * area / (edge_m * edge_m);
    if triangles > ShieldError::MOST_TRIANGLES as f64 || grown.max_element() / edge_m > MOST_CUBES {
        return Err(ShieldError::TooFine { tolerance_m: settings.tolerance_m, triangles: triangles as usize });
    }
    Ok(())
}
