//! Bounding box of any orientation. A smallest box is flush with edges of the hull (O'Rourke, 1985); most are flush
//! with a face.

use elbowroom_spatial::{Aabb, Pose, Rotation, Vec3};

use super::margin::{MARGIN, scale};
use super::principal_axes;
use crate::{ConvexHull, Cuboid};

/// Number of hull faces tried, largest first.
const FACES: usize = 100;

/// Fits a box; one of the searches starts at the principal axes.
pub(super) fn fit(points: &[Vec3], principal: Rotation, hull: Option<&ConvexHull>) -> Option<(Cuboid, Pose)> {
    let volume = |r: Rotation| {
        let extent = bounds(points, r).extent();
        extent.x * extent.y * extent.z
    };
    // The volume of a flat set can be 0 in many orientations: then the area decides, then the length.
    let flat = hull.is_none();
    let cost = |r: Rotation| {
        let e = bounds(points, r).extent();
        if flat { e.x * e.y + e.y * e.z + e.z * e.x + 1e-3 * e.length_squared() } else { volume(r) }
    };
    let mut starts = vec![Rotation::IDENTITY, principal];
    starts.extend(hull.map(flush).unwrap_or_default());
    // Each cost is a pass over all points, so it is computed once per start, not once per comparison.
    let mut starts: Vec<(f64, Rotation)> = starts.into_iter().map(|s| (cost(s), s)).collect();
    starts.sort_by(|x, y| x.0.total_cmp(&y.0));
    let tried = starts.into_iter().take(3).map(|(_, s)| principal_axes::descend(s, &[Vec3::X, Vec3::Y, Vec3::Z], cost));
    let (_, rotation) = tried.min_by(|x, y| x.0.total_cmp(&y.0))?;
    Some(verified(points, rotation))
}

/// Frames with z on a face's normal and x along one of its edges.
fn flush(hull: &ConvexHull) -> Vec<Rotation> {
    let mut faces: Vec<([Vec3; 3], f64)> = (0..hull.triangles().len())
        .map(|i| hull.corners(i))
        .map(|[a, b, c]| ([a, b, c], (b - a).cross(c - a).length()))
        .collect();
    faces.sort_by(|x, y| y.1.total_cmp(&x.1));
    faces.truncate(FACES);
    let edges = faces.iter().flat_map(|([a, b, c], _)| [(*b - *a, *c - *a), (*c - *b, *a - *b), (*a - *c, *b - *c)]);
    edges.filter_map(|(x, xy)| Rotation::from_x_and_xy(x, xy)).collect()
}

fn bounds(points: &[Vec3], rotation: Rotation) -> Aabb {
    Aabb::from_points(points.iter().map(|&p| rotation.inverse_rotate(p)))
}

fn verified(points: &[Vec3], rotation: Rotation) -> (Cuboid, Pose) {
    let pose = Pose::new(rotation, rotation * bounds(points, rotation).center());
    let reach = points.iter().fold(Vec3::ZERO, |h, &p| h.max(pose.inverse_transform_point(p).abs()));
    (Cuboid { half_extents: reach + Vec3::splat(MARGIN * scale(points)) }, pose)
}
