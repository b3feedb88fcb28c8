//! Images of the observed scene and of the map, as RGB frames: [`encode_png`](elbowroom_vision::encode_png) makes PNG
//! of them.

use elbowroom_cspace::{Grid, OccupancyBitmap};
use elbowroom_planner::Path;
use elbowroom_vision::{Channels, Frame, Point2, VisionError};

use crate::obstacle_update::Prism;
use crate::pipeline::PerceptionPipeline;

const OBSERVED: [u8; 3] = [40, 220, 90];
const PREDICTED: [u8; 3] = [250, 200, 40];
const ARM: [u8; 3] = [60, 140, 255];
const FOREGROUND: [u8; 3] = [255, 70, 60];
const FREE: [u8; 3] = [246, 247, 249];
const BLOCKED: [u8; 3] = [196, 64, 58];
const OLD: [u8; 3] = [120, 120, 130];
const NEW: [u8; 3] = [16, 120, 60];
const CURRENT: [u8; 3] = [20, 60, 200];

/// The longer side of an image of the map is at most so long, pixels, unless a cell is one pixel already.
const MAP_SIZE_PX: usize = 560;
/// Parts of the picture and of the colour in a tint.
const PICTURE_PARTS: u16 = 3;
const COLOR_PARTS: u16 = 2;
/// Most points of a line: its ends may lie far outside of the image.
const MAX_LINE_POINTS: f64 = 1e4;
/// Radius of the dot at the current configuration, pixels, and its square; a little more than 4² makes it round.
const DOT_RADIUS_PX: i32 = 4;
const DOT_SQUARE_PX: i32 = 17;

/// The last frame with annotations: the arm's silhouette tinted blue, foreground red, each prism's footprint green and
/// its predicted area yellow.
///
/// # Errors
/// No frame was processed yet.
pub fn overlay(pipeline: &PerceptionPipeline, prisms: &[Prism]) -> Result<Frame, VisionError> {
    let frame = pipeline.frame();
    let (width, height) = (frame.width(), frame.height());
    let mut canvas = Canvas { width, height, rgb: Vec::with_capacity(3 * width * height) };
    match frame.channels() {
        Channels::Grey => canvas.rgb.extend(frame.pixels().iter().flat_map(|&grey| [grey; 3])),
        Channels::Rgb => canvas.rgb.extend_from_slice(frame.pixels()),
    }
    for (i, &foreground) in pipeline.tracker().foreground().iter().enumerate() {
        let (x, y) = (i % width.max(1), i / width.max(1));
        if foreground != 0 {
            canvas.tint(x, y, FOREGROUND);
        } else if pipeline.mask().is_masked(x, y) {
            canvas.tint(x, y, ARM);
        }
    }
    let floor_z_m = pipeline.tracker().settings().floor_z_m;
    let pixel = |p: Point2| pipeline.tracker().calibration().floor_to_pixel(p, floor_z_m);
    for prism in prisms {
        for (outline, color) in [(&prism.swept_m, PREDICTED), (&prism.footprint_m, OBSERVED)] {
            let corners: Vec<Point2> = outline.iter().filter_map(|&p| pixel(p)).collect();
            canvas.polygon(&corners, color);
        }
    }
    canvas.into_frame("overlay")
}

/// Paths and configuration drawn on an image of the map; map joint values, radians.
#[derive(Debug, Clone, Copy, Default)]
pub struct MapOverlay<'a> {
    /// The path before, drawn grey.
    pub old_path: Option<&'a Path>,
    /// The path now, drawn green.
    pub new_path: Option<&'a Path>,
    /// The current configuration, drawn blue.
    pub q: [f64; 3],
}

/// Projection of the map along θ3: the redder, the larger the blocked share of a row. θ1 to the right, θ2 up.
///
/// # Errors
/// None for a valid grid.
pub fn map_along_elbow(
    occupancy: &OccupancyBitmap,
    grid: &Grid,
    overlay: &MapOverlay<'_>,
) -> Result<Frame, VisionError> {
    let [columns, rows, _] = grid.shape();
    let share = |i: usize, j: usize| {
        let ones: u32 = occupancy.row(i * rows + j).iter().map(|word| word.count_ones()).sum();
        f64::from(ones) / grid.shape()[2] as f64
    };
    draw_map(grid, &Projection { right: 0, up: 1, columns, rows, share: &share }, overlay)
}

/// The slice of the map at the base joint value with the most blocked cells: θ3 to the right, θ2 up.
///
/// # Errors
/// None for a valid grid.
pub fn fullest_slice(occupancy: &OccupancyBitmap, grid: &Grid, overlay: &MapOverlay<'_>) -> Result<Frame, VisionError> {
    let [planes, rows, columns] = grid.shape();
    let blocked = |plane: &usize| occupancy.plane(*plane).iter().map(|word| word.count_ones()).sum::<u32>();
    let plane = (0..planes).max_by_key(blocked).unwrap_or(0) as u16;
    let share = |i: usize, j: usize| f64::from(u8::from(occupancy.is_blocked([plane, j as u16, i as u16])));
    draw_map(grid, &Projection { right: 2, up: 1, columns, rows, share: &share }, overlay)
}

