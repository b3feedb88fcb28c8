//! Bounding boxes and capsules of many points: fitted to the outermost points, then enlarged to contain all.

use elbowroom_proximity::fit::ExtremePoints;
use elbowroom_proximity::{Capsule, Cuboid, Shape};
use elbowroom_spatial::Vec3;

use crate::local_shape::LocalShape;

/// Number of directions in which outermost points are selected.
const DIRECTIONS: usize = 256;
/// Allowance for the rounding of a pose that is later composed with others, as a fraction of the coordinates.
const GROWTH: f64 = 8.0 * f64::EPSILON;

/// Points, and the outermost of them, to which both shapes are fitted.
pub(crate) struct Enclosed {
    points: Vec<Vec3>,
    /// `None` if there are no points.
    outermost: Option<ExtremePoints>,
}

impl Enclosed {
    /// Selects the outermost of the points.
    pub fn new(points: Vec<Vec3>) -> Self {
        Self { outermost: ExtremePoints::of(&outermost(&points)), points }
    }

    /// A tight oriented box around the points. `None` if there are no points.
    pub fn cuboid(&self) -> Option<LocalShape> {
        let fit = self.outermost.as_ref()?.cuboid()?;
        let Shape::Cuboid(c) = fit.shape else { return None };
        let pose = fit.in_frame;
        let reach = self.points.iter().fold(c.half_extents, |h, &p| h.max(pose.inverse_transform_point(p).abs()));
        let half_extents = reach + Vec3::splat(GROWTH * size(&self.points));
        Some(LocalShape::new(Shape::Cuboid(Cuboid { half_extents }), pose))
    }

    /// A tight capsule around the points. `None` if there are no points.
    pub fn capsule(&self) -> Option<LocalShape> {
        let fit = self.outermost.as_ref()?.capsule()?;
        let Shape::Capsule(c) = fit.shape else { return None };
        let pose = fit.in_frame;
        let reach = self.points.iter().fold(c.radius, |r: f64, &p| {
            let q = pose.inverse_transform_point(p);
            r.max(q.distance(c.axis_point(q)))
        });
        let radius = reach + GROWTH * size(&self.points);
        Some(LocalShape::new(Shape::Capsule(Capsule { radius, ..c }), pose))
    }
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
    (0..DIRECTIONS).map(direction).chain(axes).map(|d| farthest_along(points, d)).collect()
}

/// The last of the points that are farthest along a direction. Blocks of points have independent maxima, which processors
/// compute at the same time.
fn farthest_along(points: &[Vec3], direction: Vec3) -> Vec3 {
    const BLOCK: usize = 64;
    let reach = |p: &Vec3| p.dot(direction);
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    let farthest = |block: &[Vec3]| {
        let quarters = block.as_chunks::<4>();
        let lanes =
            quarters.0.iter().fold([f64::NEG_INFINITY; 4], |m, p| std::array::from_fn(|i| larger(m[i], reach(&p[i]))));
        quarters.1.iter().map(reach).chain(lanes).fold(f64::NEG_INFINITY, larger)
    };
    let mut found = (f64::NEG_INFINITY, &points[..0]);
    for block in points.chunks(BLOCK) {
        let most = farthest(block);
        if most >= found.0 {
            found = (most, block);
        }
    }
    found.1.iter().rfind(|p| reach(p) >= found.0).copied().unwrap_or(Vec3::ZERO)
}

fn size(points: &[Vec3]) -> f64 {
    points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Pose;
    use elbowroom_testkit::random::Random;

    #[test]
    fn all_points_are_contained_in_little_more_than_their_own_volume() {
        let mut random = Random(5);
        let turn = Pose::from_xyz_rpy([3.0, -1.0, 0.2], [0.3, 0.7, -1.1]);
        let mut point = || turn.transform_point(Vec3::new(random.unit(), 0.3 * random.unit(), 0.2 * random.unit()));
        let points: Vec<Vec3> = (0..20_000).map(|_| point()).collect();
        let enclosed = Enclosed::new(points.clone());
        for found in [enclosed.cuboid(), enclosed.capsule()] {
            let LocalShape { shape, in_geometry: pose, .. } = found.unwrap();
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
        let nothing = Enclosed::new(Vec::new());
        assert!(nothing.cuboid().is_none() && nothing.capsule().is_none());
    }

    #[test]
    fn the_last_of_the_farthest_points_is_found() {
        let mut random = Random(8);
        for count in (0..150).chain([1000]) {
            // Coordinates on a coarse grid, so that many points are equally far.
            let points: Vec<Vec3> =
                (0..count).map(|_| Vec3::from([(); 3].map(|()| (2.0 * random.unit()).round()))).collect();
            for direction in [Vec3::X, -Vec3::Z, Vec3::new(0.6, -0.8, 0.0), Vec3::new(0.1, 0.2, 0.3)] {
                let farther = |(most, found): (f64, Vec3), p: &Vec3| {
                    let reach = p.dot(direction);
                    if reach >= most { (reach, *p) } else { (most, found) }
                };
                let expected = points.iter().fold((f64::NEG_INFINITY, Vec3::ZERO), farther).1;
                assert_eq!(farthest_along(&points, direction), expected, "{count} {direction:?}");
            }
        }
    }
}
