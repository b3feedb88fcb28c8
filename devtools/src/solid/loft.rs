//! Skin over a row of sections.

use elbowroom_spatial::Vec3;

use super::Mesh;

/// Joins closed rings with equal numbers of points, each counter-clockwise about the direction of travel, and closes
/// both ends with a fan about the ring's centre: the end sections must be star-shaped about it.
pub fn loft(sections: &[Vec<Vec3>]) -> Mesh {
    let mut mesh = Mesh::new();
    let (Some(first), Some(last)) = (sections.first(), sections.last()) else { return mesh };
    let n = first.len() as u32;
    mesh.vertices = sections.iter().flatten().copied().collect();
    for lower in (0..sections.len() as u32 - 1).map(|section| section * n) {
        for (j, k) in (0..n).map(|j| (j, (j + 1) % n)) {
            let (a, b, c, d) = (lower + j, lower + k, lower + n + k, lower + n + j);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let top = (sections.len() as u32 - 1) * n;
    let start = push_middle(&mut mesh, first);
    mesh.triangles.extend((0..n).map(|j| [start, (j + 1) % n, j]));
    let end = push_middle(&mut mesh, last);
    mesh.triangles.extend((0..n).map(|j| [end, top + j, top + (j + 1) % n]));
    mesh
}

fn push_middle(mesh: &mut Mesh, ring: &[Vec3]) -> u32 {
    let sum = ring.iter().fold(Vec3::ZERO, |sum, &p| sum + p);
    mesh.vertices.push(sum / ring.len() as f64);
    mesh.vertices.len() as u32 - 1
}
