//! The frame of a query. It is near both groups, so that single precision is sufficient.

use elbowroom_spatial::{Pose, Vec3};

use crate::lanes::{F32_ERROR, narrow};

/// Distance (m) from the frame's origin beyond which single precision decides nothing. The same limit applies to the
/// frame's distance from the world's origin.
const FARTHEST_M: f64 = 1e6;
/// Rounding of positions in the world, as a fraction of their coordinates.
const WORLD_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A pose in the frame of a query, in single precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct PoseF32 {
    pub rows: [[f32; 3]; 3],
    pub shift: [f32; 3],
}

/// A frame with the axes of the world and its origin in the first mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct GroupFrame {
    origin: Vec3,
}

impl GroupFrame {
    #[inline]
    pub fn at(origin: Vec3) -> Self {
        Self { origin }
    }

    #[inline]
    pub fn pose(&self, pose: &Pose) -> PoseF32 {
        PoseF32 {
            rows: pose.rotation.rows().map(|row| row.map(|x| x as f32)),
            shift: narrow(pose.translation - self.origin),
        }
    }

    /// Transforms a point of a mesh to the frame.
    #[inline]
    pub fn point(&self, pose: &Pose, p: Vec3) -> [f32; 3] {
        narrow(pose.rotation * p + (pose.translation - self.origin))
    }

    /// Bound of the error of a distance of two spheres, m, if no coordinate is larger than `extent_m`, in the frame or
    /// in the mesh. `None` if single precision is not sufficient.
    ///
    /// Each entry of a matrix is rounded by half a unit of its last place, and so is each step of a centre's coordinate:
    /// eight half-units of 2⁻²⁴ of the extent. That is 16 for two centres and 28 for three coordinates; squares, radii
    /// and their sums add less than 16. [`F32_ERROR`] is 128.
    #[inline]
    pub fn error_m(&self, extent_m: f64) -> Option<f32> {
        let far = self.origin.x.abs() + self.origin.y.abs() + self.origin.z.abs() + extent_m;
        (far < FARTHEST_M).then_some((extent_m * F32_ERROR + WORLD_ROUNDING * far) as f32)
    }
}
