//! Convex patches on a canvas.

use elbowroom_spatial::Vec3;

use super::Solid;
use crate::{ArmPart, Camera, Point2, mask, polygon};

/// A picture being drawn.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<[u8; 3]>,
    /// What lies in shadow: pixels are dimmed once, however many shadows fall on them.
    shade: Vec<u8>,
    points: Vec<Point2>,
    outline: Vec<Point2>,
}

/// Pieces of each edge, so that a lens that bends lines bends it.
const PIECES: u32 = 6;

impl Canvas {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self {
            width,
            height,
            pixels: vec![[0; 3]; pixels],
            shade: vec![0; pixels],
            points: Vec::new(),
            outline: Vec::new(),
        }
    }

    /// Dims the floor (z = 0) behind solids.
    pub(super) fn shadows(&mut self, camera: &Camera, solids: &[Solid], light: Vec3, share: f64) {
        if light.z >= 0.0 {
            return;
        }
        self.shade.fill(0);
        for solid in solids {
            self.points.clear();
            for z in [solid.z_from_m, solid.z_to_m] {
                let slide = Point2::new(light.x, light.y) * (-z / light.z);
                self.points.extend(solid.footprint_m.iter().map(|&p| p + slide));
            }
            polygon::convex_hull(&mut self.points, &mut self.outline);
            let corners: Vec<Vec3> = self.outline.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
            self.outline_of(camera, &corners);
            for_each_centre(self.width, self.height, &self.outline, |i| self.shade[i] = 1);
        }
        for (pixel, _) in self.pixels.iter_mut().zip(&self.shade).filter(|(_, shade)| **shade == 1) {
            *pixel = pixel.map(|value| (f64::from(value) * share) as u8);
        }
    }

    /// The sides that the camera sees, then the top.
    pub(super) fn solid(&mut self, camera: &Camera, solid: &Solid) {
        let eye = camera.eye_in_world();
        let at = |p: Point2, z: f64| Vec3::new(p.x, p.y, z);
        for (a, b) in polygon::edges(&solid.footprint_m) {
            let outward = Point2::new(b.y - a.y, a.x - b.x);
            if outward.dot(Point2::new(eye.x, eye.y) - a) > 0.0 {
                // Light from the upper left: sides differ, as they do in any hall.
                let facing = outward.dot(Point2::new(-0.6, 0.8)) / outward.length().max(1e-12);
                let colour = solid.colour.map(|value| (f64::from(value) * (0.85 + 0.1 * facing)) as u8);
                let (low, high) = (solid.z_from_m, solid.z_to_m);
                self.patch(camera, &[at(a, low), at(b, low), at(b, high), at(a, high)], colour);
            }
        }
        if eye.z > solid.z_to_m {
            let top: Vec<Vec3> = solid.footprint_m.iter().map(|&p| at(p, solid.z_to_m)).collect();
            self.patch(camera, &top, solid.colour);
        }
    }

    pub(super) fn arm_part(&mut self, camera: &Camera, part: &ArmPart, grey: u8) {
        self.points.clear();
        mask::silhouette(camera, part, 0.0, &mut self.points, &mut self.outline);
        polygon::convex_hull(&mut self.points, &mut self.outline);
        self.fill([grey; 3]);
    }

    fn patch(&mut self, camera: &Camera, corners: &[Vec3], colour: [u8; 3]) {
        self.outline_of(camera, corners);
        self.fill(colour);
    }

    fn fill(&mut self, colour: [u8; 3]) {
        for_each_centre(self.width, self.height, &self.outline, |i| self.pixels[i] = colour);
    }

    /// The outline in the picture of a flat convex patch of the world.
    fn outline_of(&mut self, camera: &Camera, corners: &[Vec3]) {
        self.points.clear();
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            for piece in 0..PIECES {
                self.points.extend(camera.world_to_pixel(a.lerp(b, f64::from(piece) / f64::from(PIECES))));
            }
        }
        polygon::convex_hull(&mut self.points, &mut self.outline);
    }
}

/// Calls with each pixel whose middle lies in a convex outline.
fn for_each_centre(width: usize, height: usize, outline_px: &[Point2], mut found: impl FnMut(usize)) {
    let low = outline_px.iter().fold(f64::INFINITY, |s, p| s.min(p.y)).max(0.0) as usize;
    let high = outline_px.iter().fold(0.0_f64, |s, p| s.max(p.y)) as usize;
    for y in low..height.min(high + 1) {
        let v = y as f64 + 0.5;
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for (a, b) in polygon::edges(outline_px) {
            if (a.y <= v) != (b.y <= v) {
                let x = a.x + (v - a.y) / (b.y - a.y) * (b.x - a.x);
                (left, right) = (left.min(x), right.max(x));
            }
        }
        let first = (left - 0.5).ceil().max(0.0);
        let last = (right - 0.5).floor().min(width as f64 - 1.0);
        if first <= last {
            (first as usize..=last as usize).for_each(|x| found(y * width + x));
        }
    }
}
