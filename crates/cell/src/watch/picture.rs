//! Pictures of what was seen and of the map, as RGB frames: [`encode_png`](elbowroom_vision::encode_png) makes files of them.

use elbowroom_cspace::{Grid, Table};
use elbowroom_planner::Path;
use elbowroom_vision::{Channels, Frame, Point2, VisionError};

use super::{Prism, Watch};

const SEEN: [u8; 3] = [40, 220, 90];
const AHEAD: [u8; 3] = [250, 200, 40];
const ARM: [u8; 3] = [60, 140, 255];
const THING: [u8; 3] = [255, 70, 60];
const FREE: [u8; 3] = [246, 247, 249];
const BLOCKED: [u8; 3] = [196, 64, 58];
const OLD: [u8; 3] = [120, 120, 130];
const NEW: [u8; 3] = [16, 120, 60];
const HERE: [u8; 3] = [20, 60, 200];

/// The last frame with what was made of it: the arm's silhouette tinted blue, foreground red, each prism's footprint
/// green and where it is expected yellow.
///
/// # Errors
/// No frame was seen yet.
pub fn overlay(watch: &Watch, prisms: &[Prism]) -> Result<Frame, VisionError> {
    let frame = watch.frame();
    let (width, height) = (frame.width(), frame.height());
    let mut canvas = Canvas { width, height, rgb: Vec::with_capacity(3 * width * height) };
    match frame.channels() {
        Channels::Grey => canvas.rgb.extend(frame.pixels().iter().flat_map(|&grey| [grey; 3])),
        Channels::Rgb => canvas.rgb.extend_from_slice(frame.pixels()),
    }
    for (i, &foreground) in watch.vision().foreground().iter().enumerate() {
        let (x, y) = (i % width.max(1), i / width.max(1));
        if foreground != 0 {
            canvas.tint(x, y, THING);
        } else if watch.mask().is_hidden(x, y) {
            canvas.tint(x, y, ARM);
        }
    }
    let floor_z_m = watch.vision().settings().floor_z_m;
    let pixel = |p: Point2| watch.vision().calibration().floor_to_pixel(p, floor_z_m);
    for prism in prisms {
        for (outline, color) in [(&prism.swept_m, AHEAD), (&prism.footprint_m, SEEN)] {
            let corners: Vec<Point2> = outline.iter().filter_map(|&p| pixel(p)).collect();
            canvas.polygon(&corners, color);
        }
    }
    canvas.into_frame("overlay")
}

/// All of the map, looked at along θ3: the redder, the more of the row is blocked. θ1 to the right, θ2 up; ways are drawn
/// over it, the old one grey, the new one green, the arm blue.
///
/// # Errors
/// None that a grid can cause.
pub fn map_along_elbow(
    table: &Table,
    grid: &Grid,
    ways: [Option<&Path>; 2],
    here: [f64; 3],
) -> Result<Frame, VisionError> {
    let [columns, rows, _] = grid.shape();
    let share = |i: usize, j: usize| {
        let ones: u32 = table.row(i * rows + j).iter().map(|word| word.count_ones()).sum();
        f64::from(ones) / grid.shape()[2] as f64
    };
    draw_map(grid, [0, 1], [columns, rows], &share, ways, here)
}

/// The slice of the map at that value of the base joint at which most cells are blocked: θ3 to the right, θ2 up.
///
/// # Errors
/// None that a grid can cause.
pub fn fullest_slice(
    table: &Table,
    grid: &Grid,
    ways: [Option<&Path>; 2],
    here: [f64; 3],
) -> Result<Frame, VisionError> {
    let [planes, rows, columns] = grid.shape();
    let blocked = |plane: &usize| table.plane(*plane).iter().map(|word| word.count_ones()).sum::<u32>();
    let plane = (0..planes).max_by_key(blocked).unwrap_or(0) as u16;
    let share = |i: usize, j: usize| f64::from(u8::from(table.is_blocked([plane, j as u16, i as u16])));
    draw_map(grid, [2, 1], [columns, rows], &share, ways, here)
}

/// A picture of half the size: each pixel the mean of four.
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

fn draw_map(
    grid: &Grid,
    joints: [usize; 2],
    [columns, rows]: [usize; 2],
    share: &dyn Fn(usize, usize) -> f64,
    ways: [Option<&Path>; 2],
    here: [f64; 3],
) -> Result<Frame, VisionError> {
    let scale = (560 / columns.max(rows).max(1)).max(1);
    let (width, height) = (columns * scale, rows * scale);
    let mut canvas = Canvas { width, height, rgb: Vec::with_capacity(3 * width * height) };
    for y in 0..height {
        for x in 0..width {
            let t = share(x / scale, rows - 1 - y / scale);
            canvas.rgb.extend([0, 1, 2].map(|c| (f64::from(FREE[c]) * (1.0 - t) + f64::from(BLOCKED[c]) * t) as u8));
        }
    }
    let at = |q: [f64; 3]| {
        let along = |k: usize| {
            let axis = &grid.axes()[joints[k]];
            (q[joints[k]] - axis.min()) / axis.step() * scale as f64
        };
        Point2::new(along(0), height as f64 - along(1))
    };
    for (way, color) in ways.into_iter().zip([OLD, NEW]) {
        for leg in way.map_or(&[][..], |path| &path.waypoints).windows(2) {
            let [a, b] = [at(leg[0]), at(leg[1])];
            for shift in [0.0, 1.0] {
                let down = Point2::new(0.0, shift);
                canvas.line(a + down, b + down, color);
            }
        }
    }
    canvas.dot(at(here), HERE);
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
            *pixel = std::array::from_fn(|c| ((3 * u16::from(pixel[c]) + 2 * u16::from(color[c])) / 5) as u8);
        }
    }

    fn line(&mut self, a: Point2, b: Point2, color: [u8; 3]) {
        let way = b - a;
        // Far beyond the picture nothing is drawn: ends are corners of floor or map.
        let steps = way.x.abs().max(way.y.abs()).ceil().clamp(1.0, 1e4);
        for n in 0..=steps as u32 {
            let p = a + way * (f64::from(n) / steps);
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
        for dy in -4..=4 {
            for dx in -4..=4_i32 {
                if dx * dx + dy * dy <= 17 {
                    self.pixel(at.x + f64::from(dx), at.y + f64::from(dy), color);
                }
            }
        }
    }

    fn into_frame(self, name: &str) -> Result<Frame, VisionError> {
        Frame::new(name, self.width, self.height, Channels::Rgb, self.rgb)
    }
}
