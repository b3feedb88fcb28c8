//! Triangle meshes, as returned by the readers.

use std::path::Path;

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::{Aabb, Vec3};

use crate::Diagnostic;

/// Largest number of vertices or triangles to which a file may expand, including instances.
pub(crate) const MAX_ELEMENTS: usize = 20_000_000;

/// The triangles of one object.
///
/// Every index is below `vertices.len()` and every coordinate is finite; degenerate and duplicate triangles stay.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    /// Name of the object in the file, or the file's stem.
    pub name: String,
    /// Positions in metres, in the frame of the file.
    pub vertices: Vec<Vec3>,
    /// Vertices of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl MeshData {
    /// The bounding box of all vertices; empty without vertices.
    pub fn aabb(&self) -> Aabb {
        Aabb::from_points(self.vertices.iter().copied())
    }

    /// Multiplies every vertex by a factor per axis. A mirroring scale reverses the winding.
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

    /// Appends the triangles of another mesh.
    pub(crate) fn append(&mut self, other: Self) {
        let offset = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        self.triangles.extend(other.triangles.into_iter().map(|t| t.map(|i| i.saturating_add(offset))));
    }

    pub(crate) fn flip(&mut self) {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }

    /// Converts the mesh to a shape for queries.
    ///
    /// # Errors
    /// The errors of [`TriMesh::new`]; `file` is named in the message.
    pub fn into_trimesh(self, file: &Path) -> Result<TriMesh, Diagnostic> {
        let name = self.name;
        TriMesh::new(self.vertices, self.triangles)
            .map_err(|e| Diagnostic::new(file, None, format!("the object `{name}` is no solid: {e}")))
    }
}

/// The content of a mesh file.
#[derive(Debug, Clone, Default)]
pub struct LoadedMeshes {
    /// One entry per object, whatever its materials. Never empty; every entry has triangles.
    pub meshes: Vec<MeshData>,
    /// Warnings for the user.
    pub warnings: Vec<Diagnostic>,
}

impl LoadedMeshes {
    /// The bounding box of all meshes.
    pub fn aabb(&self) -> Aabb {
        self.meshes.iter().fold(Aabb::EMPTY, |all, m| all.union(&m.aabb()))
    }

    /// Merges all objects into one mesh, with the name of the first.
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
    /// Rotates the mesh so that its up axis is +z.
    ToZ,
    /// Ignores the up axis, as rviz and `MoveIt` do for meshes of a URDF.
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
