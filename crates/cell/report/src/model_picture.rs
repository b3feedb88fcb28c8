//! An image of the model: triangles in orthographic projection with a depth buffer.

use std::io::{self, Write};

use base64::Engine as _;
use elbowroom_inspect::{Inspection, JointRow, SurfacePoint};
use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::{Capsule, Shape, Sphere, tessellate::tessellate};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Aabb, Pose, Rotation, Vec3};

use crate::png;
use crate::tables::escape;

const WIDTH: usize = 960;
const HEIGHT: usize = 720;
/// Samples per pixel and axis.
const FINE: usize = 2;
/// Largest chord error of tessellated surfaces, m.
const CHORD_M: f64 = 1e-3;
/// Colour of the line to a point of a link.
const CHAIN_COLOR: [f64; 3] = [0.95, 0.65, 0.05];

/// A triangle to render, in the world.
struct ColoredTriangle {
    corners: [Vec3; 3],
    color: [f64; 3],
    /// Triangles of a higher layer are drawn on top of lower ones.
    layer: u8,
}

/// Writes a PNG of the model, seen from the front left and above.
///
/// Every joint is at zero or at the limit nearest to it, and each link has a different colour. The axis of a joint is
/// drawn in front of everything, in the colour of the link that it moves, with a black edge; the arrow points in its
/// positive direction. A point of a link is drawn as the end of a line through the joints that move it.
///
/// # Errors
/// Errors of the writer.
pub fn write_png(inspection: &Inspection, point: Option<&SurfacePoint>, out: impl Write) -> io::Result<()> {
    png::write(out, WIDTH, HEIGHT, &render(&colored_triangles(inspection, point), -35.0, 25.0))
}

/// Writes a page with four images of the model: oblique, from the front, from the side, from above.
///
/// # Errors
/// Errors of the writer.
pub fn write_page(inspection: &Inspection, point: Option<&SurfacePoint>, mut out: impl Write) -> io::Result<()> {
    let colored_triangles = colored_triangles(inspection, point);
    let name = escape(&inspection.name);
    writeln!(out, "<!DOCTYPE html><meta charset=\"utf-8\"><title>{name}</title><h1>{name}</h1>")?;
    for (title, turn, tilt) in
        [("oblique", -35.0, 25.0), ("from x", 0.0, 0.0), ("from y", 90.0, 0.0), ("from above", 0.0, 90.0)]
    {
        let mut file = Vec::new();
        png::write(&mut file, WIDTH, HEIGHT, &render(&colored_triangles, turn, tilt))?;
        let data = base64::engine::general_purpose::STANDARD.encode(file);
        writeln!(
            out,
            "<figure style=\"display:inline-block;margin:4px\"><img width=\"{}\" alt=\"{title}\" src=\"data:image/png;base64,{data}\"><figcaption>{title}</figcaption></figure>",
            WIDTH / 2
        )?;
    }
    for (joint, color) in axes(inspection) {
        let [r, g, b] = color.map(|c| (255.0 * c) as u8);
        writeln!(
            out,
            "<p style=\"margin:2px\"><span style=\"color:rgb({r},{g},{b})\">&#9632;</span> {}</p>",
            escape(&joint)
        )?;
    }
    let text = point.map_or_else(|| inspection.to_string(), ToString::to_string);
    writeln!(out, "<pre>{}</pre>", escape(&text))?;
    out.flush()
}

fn colored_triangles(inspection: &Inspection, point: Option<&SurfacePoint>) -> Vec<ColoredTriangle> {
    let mut all = Vec::new();
    for (i, (colliders, in_world)) in shown(inspection).into_iter().enumerate() {
        let color = color(i);
        for collider in colliders.iter().filter(|b| !matches!(b.shape, Shape::HalfSpace(_))) {
            let (vertices, triangles) = tessellate(&collider.shape, CHORD_M);
            let place = in_world * collider.in_link;
            let corners = |t: [u32; 3]| t.map(|v| place.transform_point(vertices[v as usize]));
            all.extend(triangles.into_iter().map(|t| ColoredTriangle { corners: corners(t), color, layer: 0 }));
        }
    }
    let extent = Aabb::from_points(all.iter().flat_map(|p| p.corners).filter(|p| p.is_finite())).extent();
    let size = if extent.max_element() > 0.0 { extent.max_element() } else { 1.0 };
    add_axes(inspection, size, &mut all);
    if let Some(point) = point {
        add_chain(inspection, point, size, &mut all);
    }
    all
}

