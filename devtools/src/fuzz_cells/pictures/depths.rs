//! Pictures of depths: how far boxes and the floor are along the axis of a lens.

use elbowroom_spatial::{Pose, Vec3};

use crate::fuzz_cells::spec::{LensSpec, SeenBox, SensorSpec, Vector};

/// A 16-bit PGM of the picture with this index; one that cannot be used is black.
pub fn picture(sensor: &SensorSpec, index: usize, (lens, step): (&LensSpec, f64), is_usable: bool) -> Vec<u8> {
    let in_world = sensor.pose();
    let boxes: Vec<(&SeenBox, Vector)> = sensor.shown(index).collect();
    let mut bytes = format!("P5\n{} {}\n65535\n", lens.columns, lens.rows).into_bytes();
    for pixel in 0..lens.columns * lens.rows {
        let middle = |at: usize, count: usize| (at as f64 + 0.5 - 0.5 * count as f64) / lens.focal;
        let (x, y) = (middle(pixel % lens.columns, lens.columns), middle(pixel / lens.columns, lens.rows));
        let ray = in_world.transform_vector(Vec3::new(x, y, 1.0));
        let depth = if is_usable { depth(sensor.floor, &boxes, &in_world, ray) / step } else { 0.0 };
        bytes.extend((depth.round().clamp(0.0, 65535.0) as u16).to_be_bytes());
    }
    bytes
}

/// How far along a ray (whose length along the axis is 1) the floor or a box is, m; 0 if nothing is there.
fn depth(floor: f64, boxes: &[(&SeenBox, Vector)], in_world: &Pose, ray: Vec3) -> f64 {
    let eye = in_world.translation;
    let to_floor = Some((floor - eye.z) / ray.z).filter(|depth| *depth > 0.0 && depth.is_finite());
    let on_boxes = boxes.iter().filter_map(|(one, at)| enters(one, *at, eye, ray));
    on_boxes.chain(to_floor).reduce(f64::min).unwrap_or(0.0)
}

/// How far along a ray a box begins.
fn enters(one: &SeenBox, at: Vector, eye: Vec3, ray: Vec3) -> Option<f64> {
    let (from, along) = (one.to_own(eye - Vec3::new(at[0], at[1], at[2])), one.to_own(ray));
    let low = [-0.5 * one.size[0], -0.5 * one.size[1], 0.0];
    let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
    for k in 0..3 {
        let [a, b] = [low[k], low[k] + one.size[k]].map(|side| (side - from[k]) / along[k]);
        // Beside a ray along a side both are infinite, or not numbers.
        (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
    }
    (enters > 0.0 && enters <= leaves).then_some(enters)
}
