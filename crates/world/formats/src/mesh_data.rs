//! Triangle meshes as the readers return them.

use std::path::Path;

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::{Aabb, Vec3};

use crate::{FormatError, Warning};

/// Largest number of vertices or triangles that a file may expand to, instances counted.
pub(crate) const MAX_ELEMENTS: usize = 20_000_000;

/// The triangles of one object.
///
/// Every index is below `vertices.len()` and every coordinate is finite; degenerate and duplicate triangles stay.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    /// The object's name in the file, or the file's stem.
    pub name: String,
    /// Positions in metres, in the frame of the file.
    pub vertices: Vec<Vec3>,
    /// Vertices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl MeshData {
    /// The bounding box of all vertices; empty if there are none.
    pub fn aabb(&self) -> Aabb {
        Aabb::from_points(self.vertices.iter().copied())
    }

    /// Multiplies every vertex by a factor per axis; for a mirror image the winding is reversed.
    ///
    /// ```
    /// use elbowroom_formats::MeshData;
    /// use elbowroom_spatial::Vec3;
    /// let mut mesh = MeshData {
    ///     name: "flag".into(),
    ///     vertices: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
    ///     triangles: vec![[0, 1, 2]],
    /// };
    /// mesh.scale(Vec3::new(-1.0, 1.0, 1.0));
    /// assert_eq!(mesh.triangles, [[0, 2, 1]]);
    /// ```
    pub fn scale(&mut self, factors: Vec3) {
        self.vertices.iter_mut().for_each(|v| *v = v.scale(factors));
        if factors.x * factors.y * factors.z < 0.0 {
            self.flip();
        }
    }

    /// Adds the triangles of another mesh.
    pub(crate) fn append(&mut self, other: Self) {
        let offset = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|i| i.saturating_add(offset))));
    }

    pub(crate) fn flip(&mut self) {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }

    /// The mesh as a shape for queries.
    ///
    /// # Errors
    /// What [`TriMesh::new`] refuses; `file` is named in the message.
    pub fn into_trimesh(self, file: &Path) -> Result<TriMesh, FormatError> {
        let name = self.name;
        TriMesh::new(self.vertices, self.triangles)
            .map_err(|e| FormatError::new(file, None, format!("the object `{name}` is no solid: {e}")))
    }
}

/// The content of a mesh file.
#[derive(Debug, Clone, Default)]
pub struct LoadedMeshes {
    /// One entry per object, whatever its materials; never empty, and none without triangles.
    pub meshes: Vec<MeshData>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

impl LoadedMeshes {
    /// The bounding box of all meshes.
    pub fn aabb(&self) -> Aabb {
        self.meshes.iter().fold(Aabb::EMPTY, |all, m| all.union(&m.aabb()))
    }

    /// All objects as one mesh, with the name of the first.
    pub fn merged(self) -> MeshData {
        let mut parts = self.meshes.into_iter();
        let mut whole = parts.next().unwrap_or_default();
        for part in parts {
            whole.append(part);
        }
        whole
    }
}

/// Treatment of the up axis of a COLLADA file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpAxis {
    /// Rotate the mesh so that up is +z.
    ToZ,
    /// Ignore it, as rviz and `MoveIt` do for meshes of a URDF.
    Ignore,
}

/// Gives every mesh its own vertices, in the order of its triangles.
pub(crate) fn split_vertices(vertices: &[Vec3], meshes: &mut [MeshData]) {
    let mut new_index = vec![(u32::MAX, 0); vertices.len()];
    for (m, mesh) in meshes.iter_mut().enumerate() {
        for corner in mesh.triangles.iter_mut().flatten() {
            let (owner, index) = &mut new_index[*corner as usize];
            if *owner != m as u32 {
                *owner = m as u32;
                *index = mesh.vertices.len() as u32;
                mesh.vertices.push(vertices[*corner as usize]);
            }
            *corner = *index;
        }
    }
}
