//! Drawing of convex polygons.

use elbowroom_spatial::Vec3;

use super::solid::RenderedSolid;
use crate::{ArmPart, Camera, Point2, mask, polygon};

/// An image being drawn.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<[u8; 3]>,
    /// Pixels in shadow: they are dimmed once, regardless of the number of shadows.
    shade: Vec<u8>,
    points: Vec<Point2>,
    outline: Vec<Point2>,
}

/// Number of pieces of each edge: with lens distortion, edges are curves.
const PIECES_PER_EDGE: u32 = 6;

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

    /// Dims the floor (z = 0) in the shadows of solids.
    pub(super) fn shadows(&mut self, camera: &Camera, solids: &[RenderedSolid], light: Vec3, brightness: f64) {
        if light.z >= 0.0 {
            return;
        }
        self.shade.fill(0);
        for solid in solids {
            self.points.clear();
            for z in [solid.z_from_m, solid.z_to_m] {
                let shift = Point2::new(light.x, light.y) * (-z / light.z);
                self.points.extend(solid.footprint_m.iter().map(|&p| p + shift));
            }
            polygon::convex_hull(&mut self.points, &mut self.outline);
            let corners: Vec<Vec3> = self.outline.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
            self.outline_of(camera, &corners);
            for_each_centre(self.width, self.height, &self.outline, |i| self.shade[i] = 1);
        }
        for (pixel, _) in self.pixels.iter_mut().zip(&self.shade).filter(|(_, shade)| **shade == 1) {
            *pixel = pixel.map(|value| (f64::from(value) * brightness) as u8);
        }
    }

    /// Draws the visible sides, then the top.
    pub(super) fn solid(&mut self, camera: &Camera, solid: &RenderedSolid) {
        let eye = camera.eye_in_world();
        let at = |p: Point2, z: f64| Vec3::new(p.x, p.y, z);
        for (a, b) in polygon::edges(&solid.footprint_m) {
            let outward = Point2::new(b.y - a.y, a.x - b.x);
            if outward.dot(Point2::new(eye.x, eye.y) - a) > 0.0 {
                // The light comes from the upper left, so that sides have different shades.
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

    /// Computes the outline in the image of a flat convex patch of the world.
    fn outline_of(&mut self, camera: &Camera, corners: &[Vec3]) {
        self.points.clear();
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            for piece in 0..PIECES_PER_EDGE {
                self.points.extend(camera.world_to_pixel(a.lerp(b, f64::from(piece) / f64::from(PIECES_PER_EDGE))));
            }
        }
        polygon::convex_hull(&mut self.points, &mut self.outline);
    }
}

/// Calls `visit` with each pixel whose centre is inside a convex outline.
fn for_each_centre(width: usize, height: usize, outline_px: &[Point2], mut visit: impl FnMut(usize)) {
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
            (first as usize..=last as usize).for_each(|x| visit(y * width + x));
        }
    }
}
