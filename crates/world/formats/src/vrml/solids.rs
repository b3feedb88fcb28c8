//! `Box`, `Sphere`, `Cylinder` and `Cone` as triangles.
//!
//! A box is exact. The triangles of the others enclose the solid, so that nothing of it counts as free.

use elbowroom_proximity::tessellate::tessellate;
use elbowroom_proximity::{Cuboid, Cylinder, Shape, Sphere};
use elbowroom_spatial::Vec3;

use super::values::Fields;
use crate::Diagnostic;
use crate::mesh_data::MeshData;

/// Largest distance of the triangles from the solid, m.
const DEVIATION_M: f64 = 1e-4;
/// The same as a part of the radius, if that is more: it bounds the number of triangles.
const DEVIATION: f64 = 1e-3;
/// Part of the deviation for the chords; the rest is for the quotient of chords and enclosing triangles.
const CHORD: f64 = 0.85;

/// The parts of the surface of a cylinder or cone that are read.
#[derive(Clone, Copy)]
struct Parts {
    bottom: bool,
    side: bool,
    top: bool,
}

/// Reads a solid; `scale` is the largest factor by which its group lengthens it. `None` for other geometry.
pub(super) fn solid(fields: Fields<'_, '_>, scale: f64) -> Option<Result<MeshData, Diagnostic>> {
    Some(match fields.node.kind {
        b"Box" => cuboid(fields),
        b"Sphere" => fields.length("radius", 1.0).and_then(|radius| {
            let shape = checked(fields, Shape::Sphere(Sphere { radius }))?;
            Ok(enclosing_sphere(&shape, radius, scale))
        }),
        b"Cylinder" => cylinder(fields, scale),
        b"Cone" => cone(fields, scale),
        _ => return None,
    })
}

fn checked(fields: Fields<'_, '_>, shape: Shape) -> Result<Shape, Diagnostic> {
    shape.validate().map_err(|e| fields.error(e).hint("a size in metres that is above 0"))?;
    Ok(shape)
}

fn cuboid(fields: Fields<'_, '_>) -> Result<MeshData, Diagnostic> {
    let size = fields.tuple("size", [2.0; 3])?;
    if let Some(part) = size.iter().find(|s| **s <= 0.0) {
        return Err(fields.error(format!("has the size {part}")).hint("three lengths above 0, in metres"));
    }
    let shape = checked(fields, Shape::Cuboid(Cuboid { half_extents: Vec3::from(size) * 0.5 }))?;
    let (vertices, triangles) = tessellate(&shape, DEVIATION_M);
    Ok(MeshData { name: String::new(), vertices, triangles })
}

fn chord_error(radius: f64, scale: f64) -> f64 {
    CHORD * (DEVIATION_M / scale).max(DEVIATION * radius)
}

/// The triangles of a sphere, enlarged until the nearest of them touches it.
fn enclosing_sphere(shape: &Shape, radius: f64, scale: f64) -> MeshData {
    let (mut vertices, triangles) = tessellate(shape, chord_error(radius, scale));
    let distance = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        (b - a).cross(c - a).try_normalize().map_or(f64::INFINITY, |normal| normal.dot(a))
    };
    let nearest = triangles.iter().map(distance).fold(radius, f64::min);
    let factor = radius / nearest;
    for v in &mut vertices {
        *v = upright(*v * factor);
    }
    MeshData { name: String::new(), vertices, triangles }
}

fn cylinder(fields: Fields<'_, '_>, scale: f64) -> Result<MeshData, Diagnostic> {
    let (radius, height) = (fields.length("radius", 1.0)?, fields.length("height", 2.0)?);
    let parts = Parts {
        bottom: fields.boolean("bottom", true)?,
        side: fields.boolean("side", true)?,
        top: fields.boolean("top", true)?,
    };
    let ring = ring(fields, radius, height, scale)?;
    let count = ring.len();
    let mut vertices = ring;
    vertices.extend_from_within(..);
    vertices[count..].iter_mut().for_each(|v| v.y = 0.5 * height);
    vertices.extend([Vec3::Y * (-0.5 * height), Vec3::Y * (0.5 * height)]);
    let (bottom, top) = (2 * count as u32, 2 * count as u32 + 1);
    let mut triangles = Vec::with_capacity(4 * count);
    for (a, b) in neighbours(count) {
        let (above_a, above_b) = (a + count as u32, b + count as u32);
        if parts.bottom {
            triangles.push([bottom, b, a]);
        }
        if parts.side {
            triangles.extend([[a, b, above_b], [a, above_b, above_a]]);
        }
        if parts.top {
            triangles.push([top, above_a, above_b]);
        }
    }
    Ok(MeshData { name: String::new(), vertices, triangles })
}

fn cone(fields: Fields<'_, '_>, scale: f64) -> Result<MeshData, Diagnostic> {
    let (radius, height) = (fields.length("bottomRadius", 1.0)?, fields.length("height", 2.0)?);
    let (has_bottom, has_side) = (fields.boolean("bottom", true)?, fields.boolean("side", true)?);
    let mut vertices = ring(fields, radius, height, scale)?;
    let count = vertices.len();
    vertices.extend([Vec3::Y * (-0.5 * height), Vec3::Y * (0.5 * height)]);
    let (centre, tip) = (count as u32, count as u32 + 1);
    let mut triangles = Vec::with_capacity(2 * count);
    for (a, b) in neighbours(count) {
        if has_bottom {
            triangles.push([centre, b, a]);
        }
        if has_side {
            triangles.push([a, b, tip]);
        }
    }
    Ok(MeshData { name: String::new(), vertices, triangles })
}

/// Pairs of neighbours of a ring.
fn neighbours(count: usize) -> impl Iterator<Item = (u32, u32)> {
    (0..count).map(move |i| (i as u32, ((i + 1) % count) as u32))
}

/// The lower edge of a cylinder around y, counter-clockwise seen from above, with the circle inside it.
fn ring(fields: Fields<'_, '_>, radius: f64, height: f64, scale: f64) -> Result<Vec<Vec3>, Diagnostic> {
    let half_length = 0.5 * height;
    let shape = checked(fields, Shape::Cylinder(Cylinder { half_length, radius }))?;
    let (vertices, _) = tessellate(&shape, chord_error(radius, scale));
    // Without the two centres, the first half is the lower edge.
    let count = (vertices.len() - 2) / 2;
    let factor = 1.0 / (std::f64::consts::PI / count as f64).cos();
    let outside = |v: &Vec3| upright(Vec3::new(v.x * factor, v.y * factor, v.z));
    Ok(vertices[2..2 + count].iter().map(outside).collect())
}

/// Turns the axis of a solid from z to y.
fn upright(v: Vec3) -> Vec3 {
    Vec3::new(v.y, v.z, v.x)
}
