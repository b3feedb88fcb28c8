//! Seams that are open by a hair: corners that are one in the drawing and differ in the last digits of a file.
//!
//! Moving corners together never opens what is closed: an edge with an even number of uses keeps it, and a triangle that
//! loses a corner takes its uses away in pairs. So only corners on rims are looked at.

use elbowroom_spatial::{Aabb, Vec3};

use super::near::merge_near;
use super::{Edges, is_proper};

/// Corners on rims within this share of the mesh's largest extent are one. Single precision, in which most files are
/// written, keeps 6e-8 of a coordinate.
pub(super) const TOLERANCE: f64 = 1e-6;

/// Corners brought together.
pub(super) struct Seams {
    /// For each vertex the one that stands for it.
    pub joined: Vec<u32>,
    /// Corners of different coordinates that another one stands for now.
    pub welded: usize,
    /// Metres.
    pub tolerance: f64,
}

/// Joins corners on rims; `None` where no rim gets shorter. `first` is the first of equal coordinates.
pub(super) fn close(vertices: &[Vec3], triangles: &[[u32; 3]], first: &[u32]) -> Option<Seams> {
    let (rim, open) = rim(vertices.len(), &faces(triangles, first));
    let extent = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices[i as usize])).extent();
    let tolerance = TOLERANCE * extent.max_element();
    let mut joined = first.to_vec();
    merge_near(vertices, &mut joined, tolerance, |i| rim[i]);
    let welded = joined.iter().zip(first).enumerate().filter(|(i, (j, f))| **f as usize == *i && j != f).count();
    let closer = welded > 0 && self::rim(vertices.len(), &faces(triangles, &joined)).1 < open;
    closer.then_some(Seams { joined, welded, tolerance })
}

/// Triangles by the vertices that stand for their corners.
pub(super) fn faces(triangles: &[[u32; 3]], joined: &[u32]) -> Vec<[u32; 3]> {
    triangles.iter().map(|t| t.map(|i| joined[i as usize])).collect()
}

/// Vertices on edges of an odd number of uses, or of triangles that have no three corners; and how many such edges.
fn rim(vertices: usize, faces: &[[u32; 3]]) -> (Vec<bool>, usize) {
    let (mut on_rim, mut open) = (vec![false; vertices], 0);
    Edges::new(vertices, faces, |_, _| 0).for_each(|low, high, uses| {
        if uses.len() % 2 == 1 {
            (on_rim[low as usize], on_rim[high as usize], open) = (true, true, open + 1);
        }
    });
    for &v in faces.iter().filter(|f| !is_proper(f)).flatten() {
        on_rim[v as usize] = true;
    }
    (on_rim, open)
}
