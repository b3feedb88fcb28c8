//! Work-pieces of the examples, in their own frames: a head to be opened, and a relief to be followed.

use std::f64::consts::{PI, TAU};

use elbowroom_spatial::Vec3;

use super::model::File;
use crate::solid::{Mesh, binary_stl, loft, upright};

/// Returns every work-piece's mesh.
pub fn files() -> Result<Vec<File>, String> {
    let named = |name: &str, part: Mesh| -> Result<File, String> {
        let mut mesh = Mesh::new();
        mesh.add(&upright([0.0; 3]), &part);
        mesh.check().map_err(|e| format!("{name}: {e}"))?;
        Ok((format!("work_pieces/{name}.stl"), binary_stl(&mesh)))
    };
    Ok(vec![named("skull", skull())?, named("relief", relief())?])
}

/// A bump or a hollow of the skull: its direction, its share of the radius, and its width in radians.
struct Feature {
    direction: [f64; 3],
    share: f64,
    width: f64,
}

/// Half the length, width and height of the head, metres; x is forward, z up.
const HEAD: [f64; 3] = [0.090, 0.072, 0.076];

/// Those with y > 0 are mirrored.
const FEATURES: [Feature; 8] = [
    Feature { direction: [0.92, 0.36, -0.10], share: -0.24, width: 0.20 },
    Feature { direction: [0.93, 0.33, 0.24], share: 0.05, width: 0.20 },
    Feature { direction: [0.95, 0.0, -0.36], share: -0.16, width: 0.16 },
    Feature { direction: [0.75, 0.60, -0.38], share: 0.07, width: 0.20 },
    Feature { direction: [0.35, 0.92, -0.10], share: -0.08, width: 0.30 },
    Feature { direction: [0.72, 0.0, -0.75], share: 0.26, width: 0.36 },
    Feature { direction: [-1.0, 0.0, -0.05], share: 0.05, width: 0.50 },
    Feature { direction: [-0.55, 0.0, -0.83], share: -0.10, width: 0.35 },
];

/// A head of 195 mm: an ellipsoid with hollows for eyes and nose, cheekbones and a jaw, seen from its middle under one
/// radius per direction. It is closed, and does not cross itself.
fn skull() -> Mesh {
    const RINGS: usize = 42;
    const SEGMENTS: usize = 56;
    let ring = |k: usize| -> Vec<Vec3> {
        // From below to above, without the two poles.
        let polar = PI - PI * (k as f64 + 0.5) / RINGS as f64;
        let point = |j: usize| {
            let azimuth = TAU * j as f64 / SEGMENTS as f64;
            let direction = Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
            direction * skull_radius(direction)
        };
        (0..SEGMENTS).map(point).collect()
    };
    loft(&(0..RINGS).map(ring).collect::<Vec<_>>())
}

fn skull_radius(direction: Vec3) -> f64 {
    let [x, y, z] = [direction.x / HEAD[0], direction.y / HEAD[1], direction.z / HEAD[2]];
    let ellipsoid = 1.0 / (x * x + y * y + z * z).sqrt();
    let mirrored = Vec3::new(direction.x, direction.y.abs(), direction.z);
    let share = |f: &Feature| {
        let toward = Vec3::from(f.direction);
        let angle = (mirrored.dot(toward) / toward.length()).clamp(-1.0, 1.0).acos();
        f.share * (-(angle / f.width) * (angle / f.width)).exp()
    };
    ellipsoid * (1.0 + FEATURES.iter().map(share).sum::<f64>())
}

/// A block of 240 × 180 × 40 mm under sharp ridges along y, which smooth waves cross: valleys, edges and saddles. Its
/// frame is in the middle at the mean height of its upper side.
fn relief() -> Mesh {
    const COLUMNS: u32 = 48;
    const ROWS: u32 = 30;
    let (length, width, depth) = (0.240, 0.180, 0.040);
    let mut mesh = Mesh::new();
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let x = length * (f64::from(column) / f64::from(COLUMNS) - 0.5);
            let y = width * (f64::from(row) / f64::from(ROWS) - 0.5);
            // 60 mm from ridge to ridge, which is twelve columns.
            let sharp = (x / 0.060 - (x / 0.060).round()).abs() * 4.0 - 1.0;
            mesh.vertices.push(Vec3::new(x, y, 0.006 * sharp + 0.004 * (y / 0.020).sin()));
        }
    }
    let number = |column: u32, row: u32| row * (COLUMNS + 1) + column;
    for (column, row) in (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (column, row))) {
        let [a, b] = [number(column, row), number(column + 1, row)];
        let [c, d] = [number(column + 1, row + 1), number(column, row + 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    // Around the border, counter-clockwise seen from above.
    let mut border: Vec<u32> = (0..COLUMNS).map(|column| number(column, 0)).collect();
    border.extend((0..ROWS).map(|row| number(COLUMNS, row)));
    border.extend((1..=COLUMNS).rev().map(|column| number(column, ROWS)));
    border.extend((1..=ROWS).rev().map(|row| number(0, row)));
    let (first, n) = (mesh.vertices.len() as u32, border.len() as u32);
    for &v in &border {
        let above = mesh.vertices[v as usize];
        mesh.vertices.push(Vec3::new(above.x, above.y, -depth));
    }
    mesh.vertices.push(Vec3::Z * -depth);
    for (k, next) in (0..n).map(|k| (k, (k + 1) % n)) {
        let [above, beside] = [border[k as usize], border[next as usize]];
        mesh.triangles.extend([[above, first + k, first + next], [above, first + next, beside]]);
        mesh.triangles.push([first + n, first + next, first + k]);
    }
    mesh
}
