//! How the triangles of a mesh hang together.

mod edges;
mod equal;
mod near;
mod parts;
mod seams;
#[cfg(test)]
mod tests;

use elbowroom_spatial::Vec3;

use super::hull::enclosed_volume;
use super::mesh::MeshReport;

pub(crate) use edges::{Edges, is_proper};
pub(crate) use equal::first_of_equal;
pub(crate) use near::merge_near;
pub(crate) use parts::parts;

pub(super) struct Topology {
    pub report: MeshReport,
    pub parts: Vec<Vec3>,
    pub in_closed_part: Vec<bool>,
    /// For each vertex the one that stands for it, where seams had to be closed by a tolerance.
    pub joined: Option<Vec<u32>>,
}

pub(super) fn examine(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Topology {
    let first = first_of_equal(vertices);
    let mut surface = Surface::new(vertices, seams::faces(triangles, &first));
    let mut seams = None;
    if surface.edges.odd > 0
        && let Some(found) = seams::close(vertices, triangles, &first)
    {
        surface = Surface::new(vertices, seams::faces(triangles, &found.joined));
        seams = Some(found);
    }
    let Surface { faces, part_of, edges } = surface;
    let in_closed_part: Vec<bool> = faces.iter().map(|f| !edges.open[part_of[f[0] as usize] as usize]).collect();
    let encloses = in_closed_part.iter().all(|&c| c);
    let signed = if encloses { enclosed_volume(vertices, &faces) } else { 0.0 };
    let report = MeshReport {
        triangles: triangles.len(),
        vertices: vertices.len(),
        closed: encloses && edges.all_twice,
        welded: seams.as_ref().map_or(0, |s| s.welded),
        weld_tolerance: seams.as_ref().map_or(0.0, |s| s.tolerance),
        degenerate: triangles.iter().filter(|t| is_degenerate(t.map(|i| vertices[i as usize]))).count(),
        duplicate: edges.duplicates + repeated(&faces),
        inside_out: signed < 0.0,
        volume: signed.abs(),
    };
    let parts = representatives(vertices, &faces, &part_of);
    Topology { report, parts, in_closed_part, joined: seams.map(|s| s.joined) }
}

/// How faces of joined corners hang together.
struct Surface {
    faces: Vec<[u32; 3]>,
    part_of: Vec<u32>,
    edges: EdgeReport,
}

impl Surface {
    fn new(vertices: &[Vec3], faces: Vec<[u32; 3]>) -> Self {
        let part_of = parts(vertices.len(), &faces);
        let edges = examine_edges(vertices.len(), &faces, &part_of);
        Self { faces, part_of, edges }
    }
}

struct EdgeReport {
    /// Per part: true where some edge is used by an odd number of triangles, or where no triangle has three corners.
    /// A part whose edges are used two or four times still has an inside.
    open: Vec<bool>,
    /// Edges used by an odd number of triangles.
    odd: usize,
    /// Every edge has two uses.
    all_twice: bool,
    /// Triangles of three corners that another has already.
    duplicates: usize,
}

fn examine_edges(vertices: usize, faces: &[[u32; 3]], part_of: &[u32]) -> EdgeReport {
    let mut report = EdgeReport { open: vec![true; vertices], odd: 0, all_twice: true, duplicates: 0 };
    for f in faces.iter().filter(|f| is_proper(f)) {
        report.open[part_of[f[0] as usize] as usize] = false;
    }
    // With the third corner as the label, uses that are equal are the same triangle.
    let edges = Edges::new(vertices, faces, |triangle, corner| faces[triangle][(corner + 2) % 3]);
    edges.for_each(|low, high, uses| {
        report.all_twice &= uses.len() == 2;
        if uses.len() % 2 == 1 {
            report.odd += 1;
            report.open[part_of[low as usize] as usize] = true;
        }
        // Counted at one of its three edges, that between its two smaller corners.
        let same = uses.windows(2).filter(|u| u[0] == u[1] && u[0] as u32 > high);
        report.duplicates += same.count();
    });
    report
}

/// Duplicates among the faces with fewer than three corners.
fn repeated(faces: &[[u32; 3]]) -> usize {
    let sorted = |mut f: [u32; 3]| {
        f.sort_unstable();
        f
    };
    let mut flat: Vec<[u32; 3]> = faces.iter().filter(|f| !is_proper(f)).map(|&f| sorted(f)).collect();
    flat.sort_unstable();
    flat.windows(2).filter(|f| f[0] == f[1]).count()
}

/// One vertex of every connected part, in the order of the faces.
fn representatives(vertices: &[Vec3], faces: &[[u32; 3]], part_of: &[u32]) -> Vec<Vec3> {
    let mut seen = vec![false; vertices.len()];
    let mut found = Vec::new();
    for f in faces {
        let part = part_of[f[0] as usize] as usize;
        if !std::mem::replace(&mut seen[part], true) {
            found.push(vertices[f[0] as usize]);
        }
    }
    found
}

/// True where the triangle's height over its longest edge is lost in rounding.
pub(crate) fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    let area2 = (b - a).cross(c - a).length_squared();
    // The root is needed only where the squares leave the range in which they are exact enough.
    if area2 > 1e-200 && longest2 < 1e100 {
        return area2 <= 1e-28 * longest2 * longest2;
    }
    area2.sqrt() <= 1e-14 * longest2
}
