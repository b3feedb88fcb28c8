//! Blobs of the picture to things on the floor.

use crate::associate::Detection;
use crate::components::Blob;
use crate::{Calibration, Point2, Settings, polygon, raster};

/// Longest piece of an outline that is taken to the floor as a straight line where the lens bends lines, pixels.
const STRAIGHT_PX: f64 = 12.0;

/// A picture's plane of hidden pixels, all 0 where nothing is hidden.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hidden<'a> {
    pub(crate) plane: &'a [u8],
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) is_empty: bool,
}

impl Hidden<'_> {
    /// Whether a convex outline touches a hidden pixel.
    pub(crate) fn touches(&self, outline_px: &[Point2]) -> bool {
        !self.is_empty && raster::any_in_convex(self.plane, self.width, outline_px)
    }
}

/// Things seen in one frame; memory is reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detections {
    list: Vec<Detection>,
    found: usize,
    points: Vec<Point2>,
    grown_px: Vec<Point2>,
}

impl Detections {
    pub(crate) fn list(&self) -> &[Detection] {
        &self.list[..self.found]
    }

    /// Takes blobs to the floor and drops those wholly outside of the cell.
    pub(crate) fn place(
        &mut self,
        blobs: &[Blob],
        pixels: &[u8],
        hidden: Hidden<'_>,
        calibration: &Calibration,
        settings: &Settings,
    ) {
        self.found = 0;
        for blob in blobs {
            if self.found == self.list.len() {
                self.list.push(Detection::default());
            }
            self.put_on_floor(blob, calibration, settings);
            let detection = &mut self.list[self.found];
            if detection.outline_m.len() < 3 || !is_in_cell(detection, settings) {
                continue;
            }
            detection.centre_m = polygon::centroid(&detection.outline_m);
            detection.area = polygon::area(&detection.outline_m);
            detection.brightness = brightness(blob, pixels, hidden.width);
            let (columns, rows) = (&blob.columns, &blob.rows);
            detection.is_cut_by_border =
                columns.start == 0 || rows.start == 0 || columns.end >= hidden.width || rows.end >= hidden.height;
            // Opening and closing work on the pixels beside: two more count as touching.
            polygon::grown(&blob.outline_px, 2.0, &mut self.grown_px, &mut self.points);
            detection.is_cut_by_arm = hidden.touches(&self.grown_px);
            detection.z_from_m = settings.floor_z_m;
            detection.z_to_m = settings.floor_z_m + settings.unbounded_height_m;
            self.found += 1;
        }
    }

    fn put_on_floor(&mut self, blob: &Blob, calibration: &Calibration, settings: &Settings) {
        self.points.clear();
        let longest = if calibration.bends_lines() { STRAIGHT_PX } else { f64::INFINITY };
        for (a, b) in polygon::edges(&blob.outline_px) {
            let pieces = ((b - a).length() / longest).ceil().max(1.0);
            for piece in 0..pieces as u32 {
                let seen_px = a + (b - a) * (f64::from(piece) / pieces);
                self.points.extend(calibration.pixel_to_floor(seen_px, settings.floor_z_m));
            }
        }
        polygon::convex_hull(&mut self.points, &mut self.list[self.found].outline_m);
    }
}

fn is_in_cell(detection: &Detection, settings: &Settings) -> bool {
    settings.cell.is_empty() || polygon::touches(&detection.outline_m, &settings.cell)
}

/// Mean of some pixels of the blob's middle rows and columns: enough to tell a dark thing from a light one.
fn brightness(blob: &Blob, pixels: &[u8], width: usize) -> f64 {
    let (columns, rows) = (&blob.columns, &blob.rows);
    let middle = |range: &std::ops::Range<usize>| {
        let quarter = range.len() / 4;
        (range.start + quarter..range.end - quarter).step_by((range.len() / 16).max(1))
    };
    let (mut sum, mut n) = (0_u64, 0_u32);
    for y in middle(rows) {
        for x in middle(columns) {
            sum += u64::from(pixels[y * width + x]);
            n += 1;
        }
    }
    sum as f64 / f64::from(n.max(1))
}
