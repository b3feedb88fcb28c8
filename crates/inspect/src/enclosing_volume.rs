//! Resolution level L2: the enclosing volume of each solid for whole-arm guarding.

use elbowroom_monitor::VolumeModel;
use elbowroom_proximity::{ConvexHull, Shape};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use serde::Serialize;

/// The enclosing volume of one solid.
#[derive(Debug, Clone, Serialize)]
pub struct EnclosingVolume {
    /// The solid's link.
    pub link: String,
    /// `capsule`, `cuboid`, or the solid's own kind where it is already a primitive.
    pub volume: &'static str,
    /// Its volume divided by that of the solid's convex hull; null where the hull has none.
    pub ratio_to_hull: Option<f64>,
}

pub(super) fn of_robot(robot: &Robot) -> Vec<EnclosingVolume> {
    let links = robot.chain.links().iter().zip(&robot.colliders);
    links.flat_map(|(link, colliders)| colliders.iter().map(|b| of_solid(link, &b.shape))).collect()
}

pub(super) fn of_solid(link: &str, solid: &Shape) -> EnclosingVolume {
    let (volume, _) = VolumeModel::Tightest.of(solid, Pose::IDENTITY);
    let hull = match solid {
        Shape::Mesh(mesh) => ConvexHull::from_points(mesh.vertices()).ok().map(|h| h.volume()),
        primitive => Some(primitive.volume()),
    };
    let ratio_to_hull = hull.filter(|v| *v > 0.0).map(|hull| volume.volume() / hull);
    EnclosingVolume { link: link.to_owned(), volume: volume.kind(), ratio_to_hull }
}
