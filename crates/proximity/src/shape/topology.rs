//! How the triangles of a mesh hang together.

use std::collections::HashMap;

use elbowroom_spatial::Vec3;

use super::hull::enclosed_volume;
use super::mesh::MeshReport;

pub(super) struct Topology {
    pub report: MeshReport,
    pub parts: Vec<Vec3>,
    pub in_closed_part: Vec<bool>,
}

pub(super) fn examine(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Topology {
    let welded = weld(vertices);
    let faces: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|i| welded[i as usize])).collect();
    let part_of = parts(vertices.len(), &faces);
    let uses = edge_uses(&faces);
    let open = open_parts(&faces, &uses, &part_of);
    let in_closed_part: Vec<bool> = faces.iter().map(|f| !open[part_of[f[0] as usize] as usize]).collect();
    let encloses = in_closed_part.iter().all(|&c| c);
    let signed = if encloses { enclosed_volume(vertices, triangles) } else { 0.0 };
    let report = MeshReport {
        triangles: triangles.len(),
        vertices: vertices.len(),
        closed: encloses && uses.values().all(|count| *count == 2),
        degenerate: triangles.iter().filter(|t| is_degenerate(t.map(|i| vertices[i as usize]))).count(),
        duplicate: duplicates(&faces),
        inside_out: signed < 0.0,
        volume: signed.abs(),
    };
    let mut seen = vec![false; vertices.len()];
    let mut representatives = Vec::new();
    for f in &faces {
        let part = part_of[f[0] as usize] as usize;
        if !std::mem::replace(&mut seen[part], true) {
            representatives.push(vertices[f[0] as usize]);
        }
    }
    Topology { report, parts: representatives, in_closed_part }
}

/// The first vertex of the same coordinates, for each vertex (-0 is 0).
fn weld(vertices: &[Vec3]) -> Vec<u32> {
    let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
    vertices
        .iter()
        .enumerate()
        .map(|(i, v)| *first.entry(v.to_array().map(|c| (c + 0.0).to_bits())).or_insert(i as u32))
        .collect()
}

/// Root vertex of the connected part of each vertex (union-find with path halving).
fn parts(count: usize, faces: &[[u32; 3]]) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    for f in faces {
        let a = root(&mut parent, f[0]);
        for &v in &f[1..] {
            let b = root(&mut parent, v);
            parent[b as usize] = a;
        }
    }
    (0..count as u32).map(|v| root(&mut parent, v)).collect()
}

fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}

/// Faces with three corners.
fn proper(faces: &[[u32; 3]]) -> impl Iterator<Item = &[u32; 3]> {
    faces.iter().filter(|f| f[0] != f[1] && f[1] != f[2] && f[2] != f[0])
}

/// How many faces use each edge.
fn edge_uses(faces: &[[u32; 3]]) -> HashMap<(u32, u32), u32> {
    let mut uses = HashMap::with_capacity(faces.len() * 3 / 2);
    for f in proper(faces) {
        for k in 0..3 {
            let (a, b) = (f[k], f[(k + 1) % 3]);
            *uses.entry((a.min(b), a.max(b))).or_insert(0) += 1;
        }
    }
    uses
}

/// Per part: true where some edge is used by an odd number of triangles, or where no triangle has three corners.
/// A part whose edges are used two or four times still has an inside.
fn open_parts(faces: &[[u32; 3]], uses: &HashMap<(u32, u32), u32>, part_of: &[u32]) -> Vec<bool> {
    let mut open = vec![true; part_of.len()];
    proper(faces).for_each(|f| open[part_of[f[0] as usize] as usize] = false);
    let odd = uses.iter().filter(|(_, count)| *count % 2 == 1);
    odd.for_each(|((a, _), _)| open[part_of[*a as usize] as usize] = true);
    open
}

fn duplicates(faces: &[[u32; 3]]) -> usize {
    let mut seen = std::collections::HashSet::with_capacity(faces.len());
    faces
        .iter()
        .filter(|f| {
            let mut sorted = **f;
            sorted.sort_unstable();
            !seen.insert(sorted)
        })
        .count()
}

/// True where the triangle's height over its longest edge is lost in rounding.
pub(crate) fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() <= 1e-14 * longest2
}
