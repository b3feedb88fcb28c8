//! A picture of the model: triangles drawn without perspective into a buffer of depths.

use std::io::{self, Write};

use base64::Engine as _;
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::{Shape, tessellate::tessellate};
use elbowroom_scene::{Body, Robot};
use elbowroom_spatial::{Aabb, Pose, Rotation, Vec3};

use super::Inspection;
use crate::png;

const WIDTH: usize = 960;
const HEIGHT: usize = 720;
/// Samples per pixel and axis.
const FINE: usize = 2;
/// Drawn surfaces are no farther (m) from curved ones.
const CHORD_M: f64 = 1e-3;

/// A corner-free thing to draw: three points in the world and a colour.
struct Painted {
    corners: [Vec3; 3],
    color: [f64; 3],
}

impl Inspection {
    /// Writes a PNG of the model from the front left and above, every joint at zero or at the limit nearest to it, each
    /// link in a colour of its own.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn write_png(&self, out: impl Write) -> io::Result<()> {
        png::write(out, WIDTH, HEIGHT, &draw(&self.painted(), -35.0, 25.0))
    }

    /// Writes a page with four such pictures: askew, from the front, from the side, from above.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn write_page(&self, mut out: impl Write) -> io::Result<()> {
        let painted = self.painted();
        let escape = |t: &str| t.replace('&', "&amp;").replace('<', "&lt;");
        let name = escape(&self.name);
        writeln!(out, "<!DOCTYPE html><meta charset=\"utf-8\"><title>{name}</title><h1>{name}</h1>")?;
        for (title, turn, tilt) in
            [("askew", -35.0, 25.0), ("from x", 0.0, 0.0), ("from y", 90.0, 0.0), ("from above", 0.0, 90.0)]
        {
            let mut file = Vec::new();
            png::write(&mut file, WIDTH, HEIGHT, &draw(&painted, turn, tilt))?;
            let data = base64::engine::general_purpose::STANDARD.encode(file);
            writeln!(
                out,
                "<figure style=\"display:inline-block;margin:4px\"><img width=\"{}\" alt=\"{title}\" src=\"data:image/png;base64,{data}\"><figcaption>{title}</figcaption></figure>",
                WIDTH / 2
            )?;
        }
        writeln!(out, "<pre>{}</pre>", escape(&self.to_string()))?;
        out.flush()
    }

    fn painted(&self) -> Vec<Painted> {
        let mut all = Vec::new();
        for (i, (bodies, in_world)) in self.shown().into_iter().enumerate() {
            let color = color(i);
            for body in bodies.iter().filter(|b| !matches!(b.shape, Shape::HalfSpace(_))) {
                let (vertices, triangles) = tessellate(&body.shape, CHORD_M);
                let place = in_world * body.in_link;
                let corners = |t: [u32; 3]| t.map(|v| place.transform_point(vertices[v as usize]));
                all.extend(triangles.into_iter().map(|t| Painted { corners: corners(t), color }));
            }
        }
        all
    }

    /// Bodies with the pose of their frame.
    fn shown(&self) -> Vec<(&[Body], Pose)> {
        let Some(robot) = &self.robot else { return self.solids.iter().map(|s| (&s.1[..], Pose::IDENTITY)).collect() };
        let mut state = ChainState::new(&robot.chain);
        let bounds = robot.chain.lower().into_iter().zip(robot.chain.upper());
        state.q.iter_mut().zip(bounds).for_each(|(q, (lower, upper))| *q = 0.0_f64.min(upper).max(lower));
        robot.chain.forward(&mut state);
        (0..robot.bodies.len()).map(|l| (bodies(robot, l), state.link_in_root(LinkId(l)))).collect()
    }
}

/// What is looked at, or where there is nothing, what collides.
fn bodies(robot: &Robot, link: usize) -> &[Body] {
    if robot.visuals[link].is_empty() { &robot.bodies[link] } else { &robot.visuals[link] }
}

