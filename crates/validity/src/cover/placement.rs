//! Shapes at their poses in one frame: triangles, and how deep a point lies in a shape.

use elbowroom_proximity::{Shape, project_point, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};

/// Deviation of triangles from a curved surface, m.
pub(super) const CHORD_ERROR_M: f64 = 2e-4;

/// Shapes at their poses.
pub(super) struct PlacedShapes<'s> {
    shapes: Vec<(&'s Shape, Pose)>,
    /// Corners of the triangles of all surfaces.
    pub triangles: Vec<[Vec3; 3]>,
    /// No point of a surface is farther from the triangles, m; larger than 0 where a shape is curved.
    pub chord_error_m: f64,
}

impl<'s> PlacedShapes<'s> {
    pub fn new(shapes: Vec<(&'s Shape, Pose)>) -> Self {
        let mut triangles = Vec::new();
        let mut chord_error_m = 0.0;
        for (shape, pose) in &shapes {
            if matches!(shape, Shape::Capsule(_) | Shape::Cylinder(_)) {
                chord_error_m = CHORD_ERROR_M;
            }
            let (vertices, indices) = tessellate(shape, CHORD_ERROR_M);
            let at = |i: u32| pose.transform_point(vertices[i as usize]);
            triangles.extend(indices.iter().map(|&[a, b, c]| [at(a), at(b), at(c)]));
        }
        Self { shapes, triangles, chord_error_m }
    }

    /// Radius of the largest ball about a point that lies in one closed shape, m; 0 outside.
    pub fn depth_m(&self, p: Vec3) -> f64 {
        self.shapes.iter().map(|(shape, pose)| -project_point(shape, pose, p).signed_distance).fold(0.0, f64::max)
    }
}
