//! Shapes at their poses in one frame: their triangles, and the depth of a point in a shape.

use elbowroom_proximity::{Shape, project_point, tessellate::tessellate};
use elbowroom_spatial::{Pose, Vec3};

/// Requested deviation of triangles from a curved surface, m.
const CHORD_ERROR_M: f64 = 2e-4;

/// Shapes at their poses.
pub(super) struct PlacedShapes<'s> {
    shapes: Vec<(&'s Shape, Pose)>,
    /// Corners of the triangles of all surfaces.
    pub triangles: Vec<[Vec3; 3]>,
    /// Upper bound on the distance of a point of a surface from the triangles, m; above 0 if a shape is curved.
    pub chord_error_m: f64,
}

impl<'s> PlacedShapes<'s> {
    pub fn new(shapes: Vec<(&'s Shape, Pose)>) -> Self {
        let mut triangles = Vec::new();
        let mut chord_error_m = 0.0;
        for (shape, pose) in &shapes {
            chord_error_m = deviation_m(shape).max(chord_error_m);
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

/// Upper bound on the distance of a point of a surface from its triangles, m.
///
/// May be more than the requested deviation, because circles have a whole number of segments, and at most 256.
fn deviation_m(shape: &Shape) -> f64 {
    let half_angle = |radius: f64, error_m: f64| {
        let wanted = std::f64::consts::PI / (1.0 - error_m / radius).clamp(-1.0, 1.0).acos();
        std::f64::consts::PI / wanted.clamp(8.0, 256.0).floor()
    };
    match shape {
        Shape::Cylinder(c) => c.radius * (1.0 - half_angle(c.radius, CHORD_ERROR_M).cos()),
        // Curved in both directions: each direction has half of the deviation.
        Shape::Capsule(c) => c.radius * half_angle(c.radius, 0.5 * CHORD_ERROR_M).sin().powi(2),
        Shape::Sphere(s) => s.radius * half_angle(s.radius, 0.5 * CHORD_ERROR_M).sin().powi(2),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use elbowroom_proximity::{Capsule, Cylinder, Sphere, TriMesh};

    use super::*;

    #[test]
    fn no_point_of_a_curved_surface_is_farther_from_the_triangles() {
        for i in (0..120).step_by(elbowroom_testkit::extent::amount(7, 1)) {
            let radius = 0.001 * 1.09_f64.powi(i);
            let half_length = 0.3 * radius;
            for shape in [
                Shape::Cylinder(Cylinder { half_length, radius }),
                Shape::Capsule(Capsule { half_length, radius }),
                Shape::Sphere(Sphere { radius }),
            ] {
                let (vertices, triangles) = tessellate(&shape, CHORD_ERROR_M);
                let mesh = Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()));
                let is_cylinder = matches!(shape, Shape::Cylinder(_));
                let length = if matches!(shape, Shape::Sphere(_)) { 0.0 } else { half_length };
                let mut farthest: f64 = 0.0;
                for n in 0..400 {
                    // A small part of the circle in fine steps, at different heights.
                    let (turn, tilt) = (f64::from(n) * 0.002, if is_cylinder { 0.0 } else { f64::from(n % 20) * 0.07 });
                    let across = Vec3::new(turn.cos(), turn.sin(), 0.0) * (radius * tilt.cos());
                    let p = across + Vec3::Z * (radius * tilt.sin() + if is_cylinder { 0.0 } else { length });
                    farthest = farthest.max(project_point(&mesh, &Pose::IDENTITY, p).signed_distance);
                }
                let bound = deviation_m(&shape);
                assert!(farthest <= bound * (1.0 + 1e-6) + 1e-12, "{shape:?}: {farthest} > {bound}");
                assert!(bound <= 2.0 * CHORD_ERROR_M || radius > 1.0, "{shape:?}: {bound}");
            }
        }
    }
}