/// Hues a golden angle apart: neighbours differ.
fn color(i: usize) -> [f64; 3] {
    let hue = (i as f64 * 0.381_966 + 0.58).fract() * 6.0;
    let ramp = |shift: f64| ((hue + shift).rem_euclid(6.0) - 3.0).abs().clamp(1.0, 2.0) - 1.0;
    [ramp(0.0), ramp(4.0), ramp(2.0)].map(|c| 0.35 + 0.5 * c)
}

/// Looks along -x after the world was turned about z and tilted (degrees); red, green, blue per pixel.
fn draw(painted: &[Painted], turn: f64, tilt: f64) -> Vec<u8> {
    let turned =
        Rotation::from_axis_angle(Vec3::Y, tilt.to_radians()) * Rotation::from_axis_angle(Vec3::Z, turn.to_radians());
    let seen: Vec<([Vec3; 3], [f64; 3])> = painted.iter().map(|p| (p.corners.map(|c| turned * c), p.color)).collect();
    let around = Aabb::from_points(seen.iter().flat_map(|s| s.0).filter(|p| p.is_finite()));
    let (width, height) = (WIDTH * FINE, HEIGHT * FINE);
    let extent = around.extent();
    let scale = 0.92 * (width as f64 / extent.y.max(1e-9)).min(height as f64 / extent.z.max(1e-9));
    let middle = around.center();
    let mut depths = vec![f64::NEG_INFINITY; width * height];
    let mut colors = vec![[245.0_f64; 3]; width * height];
    for (corners, color) in &seen {
        // To pixels: x to the right, y down, z towards the eye.
        let at = corners.map(|c| {
            let c = c - middle;
            Vec3::new(0.5 * width as f64 + c.y * scale, 0.5 * height as f64 - c.z * scale, c.x)
        });
        let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else { continue };
        // Both sides are lit, for a surface may be inside out.
        let light = 0.35 + 0.45 * normal.dot(Vec3::new(0.8, -0.3, 0.52)).abs() + 0.2 * normal.x.abs();
        fill(at, (width, height), |pixel, depth| {
            if depth > depths[pixel] {
                depths[pixel] = depth;
                colors[pixel] = color.map(|c| 255.0 * (c * light).min(1.0));
            }
        });
    }
    shrink(&colors)
}

/// Calls `paint` with the pixel and the depth of every sample in the triangle.
fn fill([a, b, c]: [Vec3; 3], (width, height): (usize, usize), mut paint: impl FnMut(usize, f64)) {
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if !(area.abs() > 1e-12) {
        return;
    }
    let range = |values: [f64; 3], most: usize| {
        let least = values.into_iter().fold(f64::INFINITY, f64::min).floor().max(0.0);
        let greatest = values.into_iter().fold(f64::NEG_INFINITY, f64::max).ceil().min(most as f64);
        least as usize..greatest.max(0.0) as usize
    };
    let columns = range([a.x, b.x, c.x], width);
    for y in range([a.y, b.y, c.y], height) {
        for x in columns.clone() {
            let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
            let u = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) / area;
            let v = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) / area;
            let w = 1.0 - u - v;
            if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                paint(y * width + x, u * a.z + v * b.z + w * c.z);
            }
        }
    }
}

/// The mean of the samples of each pixel.
fn shrink(colors: &[[f64; 3]]) -> Vec<u8> {
    let mut rgb = Vec::with_capacity(WIDTH * HEIGHT * 3);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let samples = (0..FINE * FINE).map(|s| colors[(y * FINE + s / FINE) * WIDTH * FINE + x * FINE + s % FINE]);
            let sum = samples.fold([0.0; 3], |t: [f64; 3], c| [t[0] + c[0], t[1] + c[1], t[2] + c[2]]);
            rgb.extend(sum.map(|v| (v / (FINE * FINE) as f64).round() as u8));
        }
    }
    rgb
}
