//! Pictures of a camera: boxes on a floor with a texture, without the robots.

use elbowroom_spatial::Vec3;
use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
use elbowroom_vision::{Camera, Channels, Frame, Intrinsics, Point2, encode_png};

use crate::fuzz_cells::spec::{SeenBox, SensorSpec, SensorView, Vector};

/// Grey levels of boxes, darker and lighter than the floor.
const GREYS: [u8; 2] = [25, 235];

/// Draws the pictures of a camera; other sensors have none.
pub struct CameraPictures(Option<(Renderer, Frame)>);

impl CameraPictures {
    pub fn new(sensor: &SensorSpec) -> Self {
        let SensorView::Camera { lens } = &sensor.view else { return Self(None) };
        let (width, height) = (lens.columns, lens.rows);
        let [cx, cy] = [width, height].map(|side| 0.5 * side as f64);
        let intrinsics = Intrinsics { width, height, fx: lens.focal, fy: lens.focal, cx, cy, radial: [0.0; 3] };
        let camera = Camera::new(intrinsics, sensor.pose()).ok();
        Self(camera.map(|camera| (Renderer::new(camera, Channels::Grey, 5), Frame::default())))
    }

    /// A PNG of the picture with this index; one that cannot be used is black.
    pub fn picture(&mut self, sensor: &SensorSpec, index: usize, is_usable: bool) -> Vec<u8> {
        let Some((renderer, frame)) = &mut self.0 else { return Vec::new() };
        let boxes: Vec<RenderedSolid> =
            sensor.shown(index).enumerate().map(|(i, (one, at))| solid(one, at, GREYS[i % GREYS.len()])).collect();
        let conditions = RenderConditions {
            gain: f64::from(u8::from(is_usable)),
            seed: index as u64,
            ..RenderConditions::default()
        };
        let drawn = renderer.render(&boxes, &[], &conditions, frame).and_then(|()| encode_png(frame));
        drawn.expect("a camera draws a picture of its size")
    }
}

fn solid(one: &SeenBox, at: Vector, grey: u8) -> RenderedSolid {
    let [length, width, height] = one.size;
    let size = Vec3::new(length, width, height);
    let on_floor = RenderedSolid::cuboid(Point2::new(at[0], at[1]), size, one.yaw, grey);
    RenderedSolid { z_from_m: at[2], z_to_m: at[2] + height, ..on_floor }
}
