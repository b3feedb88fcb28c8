//! What makes two meshes touch or be near.

/// What makes two meshes touch or be near.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFeatures {
    /// These triangles, of the first and of the second mesh, by index.
    Triangles(u32, u32),
    /// One mesh is contained in the other; their surfaces do not touch.
    Containment,
    /// A pose is not finite: what is unknown counts as contact.
    Unknown,
}
