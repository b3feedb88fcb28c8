//! Making triangles from a drawing fit for questions: corners brought together, faces turned the same way, parts told
//! apart.
//!
//! [`TriMesh`](crate::TriMesh) accepts triangles as they are and reports on them; these functions change them, and say
//! what they changed.
//!
//! ```
//! use elbowroom_proximity::TriMesh;
//! use elbowroom_proximity::repair::{orient, weld};
//! use elbowroom_spatial::Vec3;
//! // A tetrahedron as an STL has it: every triangle with corners of its own, a little off, one face turned over.
//! let [o, x, y, z] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let mut corners = vec![o, y, x, o, x, z, o, y, z, x, y, z];
//! corners[4].y += 1e-7;
//! let faces = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
//! let welded = weld(&corners, &faces, 1e-6).unwrap();
//! assert_eq!((welded.vertices.len(), welded.report.merged), (4, 8));
//! let oriented = orient(&welded.vertices, &welded.triangles).unwrap();
//! assert_eq!(oriented.report.flipped, 1);
//! let mesh = TriMesh::new(welded.vertices, oriented.triangles).unwrap();
//! assert!(mesh.report().closed && !mesh.report().inside_out);
//! ```

mod orient;
mod shells;
mod split;
mod weld;

pub(crate) use shells::Shells;

pub use orient::{OrientReport, Oriented, orient};
pub use split::{Part, split};
pub use weld::{WeldReport, Welded, weld};

/// Why triangles were not touched.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RepairError {
    /// The tolerance is negative, NaN or infinite.
    #[error("the welding tolerance is {0}, it must be a finite number of metres, 0 (equal coordinates) or more")]
    Tolerance(f64),
    /// A triangle points outside the vertex list.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Which triangle, from 0.
        triangle: usize,
        /// The index it names.
        index: u32,
        /// Number of vertices.
        vertices: usize,
    },
    /// Indices are 32 bits wide.
    #[error("{0} is more vertices or triangles than 32-bit indices can name (4294967295)")]
    TooLarge(usize),
}

fn check(vertices: usize, triangles: &[[u32; 3]]) -> Result<(), RepairError> {
    let largest = vertices.max(triangles.len());
    if u32::try_from(largest).is_err() {
        return Err(RepairError::TooLarge(largest));
    }
    for (triangle, t) in triangles.iter().enumerate() {
        if let Some(&index) = t.iter().find(|&&i| i as usize >= vertices) {
            return Err(RepairError::IndexOutOfRange { triangle, index, vertices });
        }
    }
    Ok(())
}
