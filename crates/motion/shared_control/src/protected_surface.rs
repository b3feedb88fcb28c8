//! A surface that a tool must not enter.

use std::sync::Arc;

use elbowroom_proximity::TriMesh;
use elbowroom_proximity::advanced::NormalConeHierarchy;
use elbowroom_spatial::Pose;

use crate::NavigatorError;

/// The closed surface of a solid, placed in the world.
#[derive(Debug, Clone)]
pub struct ProtectedSurface {
    pub(crate) surface: NormalConeHierarchy,
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
        let surface = NormalConeHierarchy::new(mesh);
        if !surface.is_oriented() {
            return Err(NavigatorError::Unoriented);
        }
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
