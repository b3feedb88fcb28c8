//! Topology of a mesh: components, edges, seams, duplicates.

mod components;
mod edges;
mod equal_vertices;
mod merge_near;
mod seams;
#[cfg(test)]
mod tests;

use elbowroom_spatial::Vec3;

use super::hull::enclosed_volume;
use super::mesh_report::MeshReport;

pub(crate) use components::components;
pub(crate) use edges::{Edges, is_proper};
pub(crate) use equal_vertices::first_of_equal;
pub(crate) use merge_near::merge_near;

pub(super) struct Topology {
    pub report: MeshReport,
    /// One vertex of every connected component.
    pub component_vertices: Vec<Vec3>,
    /// Whether each triangle, by index, belongs to a closed component.
    pub in_closed_component: Vec<bool>,
    /// Whether each triangle, by index, belongs to a component in which neighbours are oriented alike.
    pub in_oriented_component: Vec<bool>,
    /// The representative of each vertex, if seams had to be closed by a tolerance.
    pub welded_vertices: Option<Vec<u32>>,
}

pub(super) fn examine(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Topology {
    let first = first_of_equal(vertices);
    let mut surface = Surface::new(vertices, seams::faces(triangles, &first));
    let mut seams = None;
    if surface.edges.odd > 0
        && let Some(found) = seams::close(vertices, triangles, &first)
    {
        surface = Surface::new(vertices, seams::faces(triangles, &found.welded_vertices));
        seams = Some(found);
    }
    let Surface { faces, component_of, edges } = surface;
    let in_closed_component: Vec<bool> =
        faces.iter().map(|f| !edges.open[component_of[f[0] as usize] as usize]).collect();
    let in_oriented_component = faces.iter().map(|f| !edges.unoriented[component_of[f[0] as usize] as usize]).collect();
    let encloses = in_closed_component.iter().all(|&c| c);
    let signed = if encloses { enclosed_volume(vertices, &faces) } else { 0.0 };
    let report = MeshReport {
        triangles: triangles.len(),
        vertices: vertices.len(),
        closed: encloses && edges.all_twice,
        welded: seams.as_ref().map_or(0, |s| s.welded),
        weld_tolerance: seams.as_ref().map_or(0.0, |s| s.tolerance),
        degenerate: triangles.iter().filter(|t| is_degenerate(t.map(|i| vertices[i as usize]))).count(),
        duplicate: edges.duplicates + degenerate_duplicates(&faces),
        inside_out: signed < 0.0,
        volume: signed.abs(),
    };
    let component_vertices = representatives(vertices, &faces, &component_of);
    let welded_vertices = seams.map(|s| s.welded_vertices);
    Topology { report, component_vertices, in_closed_component, in_oriented_component, welded_vertices }
}

/// Faces by representative vertices, their components and edges.
struct Surface {
    faces: Vec<[u32; 3]>,
    component_of: Vec<u32>,
    edges: EdgeReport,
}

impl Surface {
    fn new(vertices: &[Vec3], faces: Vec<[u32; 3]>) -> Self {
        let component_of = components(vertices.len(), &faces);
        let edges = examine_edges(vertices.len(), &faces, &component_of);
        Self { faces, component_of, edges }
    }
}

struct EdgeReport {
    /// True, per component, if an edge is used by an odd number of triangles, or if no triangle has three different
    /// corners. A component whose edges are used two or four times still has an interior.
    open: Vec<bool>,
    /// True, per component, if an edge is not used equally often in both directions.
    unoriented: Vec<bool>,
    /// Number of edges used by an odd number of triangles.
    odd: usize,
    /// True if every edge has two uses.
    all_twice: bool,
    /// Number of triangles with three different corners that an earlier triangle has already.
    duplicates: usize,
}

fn examine_edges(vertices: usize, faces: &[[u32; 3]], component_of: &[u32]) -> EdgeReport {
    let mut report = EdgeReport {
        open: vec![true; vertices],
        unoriented: vec![false; vertices],
        odd: 0,
        all_twice: true,
        duplicates: 0,
    };
    for f in faces.iter().filter(|f| is_proper(f)) {
        report.open[component_of[f[0] as usize] as usize] = false;
    }
    // The label is the third corner and the direction of the edge: uses with the same third corner are the same
    // triangle.
    let label = |triangle: usize, corner: usize| {
        let [a, b, third] = [0, 1, 2].map(|k| faces[triangle][(corner + k) % 3]);
        third << 1 | u32::from(a > b)
    };
    let third = |label: u64| label as u32 >> 1;
    let edges = Edges::new(vertices, faces, label);
    edges.for_each(|low, high, uses| {
        report.all_twice &= uses.len() == 2;
        let reversed = uses.iter().filter(|&&label| label & 1 == 1).count();
        if 2 * reversed != uses.len() {
            report.unoriented[component_of[low as usize] as usize] = true;
        }
        if uses.len() % 2 == 1 {
            report.odd += 1;
            report.open[component_of[low as usize] as usize] = true;
        }
        // A triangle is counted at one of its three edges, the one between its two smaller corners.
        let same = uses.windows(2).filter(|u| third(u[0]) == third(u[1]) && third(u[0]) > high);
        report.duplicates += same.count();
    });
    report
}

/// Number of duplicates among the faces with fewer than three different corners.
fn degenerate_duplicates(faces: &[[u32; 3]]) -> usize {
    let sorted = |mut f: [u32; 3]| {
        f.sort_unstable();
        f
    };
    let mut flat: Vec<[u32; 3]> = faces.iter().filter(|f| !is_proper(f)).map(|&f| sorted(f)).collect();
    flat.sort_unstable();
    flat.windows(2).filter(|f| f[0] == f[1]).count()
}

/// One vertex of every connected component, in the order of the faces.
fn representatives(vertices: &[Vec3], faces: &[[u32; 3]], component_of: &[u32]) -> Vec<Vec3> {
    let mut seen = vec![false; vertices.len()];
    let mut found = Vec::new();
    for f in faces {
        let component = component_of[f[0] as usize] as usize;
        if !std::mem::replace(&mut seen[component], true) {
            found.push(vertices[f[0] as usize]);
        }
    }
    found
}

/// True if the height of the triangle over its longest edge is below rounding.
pub(crate) fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    let area2 = (b - a).cross(c - a).length_squared();
    // The square root is needed only if the squares would overflow or underflow.
    if area2 > 1e-200 && longest2 < 1e100 {
        return area2 <= 1e-28 * longest2 * longest2;
    }
    area2.sqrt() <= 1e-14 * longest2
}
