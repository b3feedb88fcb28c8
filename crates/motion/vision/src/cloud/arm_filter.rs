//! Self-filter of point clouds: points on the arm, and lines of sight that the arm blocks.

use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Shape, within};
use elbowroom_spatial::{Aabb, Pose, Rotation, Vec3};

use crate::ArmPart;

/// An arm part as a shape for queries.
#[derive(Debug, Clone)]
struct ArmShape {
    shape: Shape,
    in_world: Pose,
    /// Bounding box, inflated by the margin.
    bounds: Aabb,
}

/// The parts of the arm in one cloud.
#[derive(Debug, Clone, Default)]
pub(super) struct ArmFilter {
    shapes: Vec<ArmShape>,
}

impl ArmFilter {
    pub(super) fn place(&mut self, parts: &[ArmPart], margin_m: f64) {
        self.shapes.clear();
        self.shapes.extend(parts.iter().map(|part| {
            let (shape, in_world) = shape_of(part);
            let bounds = shape.aabb(&in_world).inflated(margin_m);
            ArmShape { shape, in_world, bounds }
        }));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Whether a point is within `margin_m` of the arm.
    pub(super) fn contains(&self, p: Vec3, margin_m: f64) -> bool {
        self.shapes.iter().any(|shape| shape.bounds.contains(p) && shape.is_within(p, margin_m))
    }

    /// Whether the arm intersects the line of sight between two points.
    pub(super) fn occludes(&self, from: Vec3, to: Vec3, margin_m: f64) -> bool {
        let (ray, ray_in_world) = segment(from, to, 0.0);
        self.shapes.iter().any(|arm| within(&arm.shape, &arm.in_world, &ray, &ray_in_world, margin_m))
    }
}

impl ArmShape {
    fn is_within(&self, p: Vec3, margin_m: f64) -> bool {
        let p = self.in_world.inverse_transform_point(p);
        match &self.shape {
            Shape::Capsule(capsule) => p.distance(capsule.axis_point(p)) <= capsule.radius + margin_m,
            Shape::Hull(hull) => p.distance(hull.nearest(p)) <= margin_m,
            // The bounding box of points that do not have a hull.
            other => other.aabb(&Pose::IDENTITY).inflated(margin_m).contains(p),
        }
    }
}

fn shape_of(part: &ArmPart) -> (Shape, Pose) {
    match part {
        ArmPart::Capsule { from, to, radius_m } => segment(*from, *to, *radius_m),
        ArmPart::Hull(points) => {
            if let Ok(hull) = ConvexHull::from_points(points) {
                return (Shape::Hull(hull.into()), Pose::IDENTITY);
            }
            let bounds = Aabb::from_points(points.iter().copied());
            let half_extents = bounds.extent() * 0.5;
            (Shape::Cuboid(Cuboid { half_extents }), Pose::from_translation(bounds.center()))
        }
    }
}

/// A capsule around the segment between two points.
fn segment(from: Vec3, to: Vec3, radius: f64) -> (Shape, Pose) {
    let along = to - from;
    let rotation = along.try_normalize().map_or(Rotation::IDENTITY, Rotation::from_z);
    let capsule = Capsule { half_length: along.length() / 2.0, radius };
    (Shape::Capsule(capsule), Pose::new(rotation, from.lerp(to, 0.5)))
}
