//! Open and non-manifold edges of a mesh.

use std::collections::HashMap;

use elbowroom_proximity::TriMesh;

/// Counts the edges with one face, and the edges with more than two faces.
///
/// Vertices are merged as in the test for closed meshes; degenerate faces have no edges.
pub(super) fn count(mesh: &TriMesh) -> (usize, usize) {
    let weld = mesh.welded_vertices();
    let mut uses: HashMap<(u32, u32), u32> = HashMap::with_capacity(mesh.triangles().len() * 3 / 2);
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|i| weld[i as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *uses.entry((from.min(to), from.max(to))).or_insert(0) += 1;
        }
    }
    let with = |test: fn(u32) -> bool| uses.values().filter(|n| test(**n)).count();
    (with(|n| n == 1), with(|n| n > 2))
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::Vec3;

    use super::*;

    fn counts(triangles: Vec<[u32; 3]>) -> (usize, usize) {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(-0.0, 0.0, 0.0), -Vec3::Z];
        count(&TriMesh::new(corners, triangles).unwrap())
    }

    #[test]
    fn a_missing_face_leaves_three_open_edges_and_a_fin_one_non_manifold_edge() {
        let tetrahedron = vec![[0, 2, 1], [4, 1, 3], [0, 3, 2], [1, 2, 3]];
        assert_eq!(counts(tetrahedron.clone()), (0, 0), "corner 4 is corner 0");
        assert_eq!(counts(tetrahedron[1..].to_vec()), (3, 0));
        let fin = [tetrahedron.clone(), vec![[0, 1, 5]]].concat();
        assert_eq!(counts(fin), (2, 1));
        assert_eq!(counts([tetrahedron, vec![[0, 4, 1]]].concat()), (0, 0), "a face of two corners has no edges");
    }
}
