//! Bounding boxes and capsules of many points: fitted to the outermost points, then enlarged to contain all.

use elbowroom_proximity::{Capsule, Cuboid, Shape, fit};
use elbowroom_spatial::{Pose, Vec3};

/// Number of directions in which outermost points are selected.
const DIRECTIONS: usize = 256;
/// Allowance for the rounding of a pose that is later composed with others, as a fraction of the coordinates.
const GROWTH: f64 = 8.0 * f64::EPSILON;

/// A tight oriented box around the points. `None` if there are no points.
pub(crate) fn cuboid(points: &[Vec3]) -> Option<(Shape, Pose)> {
    let fit = fit::cuboid(&outermost(points))?;
    let Shape::Cuboid(c) = fit.shape else { return None };
    let pose = fit.in_frame;
    let reach = points.iter().fold(c.half_extents, |h, &p| h.max(pose.inverse_transform_point(p).abs()));
    let half_extents = reach + Vec3::splat(GROWTH * size(points));
    Some((Shape::Cuboid(Cuboid { half_extents }), pose))
}

/// A tight capsule around the points. `None` if there are no points.
pub(crate) fn capsule(points: &[Vec3]) -> Option<(Shape, Pose)> {
    let fit = fit::capsule(&outermost(points))?;
    let Shape::Capsule(c) = fit.shape else { return None };
    let pose = fit.in_frame;
    let reach = points.iter().fold(c.radius, |r: f64, &p| {
        let q = pose.inverse_transform_point(p);
        r.max(q.distance(c.axis_point(q)))
    });
    let radius = reach + GROWTH * size(points);
    Some((Shape::Capsule(Capsule { radius, ..c }), pose))
}

/// All points if they are few, else the outermost points in directions spread evenly over the sphere.
fn outermost(points: &[Vec3]) -> Vec<Vec3> {
    if points.len() <= 2 * DIRECTIONS {
        return points.to_vec();
    }
    // A Fibonacci spiral.
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let direction = |i: usize| {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / DIRECTIONS as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z)
    };
    let axes = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
    let outer = |d: Vec3| {
        let farther = |(most, outer): (f64, Vec3), &p: &Vec3| {
            let reach = p.dot(d);
            if reach >= most { (reach, p) } else { (most, outer) }
        };
        points.iter().fold((f64::NEG_INFINITY, Vec3::ZERO), farther).1
    };
    (0..DIRECTIONS).map(direction).chain(axes).map(outer).collect()
}

fn size(points: &[Vec3]) -> f64 {
    points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_testkit::random::Random;

    #[test]
    fn all_points_are_contained_in_little_more_than_their_own_volume() {
        let mut random = Random(5);
        let turn = Pose::from_xyz_rpy([3.0, -1.0, 0.2], [0.3, 0.7, -1.1]);
        let mut point = || turn.transform_point(Vec3::new(random.unit(), 0.3 * random.unit(), 0.2 * random.unit()));
        let points: Vec<Vec3> = (0..20_000).map(|_| point()).collect();
        for found in [cuboid(&points), capsule(&points)] {
            let (shape, pose) = found.unwrap();
            let contains = |p: Vec3| {
                let q = pose.inverse_transform_point(p);
                match &shape {
                    Shape::Cuboid(c) => c.nearest(q) == q,
                    Shape::Capsule(c) => q.distance(c.axis_point(q)) <= c.radius,
                    _ => false,
                }
            };
            assert!(points.iter().all(|p| contains(*p)));
            assert!(shape.volume() < 0.06 * 2.2, "{shape:?}");
            assert!(!matches!(shape, Shape::Cuboid(_)) || shape.volume() < 0.06 * 1.1, "{shape:?}");
        }
        assert!(cuboid(&[]).is_none() && capsule(&[]).is_none());
    }
}
