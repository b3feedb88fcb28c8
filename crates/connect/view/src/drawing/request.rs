//! Requests of a page that draws, in metres and in the world.

use elbowroom_spatial::Vec3;
use serde::Deserialize;

/// Asks for the point of an object's surface that a ray from the eye meets first.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PickRequest {
    /// Name of the object.
    pub(crate) object: String,
    origin_m: [f64; 3],
    direction: [f64; 3],
}

impl PickRequest {
    /// Origin and direction of the ray.
    pub(crate) fn ray(&self) -> (Vec3, Vec3) {
        (Vec3::from(self.origin_m), Vec3::from(self.direction))
    }
}

/// Asks for the line along the surface through drawn points.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LineRequest {
    /// Name of the object.
    pub(crate) object: String,
    points_m: Vec<[f64; 3]>,
    /// Whether the line returns to its first point.
    pub(crate) closed: bool,
    /// Width of the opening, metres.
    pub(crate) width_m: f64,
    /// Largest error of the shield, metres; `None` for the default.
    #[serde(default)]
    pub(crate) tolerance_m: Option<f64>,
}

impl LineRequest {
    /// The drawn points.
    pub(crate) fn points(&self) -> Vec<Vec3> {
        self.points_m.iter().copied().map(Vec3::from).collect()
    }
}
