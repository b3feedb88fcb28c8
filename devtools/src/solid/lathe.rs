//! Solids of revolution about z.

use std::f64::consts::TAU;

use elbowroom_spatial::Vec3;

use super::{Mesh, loft};

/// Rotates a profile of `[radius, z]` about z. It runs from bottom to top, with all radii above zero; the ends are
/// closed flat.
pub fn lathe(profile: &[[f64; 2]], segments: usize) -> Mesh {
    let sections: Vec<_> = profile.iter().map(|&[radius, z]| circle(radius, z, segments)).collect();
    loft(&sections)
}

/// Rotates a closed loop of `[radius, z]` about z: a solid with a bore. The loop goes up outside and down inside.
pub fn ring(profile: &[[f64; 2]], segments: usize) -> Mesh {
    let rows = profile.len() as u32;
    let n = segments as u32;
    let vertices = profile.iter().flat_map(|&[radius, z]| circle(radius, z, segments)).collect();
    let mut triangles = Vec::new();
    for (lower, upper) in (0..rows).map(|row| (row * n, (row + 1) % rows * n)) {
        for (j, k) in (0..n).map(|j| (j, (j + 1) % n)) {
            triangles.extend([[lower + j, lower + k, upper + k], [lower + j, upper + k, upper + j]]);
        }
    }
    Mesh { vertices, triangles }
}

fn circle(radius: f64, z: f64, segments: usize) -> Vec<Vec3> {
    let point = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / segments as f64).sin_cos();
        Vec3::new(radius * cos, radius * sin, z)
    };
    (0..segments).map(point).collect()
}
