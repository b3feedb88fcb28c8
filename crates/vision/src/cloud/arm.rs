//! The arm among points: which are its own, and what it hides.

use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Shape, within};
use elbowroom_spatial::{Aabb, Pose, Rotation, Vec3};

use crate::ArmPart;

/// An arm part ready for questions.
#[derive(Debug, Clone)]
struct Solid {
    shape: Shape,
    in_world: Pose,
    /// Grown by the margin.
    bounds: Aabb,
}

/// The parts of an arm in one cloud.
#[derive(Debug, Clone, Default)]
pub(super) struct Arm {
    solids: Vec<Solid>,
}

impl Arm {
    pub(super) fn place(&mut self, parts: &[ArmPart], margin_m: f64) {
        self.solids.clear();
        self.solids.extend(parts.iter().map(|part| {
            let (shape, in_world) = solid(part);
            let bounds = shape.aabb(&in_world).inflated(margin_m);
            Solid { shape, in_world, bounds }
        }));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// Whether a point is within `margin_m` of the arm.
    pub(super) fn has(&self, p: Vec3, margin_m: f64) -> bool {
        self.solids.iter().any(|solid| solid.bounds.contains(p) && solid.is_near(p, margin_m))
    }

    /// Whether the arm is in the way between two points.
    pub(super) fn hides(&self, from: Vec3, to: Vec3, margin_m: f64) -> bool {
        let (ray, ray_in_world) = segment(from, to, 0.0);
        self.solids.iter().any(|solid| within(&solid.shape, &solid.in_world, &ray, &ray_in_world, margin_m))
    }
}

impl Solid {
    fn is_near(&self, p: Vec3, margin_m: f64) -> bool {
        let p = self.in_world.inverse_transform_point(p);
        match &self.shape {
            Shape::Capsule(capsule) => p.distance(capsule.axis_point(p)) <= capsule.radius + margin_m,
            Shape::Hull(hull) => p.distance(hull.nearest(p)) <= margin_m,
            // The box of points that have no hull.
            other => other.aabb(&Pose::IDENTITY).inflated(margin_m).contains(p),
        }
    }
}

fn solid(part: &ArmPart) -> (Shape, Pose) {
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

fn segment(from: Vec3, to: Vec3, radius: f64) -> (Shape, Pose) {
    let along = to - from;
    let rotation = along.try_normalize().map_or(Rotation::IDENTITY, Rotation::from_z);
    let capsule = Capsule { half_length: along.length() / 2.0, radius };
    (Shape::Capsule(capsule), Pose::new(rotation, from.lerp(to, 0.5)))
}
