//! Sphere-swept hull of a few points: bounds the speed of all points of a solid.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

/// Convex hulls with more vertices than this are replaced by their bounding box.
const MAX_VERTICES: usize = 64;

/// Extent of unbounded shapes, m: larger than any cell.
const UNBOUNDED_M: f64 = 1e6;

/// The convex hull of balls of one radius around `points`, which contains a solid.
///
/// The speed of a rigid motion is a convex function of the position. So the largest speed at the points, plus the
/// angular speed times the radius, bounds the speed of the solid.
#[derive(Debug, Clone)]
pub(super) struct SphereSweptHull {
    points: Vec<Vec3>,
    radius: f64,
}

impl SphereSweptHull {
    /// A hull of a shape at `pose`; the points are in the parent frame of `pose`.
    pub fn new(shape: &Shape, pose: &Pose) -> Self {
        let (points, radius) = match shape {
            Shape::Sphere(s) => (vec![Vec3::ZERO], s.radius),
            Shape::Capsule(c) => (vec![Vec3::Z * c.half_length, -Vec3::Z * c.half_length], c.radius),
            Shape::HalfSpace(_) => (vec![Vec3::ZERO], f64::INFINITY),
            Shape::Hull(hull) if hull.vertices().len() <= MAX_VERTICES => (hull.vertices().to_vec(), 0.0),
            _ => (corners(shape), 0.0),
        };
        Self { points: points.into_iter().map(|p| pose.transform_point(p)).collect(), radius }
    }

    /// Upper bound of the distance of any point of the solid from the origin, m.
    pub fn farthest_m(&self) -> f64 {
        self.points.iter().map(|p| p.length()).fold(0.0, f64::max) + self.radius.min(UNBOUNDED_M)
    }

    /// Upper bound of the speed of any point of the solid, m/s.
    ///
    /// `motion` is the motion of the points' frame, expressed in the parent of `frame`.
    pub fn fastest(&self, frame: &Pose, motion: &FrameMotion) -> f64 {
        let of = |p: &Vec3| motion.velocity_at(frame.transform_vector(*p)).length();
        let angular_speed = motion.angular_velocity.length();
        // A half-space in pure translation has one velocity everywhere.
        let radius_speed = if angular_speed > 0.0 { angular_speed * self.radius } else { 0.0 };
        self.points.iter().map(of).fold(0.0, f64::max) + radius_speed
    }
}

fn corners(shape: &Shape) -> Vec<Vec3> {
    let bounds = shape.aabb(&Pose::IDENTITY);
    let component = |i: usize, axis: usize, low: f64, high: f64| if i >> axis & 1 == 0 { low } else { high };
    (0..8)
        .map(|i| {
            let (low, high) = (bounds.min, bounds.max);
            Vec3::new(component(i, 0, low.x, high.x), component(i, 1, low.y, high.y), component(i, 2, low.z, high.z))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use elbowroom_proximity::{Capsule, Cuboid, Sphere};
    use elbowroom_spatial::Rotation;
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(Vec3::from)
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (vector(), vector()).prop_map(|(turn, at)| Pose::new(Rotation::from_rotation_vector(turn), at))
    }

    proptest! {
        #[test]
        fn no_point_of_the_solid_is_faster(
            which in 0..3, pose in pose(), frame in pose(), velocity in vector(), angular_velocity in vector(),
            directions in proptest::collection::vec(vector(), 40),
        ) {
            let shape = match which {
                0 => Shape::Sphere(Sphere { radius: 0.3 }),
                1 => Shape::Capsule(Capsule { half_length: 0.4, radius: 0.1 }),
                _ => Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.3, 0.5) }),
            };
            let motion = FrameMotion { velocity, angular_velocity, ..FrameMotion::REST };
            let bound = SphereSweptHull::new(&shape, &pose).fastest(&frame, &motion);
            for direction in directions {
                let surface = pose.transform_point(shape.support(direction));
                let speed = motion.velocity_at(frame.transform_vector(surface)).length();
                prop_assert!(speed <= bound + 1e-12, "{shape:?}: {speed} above {bound}");
            }
        }
    }

    #[test]
    fn a_translating_ball_has_its_own_speed() {
        let ball = SphereSweptHull::new(&Shape::Sphere(Sphere { radius: 0.3 }), &Pose::IDENTITY);
        let motion = FrameMotion { velocity: Vec3::X * 2.0, ..FrameMotion::REST };
        assert_eq!(ball.fastest(&Pose::IDENTITY, &motion), 2.0);
    }
}
