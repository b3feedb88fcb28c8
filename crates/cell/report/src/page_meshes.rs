//! Triangle meshes of the page, each once.

use std::collections::HashMap;

use elbowroom_proximity::repair::merge_targets;
use elbowroom_spatial::{Aabb, Vec3};
use serde_json::{Value, json};

use crate::packing::ArrayPacker;
use crate::region_surface::SurfaceMesh;

/// Levels along the longest side of a mesh that is only drawn.
const DRAWN_LEVELS: f64 = 16_384.0;
/// Step of the coordinates from which the page computes distances, m.
const EXACT_STEP_M: f64 = 1e-8;

/// Use of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshUse {
    /// Drawn only: coordinates to a sixteen-thousandth of the mesh.
    Drawn,
    /// Distances are computed from it.
    Measured,
}

/// Bits of the vertices, and the corners of the triangles.
type MeshKey = (MeshUse, Vec<[u64; 3]>, Vec<u32>);

/// Packs meshes; equal ones are stored once.
#[derive(Debug, Default)]
pub struct PageMeshes {
    known: HashMap<MeshKey, usize>,
    entries: Vec<Value>,
}

impl PageMeshes {
    /// Index of the mesh in [`Self::entries`].
    pub fn add(&mut self, packer: &mut ArrayPacker, (vertices, triangles): &SurfaceMesh, used: MeshUse) -> usize {
        let (corners, index) = welded(vertices, triangles);
        let key = (used, corners.iter().map(|v| v.to_array().map(f64::to_bits)).collect(), index);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let size = Aabb::from_points(corners.iter().copied()).extent().max_element();
        let step = if used == MeshUse::Measured { EXACT_STEP_M } else { (size / DRAWN_LEVELS).max(EXACT_STEP_M) };
        let coordinates: Vec<f64> = corners.iter().flat_map(|v| v.to_array()).collect();
        let index: Vec<f64> = key.2.iter().map(|i| f64::from(*i)).collect();
        let entry = json!({ "v": packer.add(&coordinates, 3, step), "i": packer.add(&index, 1, 1.0) });
        self.entries.push(entry);
        self.known.insert(key, self.entries.len() - 1);
        self.entries.len() - 1
    }

    /// The meshes, for the page.
    pub fn entries(self) -> Vec<Value> {
        self.entries
    }
}

/// Merges coincident vertices, so that the page can smooth normals.
///
/// Omits triangles without area, and triangles with an index beyond the vertices.
fn welded(vertices: &[Vec3], triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<u32>) {
    let target = merge_targets(vertices, 0.0);
    let mut place = vec![None; vertices.len()];
    let mut corners = Vec::new();
    let mut index = Vec::with_capacity(3 * triangles.len());
    for triangle in triangles.iter().filter(|t| t.iter().all(|&i| (i as usize) < vertices.len())) {
        let [a, b, c] = triangle.map(|i| {
            let first = target[i as usize] as usize;
            *place[first].get_or_insert_with(|| {
                corners.push(vertices[first]);
                corners.len() as u32 - 1
            })
        });
        if a != b && b != c && c != a {
            index.extend([a, b, c]);
        }
    }
    (corners, index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_meshes_are_stored_once_and_corners_are_merged() {
        let quad = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let surface = (quad, vec![[0, 1, 2], [3, 4, 5], [0, 0, 1], [0, 1, 99]]);
        let (mut packer, mut meshes) = (ArrayPacker::default(), PageMeshes::default());
        let add = |packer: &mut ArrayPacker, meshes: &mut PageMeshes, used| meshes.add(packer, &surface, used);
        assert_eq!(add(&mut packer, &mut meshes, MeshUse::Drawn), 0);
        let size = packer.bytes().len();
        assert_eq!(add(&mut packer, &mut meshes, MeshUse::Drawn), 0);
        assert_eq!(packer.bytes().len(), size);
        assert_eq!(add(&mut packer, &mut meshes, MeshUse::Measured), 1);
        let entries = meshes.entries();
        assert_eq!((entries[0]["v"]["n"].clone(), entries[0]["i"]["n"].clone()), (json!(12), json!(6)));
    }
}
