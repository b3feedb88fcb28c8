//! The features by which two meshes touch or are near.

/// The features by which two meshes touch or are near.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFeatures {
    /// These triangles, of the first and of the second mesh, by index.
    Triangles(u32, u32),
    /// One mesh is contained in the other; their surfaces do not touch.
    Containment,
    /// A pose is not finite: unknown counts as contact.
    Unknown,
}
