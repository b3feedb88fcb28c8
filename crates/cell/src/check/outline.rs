//! Few points and a radius that bound how fast any point of a solid moves with its link.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Motion, Pose, Vec3};

/// Convex hulls with more corners than this are enclosed by their box.
const MOST_CORNERS: usize = 64;

/// As far (m) as anything in a cell is from anything else: where a half-space is asked how far it reaches.
const ENDLESS_M: f64 = 1e6;

/// A solid between balls of one radius around `points`: the speed of a rigid motion is a convex function of the place, so
/// that it is largest at one of the points, but for the radius.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    points: Vec<Vec3>,
    radius: f64,
}

impl Outline {
    /// Of a shape that stands at `pose`; the points are in the frame of `pose`.
    pub fn new(shape: &Shape, pose: &Pose) -> Self {
        let (points, radius) = match shape {
            Shape::Sphere(s) => (vec![Vec3::ZERO], s.radius),
            Shape::Capsule(c) => (vec![Vec3::Z * c.half_length, -Vec3::Z * c.half_length], c.radius),
            Shape::HalfSpace(_) => (vec![Vec3::ZERO], f64::INFINITY),
            Shape::Hull(hull) if hull.vertices().len() <= MOST_CORNERS => (hull.vertices().to_vec(), 0.0),
            _ => (corners(shape), 0.0),
        };
        Self { points: points.into_iter().map(|p| pose.transform_point(p)).collect(), radius }
    }

    /// No point of the solid is farther from the origin of the points' frame, m.
    pub fn farthest_m(&self) -> f64 {
        self.points.iter().map(|p| p.length()).fold(0.0, f64::max) + self.radius.min(ENDLESS_M)
    }

    /// No point of the solid moves faster, m/s; `motion` is that of the frame of the points, seen from `frame`'s parent.
    pub fn fastest(&self, frame: &Pose, motion: &Motion) -> f64 {
        let of = |p: &Vec3| motion.velocity_at(frame.transform_vector(*p)).length();
        let turning = motion.angular_velocity.length();
        // A half-space that does not turn has one velocity everywhere.
        let rim = if turning > 0.0 { turning * self.radius } else { 0.0 };
        self.points.iter().map(of).fold(0.0, f64::max) + rim
    }
}

fn corners(shape: &Shape) -> Vec<Vec3> {
    let boxed = shape.aabb(&Pose::IDENTITY);
    let pick = |i: usize, axis: usize, low: f64, high: f64| if i >> axis & 1 == 0 { low } else { high };
    (0..8)
        .map(|i| {
            let (low, high) = (boxed.min, boxed.max);
            Vec3::new(pick(i, 0, low.x, high.x), pick(i, 1, low.y, high.y), pick(i, 2, low.z, high.z))
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
            let motion = Motion { velocity, angular_velocity, ..Motion::REST };
            let bound = Outline::new(&shape, &pose).fastest(&frame, &motion);
            for direction in directions {
                let surface = pose.transform_point(shape.support(direction));
                let speed = motion.velocity_at(frame.transform_vector(surface)).length();
                prop_assert!(speed <= bound + 1e-12, "{shape:?}: {speed} above {bound}");
            }
        }
    }

    #[test]
    fn a_ball_that_only_slides_has_its_own_speed() {
        let ball = Outline::new(&Shape::Sphere(Sphere { radius: 0.3 }), &Pose::IDENTITY);
        let motion = Motion { velocity: Vec3::X * 2.0, ..Motion::REST };
        assert_eq!(ball.fastest(&Pose::IDENTITY, &motion), 2.0);
    }
}