/// Adds a line through the joints that move a point of a link, with a ball at its end.
fn add_chain(inspection: &Inspection, point: &SurfacePoint, size: f64, all: &mut Vec<ColoredTriangle>) {
    let Some(robot) = inspection.robot() else { return };
    let Some(link) = robot.chain.link(&point.link) else { return };
    let state = ChainState::at_rest(&robot.chain);
    let joints = robot.chain.path(link).into_iter().map(|id| &robot.chain.joints()[id.0]);
    let mut corners: Vec<Vec3> = vec![Vec3::ZERO];
    corners.extend(joints.filter(|j| j.kind.moves()).map(|j| state.link_in_root(j.child).translation));
    corners.push(Vec3::from(point.at_rest_m));
    let radius = 0.007 * size;
    let rods = corners.windows(2).filter_map(|ends| {
        let along = ends[1] - ends[0];
        let rod = Capsule { half_length: 0.5 * along.length(), radius };
        Some((Shape::Capsule(rod), Pose::new(Rotation::from_z(along.try_normalize()?), ends[0].lerp(ends[1], 0.5))))
    });
    let end = (Shape::Sphere(Sphere { radius: 2.0 * radius }), Pose::from_translation(Vec3::from(point.at_rest_m)));
    for (shape, place) in rods.chain([end]) {
        let (vertices, triangles) = tessellate(&shape, 0.1 * radius);
        let corners = |t: [u32; 3]| t.map(|v| place.transform_point(vertices[v as usize]));
        all.extend(triangles.into_iter().map(|t| ColoredTriangle {
            corners: corners(t),
            color: CHAIN_COLOR,
            layer: 3,
        }));
    }
}

/// Adds an arrow along the axis of every moving joint.
fn add_axes(inspection: &Inspection, size: f64, all: &mut Vec<ColoredTriangle>) {
    let Some(robot) = inspection.robot() else { return };
    let state = ChainState::at_rest(&robot.chain);
    for (i, joint) in robot.chain.joints().iter().filter(|j| j.kind.moves()).enumerate() {
        let place = state.link_in_root(joint.child) * Pose::new(Rotation::from_z(joint.axis), Vec3::ZERO);
        // Lengths differ, so that two axes on one line are both visible. A black arrow below forms the edge.
        let length = size * (0.2 + 0.035 * (i % 3) as f64);
        for (layer, color, edge) in [(1, [0.05; 3], 0.0), (2, color(joint.child.0), size * 0.0015)] {
            let triangles = arrow(length, size * 0.0045, edge).into_iter();
            let triangles = triangles.map(|t| t.map(|v| place.transform_point(v)));
            all.extend(triangles.map(|corners| ColoredTriangle { corners, color, layer }));
        }
    }
}

/// Captions of the axes, with their colours.
fn axes(inspection: &Inspection) -> Vec<(String, [f64; 3])> {
    let Some(robot) = inspection.robot() else { return Vec::new() };
    let chain = &robot.chain;
    let of = |(joint, row): (&elbowroom_kinematics::Joint, &JointRow)| {
        let [x, y, z] = joint.axis.to_array();
        let text = format!(
            "{} ({}) moves {} along or about [{x:.4}, {y:.4}, {z:.4}] of its frame",
            joint.name,
            row.kind_name(),
            chain.links()[joint.child.0]
        );
        (text, color(joint.child.0))
    };
    chain.joints().iter().zip(&inspection.joints).filter(|(j, _)| j.kind.moves()).map(of).collect()
}

/// Colliders with the pose of their link.
fn shown(inspection: &Inspection) -> Vec<(&[Collider], Pose)> {
    let Some(robot) = inspection.robot() else {
        return inspection.solids().iter().map(|s| (&s.1[..], Pose::IDENTITY)).collect();
    };
    let state = ChainState::at_rest(&robot.chain);
    (0..robot.colliders.len()).map(|l| (visuals_or_colliders(robot, l), state.link_in_root(LinkId(l)))).collect()
}