/// The image at half size: each pixel is the mean of four.
///
/// # Errors
/// A frame of less than two pixels a side.
pub fn half(frame: &Frame) -> Result<Frame, VisionError> {
    let (width, height, n) = (frame.width() / 2, frame.height() / 2, frame.channels().count());
    let mut pixels = Vec::with_capacity(width * height * n);
    for y in 0..height {
        let [upper, lower] = [frame.row(2 * y), frame.row(2 * y + 1)];
        for i in (0..width).flat_map(|x| (0..n).map(move |c| 2 * n * x + c)) {
            let sum = [upper[i], upper[i + n], lower[i], lower[i + n]].map(u16::from).iter().sum::<u16>();
            pixels.push((sum / 4) as u8);
        }
    }
    Frame::new(frame.name.clone(), width, height, frame.channels(), pixels)
}

/// A projection of the map to two joints.
struct Projection<'a> {
    /// Joint of the horizontal axis.
    right: usize,
    /// Joint of the vertical axis.
    up: usize,
    columns: usize,
    rows: usize,
    /// Blocked share of a column and row, 0..1.
    share: &'a dyn Fn(usize, usize) -> f64,
}

fn draw_map(grid: &Grid, projection: &Projection<'_>, overlay: &MapOverlay<'_>) -> Result<Frame, VisionError> {
    let &Projection { right, up, columns, rows, share } = projection;
    let scale = (MAP_SIZE_PX / columns.max(rows).max(1)).max(1);
    let (width, height) = (columns * scale, rows * scale);
    let mut canvas = Canvas { width, height, rgb: Vec::with_capacity(3 * width * height) };
    for y in 0..height {
        for x in 0..width {
            let t = share(x / scale, rows - 1 - y / scale);
            canvas.rgb.extend([0, 1, 2].map(|c| (f64::from(FREE[c]) * (1.0 - t) + f64::from(BLOCKED[c]) * t) as u8));
        }
    }
    let at = |q: [f64; 3]| {
        let along = |joint: usize| {
            let axis = &grid.axes()[joint];
            (q[joint] - axis.min()) / axis.step() * scale as f64
        };
        Point2::new(along(right), height as f64 - along(up))
    };
    for (path, color) in [(overlay.old_path, OLD), (overlay.new_path, NEW)] {
        for segment in path.map_or(&[][..], |path| &path.waypoints).windows(2) {
            let [a, b] = [at(segment[0]), at(segment[1])];
            for shift in [0.0, 1.0] {
                let down = Point2::new(0.0, shift);
                canvas.line(a + down, b + down, color);
            }
        }
    }
    canvas.dot(at(overlay.q), CURRENT);
    canvas.into_frame("map")
}

struct Canvas {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Canvas {
    fn pixel(&mut self, x: f64, y: f64, color: [u8; 3]) {
        if x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64 {
            let at = 3 * (y as usize * self.width + x as usize);
            self.rgb[at..at + 3].copy_from_slice(&color);
        }
    }

    fn tint(&mut self, x: usize, y: usize, color: [u8; 3]) {
        if let Some(pixel) = self.rgb.get_mut(3 * (y * self.width + x)..).and_then(|rest| rest.first_chunk_mut::<3>()) {
            let mixed = |c: usize| PICTURE_PARTS * u16::from(pixel[c]) + COLOR_PARTS * u16::from(color[c]);
            *pixel = std::array::from_fn(|c| (mixed(c) / (PICTURE_PARTS + COLOR_PARTS)) as u8);
        }
    }

    fn line(&mut self, a: Point2, b: Point2, color: [u8; 3]) {
        let line = b - a;
        let steps = line.x.abs().max(line.y.abs()).ceil().clamp(1.0, MAX_LINE_POINTS);
        for n in 0..=steps as u32 {
            let p = a + line * (f64::from(n) / steps);
            self.pixel(p.x, p.y, color);
        }
    }

    fn polygon(&mut self, corners: &[Point2], color: [u8; 3]) {
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            self.line(a, b, color);
            self.line(a + Point2::new(0.0, 1.0), b + Point2::new(0.0, 1.0), color);
        }
    }

    fn dot(&mut self, at: Point2, color: [u8; 3]) {
        for dy in -DOT_RADIUS_PX..=DOT_RADIUS_PX {
            for dx in -DOT_RADIUS_PX..=DOT_RADIUS_PX {
                if dx * dx + dy * dy <= DOT_SQUARE_PX {
                    self.pixel(at.x + f64::from(dx), at.y + f64::from(dy), color);
                }
            }
        }
    }

    fn into_frame(self, name: &str) -> Result<Frame, VisionError> {
        Frame::new(name, self.width, self.height, Channels::Rgb, self.rgb)
    }
}
