//! Hairline seams: vertices that are one in the model, but differ in the last digits of a file.
//!
//! Merging vertices never opens a closed surface: an edge with an even number of uses keeps an even number, and a
//! triangle that degenerates removes its uses in pairs. So only vertices on boundaries are considered.

use elbowroom_spatial::{Aabb, Vec3};

use super::merge_near::merge_near;
use super::{Edges, is_proper};

/// Distance, as a fraction of the mesh's largest extent, within which boundary vertices are merged. Single
/// precision, which most files use, keeps 6e-8 of a coordinate.
pub(super) const TOLERANCE: f64 = 1e-6;

/// Vertices merged across seams.
pub(super) struct Seams {
    /// The representative of each vertex.
    pub welded_vertices: Vec<u32>,
    /// Number of vertices represented by a vertex with different coordinates.
    pub welded: usize,
    /// Tolerance, metres.
    pub tolerance: f64,
}

/// Merges boundary vertices; `None` if that shortens no boundary. `first` is the first vertex with equal
/// coordinates.
pub(super) fn close(vertices: &[Vec3], triangles: &[[u32; 3]], first: &[u32]) -> Option<Seams> {
    let (on_boundary, open) = boundary(vertices.len(), &faces(triangles, first));
    let extent = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices[i as usize])).extent();
    let tolerance = TOLERANCE * extent.max_element();
    let mut welded_vertices = first.to_vec();
    merge_near(vertices, &mut welded_vertices, tolerance, |i| on_boundary[i]);
    let welded =
        welded_vertices.iter().zip(first).enumerate().filter(|(i, (j, f))| **f as usize == *i && j != f).count();
    let shorter = welded > 0 && boundary(vertices.len(), &faces(triangles, &welded_vertices)).1 < open;
    shorter.then_some(Seams { welded_vertices, welded, tolerance })
}

/// Triangles by the representatives of their vertices.
pub(super) fn faces(triangles: &[[u32; 3]], representative: &[u32]) -> Vec<[u32; 3]> {
    triangles.iter().map(|t| t.map(|i| representative[i as usize])).collect()
}

/// Vertices on edges with an odd number of uses, or of triangles without three different corners; and the number of
/// such edges.
fn boundary(vertices: usize, faces: &[[u32; 3]]) -> (Vec<bool>, usize) {
    let (mut on_boundary, mut open) = (vec![false; vertices], 0);
    Edges::new(vertices, faces, |_, _| 0).for_each(|low, high, uses| {
        if uses.len() % 2 == 1 {
            (on_boundary[low as usize], on_boundary[high as usize], open) = (true, true, open + 1);
        }
    });
    for &v in faces.iter().filter(|f| !is_proper(f)).flatten() {
        on_boundary[v as usize] = true;
    }
    (on_boundary, open)
}
