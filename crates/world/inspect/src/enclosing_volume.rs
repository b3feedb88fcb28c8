//! Resolution level L2: the enclosing volume of each solid for whole-arm guarding.

use elbowroom_proximity::{ConvexHull, Shape, ShapeKind, VolumeModel};
use elbowroom_robot::Robot;
use elbowroom_spatial::Pose;
use serde::{Serialize, Serializer};

/// The enclosing volume of one solid.
#[derive(Debug, Clone, Serialize)]
pub struct EnclosingVolume {
    /// Name of the solid's link.
    pub link: String,
    /// Kind of the volume: a capsule, a box, or the solid's own kind if the solid is a primitive.
    #[serde(serialize_with = "serialize_kind")]
    pub volume: ShapeKind,
    /// Volume divided by the volume of the solid's convex hull; null if the hull has no volume.
    pub ratio_to_hull: Option<f64>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn serialize_kind<S: Serializer>(kind: &ShapeKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
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
