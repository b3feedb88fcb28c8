//! A surface that a tool must not enter.

use std::sync::Arc;

use elbowroom_proximity::TriMesh;
use elbowroom_proximity::advanced::{LocalMinimum, NormalConeHierarchy};
use elbowroom_spatial::{Pose, Vec3};

use crate::NavigatorError;

/// Distance below which the line between two nearest points has no usable direction, metres.
const TOUCHING_M: f64 = 1e-9;

/// The closed surface of a solid, placed in the world. Copies share the cones of its normals.
#[derive(Debug, Clone)]
pub struct ProtectedSurface {
    pub(crate) surface: Arc<NormalConeHierarchy>,
    pub(crate) in_world: Pose,
    /// Whether the tool keeps off it now.
    pub(crate) is_on: bool,
}

impl ProtectedSurface {
    /// Places a mesh.
    ///
    /// # Errors
    /// A mesh that is open, inside out or not oriented, or a pose that is not finite.
    pub fn new(mesh: Arc<TriMesh>, in_world: Pose) -> Result<Self, NavigatorError> {
        check_solid(&mesh)?;
        if !mesh.is_oriented() {
            return Err(NavigatorError::Unoriented);
        }
        let surface = Arc::new(NormalConeHierarchy::new(mesh));
        if !in_world.is_finite() {
            return Err(NavigatorError::PoseNotFinite("a protected surface"));
        }
        Ok(Self { surface, in_world, is_on: true })
    }

    /// The surface as it is at first: on, or off until [`SurfaceNavigator::switch`](crate::SurfaceNavigator::switch).
    #[must_use]
    pub fn switched(self, is_on: bool) -> Self {
        Self { is_on, ..self }
    }

    /// The unit vector along which the distance of a tool, the first body of the minimum, grows.
    pub(crate) fn away(&self, near: &LocalMinimum) -> Vec3 {
        let apart = near.separation.on_a - near.separation.on_b;
        if near.separation.distance > TOUCHING_M
            && let Some(direction) = apart.try_normalize()
        {
            return direction;
        }
        let mesh = self.surface.mesh();
        let [a, b, c] = mesh.triangles()[near.triangle_b as usize].map(|v| mesh.vertices()[v as usize]);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Z);
        self.in_world.transform_vector(normal)
    }
}

/// Refuses a mesh that bounds no solid.
pub(crate) fn check_solid(mesh: &TriMesh) -> Result<(), NavigatorError> {
    if !mesh.report().closed {
        return Err(NavigatorError::Open);
    }
    if mesh.report().inside_out {
        return Err(NavigatorError::InsideOut);
    }
    Ok(())
}
