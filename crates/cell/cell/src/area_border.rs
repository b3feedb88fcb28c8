//! The border of a drawn area.

use elbowroom_proximity::project_point;
use elbowroom_scene::Object;
use elbowroom_spatial::Vec3;
use elbowroom_vision::{Point2, polygon};

/// What to write instead of a border whose edges cross.
pub(crate) const AROUND: &str = "the points in their order around the area";

/// The first two edges of a closed line that cross, each by the number of its first point, from 1; `None` if none do.
///
/// The points are in the world, on the surface of the object. The edges are seen along the mean normal of the surface.
pub(crate) fn crossing_edges(object: &Object, points: &[Vec3]) -> Option<(usize, usize)> {
    let outward = |p: &Vec3| project_point(&object.shape, &object.in_world, *p).outward;
    let normal = points.iter().fold(Vec3::ZERO, |sum, p| sum + outward(p)).try_normalize()?;
    let (u, v) = (normal.any_perpendicular(), normal.cross(normal.any_perpendicular()));
    let flat: Vec<Point2> = points.iter().map(|p| Point2::new(u.dot(*p), v.dot(*p))).collect();
    polygon::first_crossing(&flat).map(|(i, j)| (i + 1, j + 1))
}

/// What is wrong with a border whose edges cross.
pub(crate) fn crossing_text((first, second): (usize, usize)) -> String {
    format!("the border of the area crosses itself: after its points {first} and {second}")
}
