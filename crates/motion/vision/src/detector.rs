//! Converts blobs of the image to detections on the floor.

use crate::connected_components::Blob;
use crate::detection::Detection;
use crate::{Calibration, CameraTrackerSettings, Point2, polygon, raster};

/// Longest piece of an outline that is projected to the floor without division if the lens distorts, pixels.
const MAX_PIECE_PX: f64 = 12.0;
/// Number of samples of the brightness along each side of a blob; the outer quarters, which may show floor, are
/// skipped.
const BRIGHTNESS_SAMPLES: usize = 16;

/// Pixels that the arm occludes; all 0 if it occludes none.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OcclusionMask<'a> {
    pub(crate) plane: &'a [u8],
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) is_empty: bool,
}

impl OcclusionMask<'_> {
    /// Whether a convex outline touches an occluded pixel.
    pub(crate) fn touches(&self, outline_px: &[Point2]) -> bool {
        !self.is_empty && raster::any_in_convex(self.plane, self.width, outline_px)
    }
}

/// The detections of one frame; memory is reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detector {
    /// Detections; the first `count` belong to this frame.
    list: Vec<Detection>,
    count: usize,
    points: Vec<Point2>,
    grown_px: Vec<Point2>,
}

impl Detector {
    pub(crate) fn detections(&self) -> &[Detection] {
        &self.list[..self.count]
    }

    /// Projects blobs to the floor and drops blobs that are entirely outside the monitored area.
    pub(crate) fn project(
        &mut self,
        blobs: &[Blob],
        pixels: &[u8],
        occluded: OcclusionMask<'_>,
        calibration: &Calibration,
        settings: &CameraTrackerSettings,
    ) {
        self.count = 0;
        for blob in blobs {
            if self.count == self.list.len() {
                self.list.push(Detection::default());
            }
            self.project_outline(blob, calibration, settings);
            let detection = &mut self.list[self.count];
            if detection.outline_m.len() < 3 || !is_in_area(detection, settings) {
                continue;
            }
            detection.centre_m = polygon::centroid(&detection.outline_m);
            detection.area = polygon::area(&detection.outline_m);
            detection.brightness = brightness(blob, pixels, occluded.width);
            let (columns, rows) = (&blob.columns, &blob.rows);
            detection.touches_border =
                columns.start == 0 || rows.start == 0 || columns.end >= occluded.width || rows.end >= occluded.height;
            // Opening and closing change outlines by a pixel: a distance of up to two more pixels counts as touching.
            polygon::inflate(&blob.outline_px, 2.0, &mut self.grown_px, &mut self.points);
            detection.touches_arm = occluded.touches(&self.grown_px);
            detection.z_from_m = settings.track.floor_z_m;
            detection.z_to_m = settings.track.floor_z_m + settings.unbounded_height_m;
            self.count += 1;
        }
    }

    fn project_outline(&mut self, blob: &Blob, calibration: &Calibration, settings: &CameraTrackerSettings) {
        self.points.clear();
        let longest = if calibration.has_distortion() { MAX_PIECE_PX } else { f64::INFINITY };
        for (a, b) in polygon::edges(&blob.outline_px) {
            let pieces = ((b - a).length() / longest).ceil().max(1.0);
            for piece in 0..pieces as u32 {
                let point_px = a + (b - a) * (f64::from(piece) / pieces);
                self.points.extend(calibration.pixel_to_floor(point_px, settings.track.floor_z_m));
            }
        }
        polygon::convex_hull(&mut self.points, &mut self.list[self.count].outline_m);
    }
}

fn is_in_area(detection: &Detection, settings: &CameraTrackerSettings) -> bool {
    settings.track.area_m.is_empty() || polygon::touches(&detection.outline_m, &settings.track.area_m)
}

/// Mean of a grid of pixels in the middle of the blob.
fn brightness(blob: &Blob, pixels: &[u8], width: usize) -> f64 {
    let (columns, rows) = (&blob.columns, &blob.rows);
    let middle = |range: &std::ops::Range<usize>| {
        let quarter = range.len() / 4;
        (range.start + quarter..range.end - quarter).step_by((range.len() / BRIGHTNESS_SAMPLES).max(1))
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