/// The visual meshes of a link, or its collision geometry if it has none.
fn visuals_or_colliders(robot: &Robot, link: usize) -> &[Collider] {
    if robot.visuals[link].is_empty() { &robot.colliders[link] } else { &robot.visuals[link] }
}

/// An arrow along z through the origin, from -`length` to `length`, shrunk by `edge`.
fn arrow(length: f64, radius: f64, edge: f64) -> Vec<[Vec3; 3]> {
    const SEGMENTS: usize = 12;
    let ring = |r: f64, z: f64| -> Vec<Vec3> {
        let turn = |i: usize| std::f64::consts::TAU * i as f64 / SEGMENTS as f64;
        (0..SEGMENTS).map(|i| Vec3::new(r * turn(i).cos(), r * turn(i).sin(), z)).collect()
    };
    let (head, neck) = (4.0 * radius, length - 12.0 * radius);
    let rings = [
        ring(0.0, edge - length),
        ring(radius - edge, edge - length),
        ring(radius - edge, neck + edge),
        ring(head - 1.4 * edge, neck + edge),
        ring(0.0, length - 3.0 * edge),
    ];
    let mut triangles = Vec::new();
    for pair in rings.windows(2) {
        for i in 0..SEGMENTS {
            let j = (i + 1) % SEGMENTS;
            triangles.push([pair[0][i], pair[0][j], pair[1][i]]);
            triangles.push([pair[1][i], pair[0][j], pair[1][j]]);
        }
    }
    triangles
}

/// Hues spaced by the golden angle: neighbours differ.
fn color(i: usize) -> [f64; 3] {
    let hue = (i as f64 * 0.381_966 + 0.58).fract() * 6.0;
    let ramp = |shift: f64| ((hue + shift).rem_euclid(6.0) - 3.0).abs().clamp(1.0, 2.0) - 1.0;
    [ramp(0.0), ramp(4.0), ramp(2.0)].map(|c| 0.35 + 0.5 * c)
}

/// Renders along -x after rotations about z and y (degrees); red, green, blue per pixel.
fn render(colored_triangles: &[ColoredTriangle], turn: f64, tilt: f64) -> Vec<u8> {
    let turned =
        Rotation::from_axis_angle(Vec3::Y, tilt.to_radians()) * Rotation::from_axis_angle(Vec3::Z, turn.to_radians());
    let seen: Vec<([Vec3; 3], [f64; 3], u8)> =
        colored_triangles.iter().map(|p| (p.corners.map(|c| turned * c), p.color, p.layer)).collect();
    let around = Aabb::from_points(seen.iter().flat_map(|s| s.0).filter(|p| p.is_finite()));
    let nearer = 2.0 * around.extent().x + 1.0;
    let (width, height) = (WIDTH * FINE, HEIGHT * FINE);
    let extent = around.extent();
    let scale = 0.92 * (width as f64 / extent.y.max(1e-9)).min(height as f64 / extent.z.max(1e-9));
    let middle = around.center();
    let mut depths = vec![f64::NEG_INFINITY; width * height];
    let mut colors = vec![[245.0_f64; 3]; width * height];
    for (corners, color, layer) in &seen {
        // To pixels: x to the right, y down, z towards the viewer.
        let at = corners.map(|c| {
            let c = c - middle;
            Vec3::new(0.5 * width as f64 + c.y * scale, 0.5 * height as f64 - c.z * scale, c.x)
        });
        let Some(normal) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize() else { continue };
        // Both sides are lit, because a surface may be inside out.
        let light = 0.35 + 0.45 * normal.dot(Vec3::new(0.8, -0.3, 0.52)).abs() + 0.2 * normal.x.abs();
        fill(at, width, height, |pixel, depth| {
            let depth = depth + nearer * f64::from(*layer);
            if depth > depths[pixel] {
                depths[pixel] = depth;
                colors[pixel] = color.map(|c| 255.0 * (c * light).min(1.0));
            }
        });
    }
    shrink(&colors)
}

/// Calls `paint` with the pixel and the depth of every sample in the triangle.
fn fill([a, b, c]: [Vec3; 3], width: usize, height: usize, mut paint: impl FnMut(usize, f64)) {
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
