//! Poses and fixed frames.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::field::Field;
use super::types::FixedFrame;
use crate::Diagnostic;

/// Least length of a quaternion. A shorter one has no intended direction.
const MIN_QUATERNION: f64 = 1e-3;
/// Largest coordinate, metres.
const MAX_COORDINATE_M: f64 = 1e9;

/// A pose with `position` and `orientation` (x, y, z, w); a missing part is zero.
pub(crate) fn pose(field: &Field<'_>) -> Result<Pose, Diagnostic> {
    parts(field, ["position", "orientation"])
}

/// A pose with the field names of a transform.
pub(crate) fn transform(field: &Field<'_>) -> Result<Pose, Diagnostic> {
    parts(field, ["translation", "rotation"])
}

fn parts(field: &Field<'_>, [translation, rotation]: [&str; 2]) -> Result<Pose, Diagnostic> {
    let translation = field.get(translation)?.map_or(Ok(Vec3::ZERO), |f| point(&f))?;
    Ok(Pose::new(rotation_of(field, rotation)?, translation))
}

/// The `orientation` (x, y, z, w) of a message; none if it is missing.
pub(crate) fn orientation(field: &Field<'_>) -> Result<Rotation, Diagnostic> {
    rotation_of(field, "orientation")
}

fn rotation_of(field: &Field<'_>, key: &str) -> Result<Rotation, Diagnostic> {
    field.get(key)?.map_or(Ok(Rotation::IDENTITY), |f| quaternion(&f))
}

/// Reads three coordinates, metres.
pub(crate) fn point(field: &Field<'_>) -> Result<Vec3, Diagnostic> {
    let [x, y, z] = field.tuple(["x", "y", "z"])?;
    let point = Vec3::new(x, y, z);
    if is_position(point) {
        Ok(point)
    } else {
        Err(field.error("has a coordinate above 1e9 m", "coordinates in metres"))
    }
}

/// True if the squares of the coordinates stay finite.
pub(crate) fn is_position(point: Vec3) -> bool {
    point.abs().max_element() <= MAX_COORDINATE_M
}

fn quaternion(field: &Field<'_>) -> Result<Rotation, Diagnostic> {
    rotation(field.tuple(["x", "y", "z", "w"])?).ok_or_else(|| {
        field.error("is a quaternion without direction", "a unit quaternion x, y, z, w: [0, 0, 0, 1] for no rotation")
    })
}

/// The rotation of a quaternion x, y, z, w, normalized; `None` if it has no direction.
pub(crate) fn rotation(q: [f64; 4]) -> Option<Rotation> {
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    let rotation = (length >= MIN_QUATERNION).then(|| Rotation::from_quaternion_xyzw(q)).flatten();
    rotation.filter(|r| r.is_finite())
}

/// The frames of `fixed_frame_transforms`.
pub(crate) fn fixed_frames(scene: &Field<'_>) -> Result<Vec<FixedFrame>, Diagnostic> {
    let frame = |field: &Field<'_>| {
        let name = field.require("child_frame_id", "\"child_frame_id\": \"NAME\"")?.name()?.to_owned();
        let in_parent = field.get("transform")?.map_or(Ok(Pose::IDENTITY), |f| transform(&f))?;
        Ok(FixedFrame { name, parent: frame_id(field)?, in_parent })
    };
    scene.list("fixed_frame_transforms")?.iter().map(frame).collect()
}

/// The frame in the header of a message; empty if it has none.
pub(crate) fn frame_id(field: &Field<'_>) -> Result<String, Diagnostic> {
    let id = field.get("header")?.map_or(Ok(""), |header| header.text_of("frame_id"))?;
    Ok(id.strip_prefix('/').unwrap_or(id).to_owned())
}
