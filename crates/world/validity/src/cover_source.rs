//! Sources of covers: built, or kept from an earlier run.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};
use rayon::prelude::*;

use crate::cover::SphereCover;

/// Version of the construction of covers, including the triangles of curved shapes.
///
/// Increase it with each change of either, so that no cover of an earlier version is read from a cache.
const CONSTRUCTION: u64 = 3;

/// Source of the covers of shapes: built, or kept from an earlier run. Must return what [`SphereCover::new`] would.
pub trait CoverSource: Sync {
    /// Returns the cover that [`SphereCover::new`] would return.
    fn cover(&self, shapes: &[(&Shape, Pose)], slack_m: f64) -> Option<SphereCover>;
}

/// Builds the covers of several bodies in parallel, and returns them in the order of the bodies.
///
/// A body consists of its shapes and its slack in metres. A cover is `None` if [`SphereCover::new`] would return `None`.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_spatial::Pose;
/// use elbowroom_validity::{BuiltCovers, covers};
/// let balls = [0.1, 0.2].map(|radius| Shape::Sphere(Sphere { radius }));
/// let bodies = balls.each_ref().map(|ball| (vec![(ball, Pose::IDENTITY)], 0.001));
/// let radii: Vec<f64> = covers(&bodies, &BuiltCovers).iter().map(|c| c.as_ref().unwrap().outer[0].radius).collect();
/// assert!(radii[0] >= 0.1 && radii[1] >= 0.2);
/// ```
pub fn covers(bodies: &[(Vec<(&Shape, Pose)>, f64)], source: &dyn CoverSource) -> Vec<Option<SphereCover>> {
    bodies.par_iter().with_max_len(1).map(|(shapes, slack_m)| source.cover(shapes, *slack_m)).collect()
}

/// Source that builds every cover.
#[derive(Debug, Clone, Copy, Default)]
pub struct BuiltCovers;

impl CoverSource for BuiltCovers {
    fn cover(&self, shapes: &[(&Shape, Pose)], slack_m: f64) -> Option<SphereCover> {
        SphereCover::new(shapes, slack_m)
    }
}

/// Passes all numbers on which a cover depends, for a hash: the construction, the slack, and the shapes with their poses.
///
/// ```
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_spatial::Pose;
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let numbers = |slack_m: f64| {
///     let mut bytes = Vec::new();
///     elbowroom_validity::describe_cover(&[(&ball, Pose::IDENTITY)], slack_m, &mut |number| bytes.extend(number));
///     bytes
/// };
/// assert_eq!(numbers(0.005), numbers(0.005));
/// assert_ne!(numbers(0.005), numbers(0.002));
/// ```
pub fn describe_cover(shapes: &[(&Shape, Pose)], slack_m: f64, pass: &mut dyn FnMut([u8; 8])) {
    let mut count = |n: u64| pass(n.to_le_bytes());
    count(CONSTRUCTION);
    count(slack_m.to_bits());
    count(shapes.len() as u64);
    for (shape, pose) in shapes {
        pose.to_rows().iter().flatten().for_each(|v| count(v.to_bits()));
        describe_shape(shape, &mut count);
    }
}

/// Passes a number for the kind of shape, then the numbers of the shape.
fn describe_shape(shape: &Shape, count: &mut dyn FnMut(u64)) {
    let mut numbers = |kind: u64, lengths: &[f64]| {
        count(kind);
        for v in lengths {
            count(v.to_bits());
        }
    };
    match shape {
        Shape::Sphere(s) => numbers(0, &[s.radius]),
        Shape::Capsule(c) => numbers(1, &[c.half_length, c.radius]),
        Shape::Cylinder(c) => numbers(2, &[c.half_length, c.radius]),
        Shape::Cuboid(c) => numbers(3, &[c.half_extents.x, c.half_extents.y, c.half_extents.z]),
        Shape::HalfSpace(_) => numbers(4, &[]),
        Shape::Hull(h) => describe_triangles(5, h.vertices(), h.triangles(), count),
        Shape::Mesh(m) => describe_triangles(6, m.vertices(), m.triangles(), count),
    }
}

fn describe_triangles(kind: u64, vertices: &[Vec3], triangles: &[[u32; 3]], count: &mut dyn FnMut(u64)) {
    [kind, vertices.len() as u64, triangles.len() as u64].into_iter().for_each(&mut *count);
    vertices.iter().flat_map(|v| [v.x, v.y, v.z]).for_each(|v| count(v.to_bits()));
    triangles.iter().flatten().for_each(|&i| count(i.into()));
}
