//! Mesh repair: weld vertices, orient faces consistently, split into connected components.
//!
//! [`TriMesh`](crate::TriMesh) accepts triangles as they are and reports on them. The functions of this module
//! change triangles, and report what they changed.
//!
//! ```
//! use elbowroom_proximity::TriMesh;
//! use elbowroom_proximity::repair::{orient, weld};
//! use elbowroom_spatial::Vec3;
//! // A tetrahedron as in an STL file: every triangle has its own corners, one of them a little off, and one face is reversed.
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

mod components;
mod error;
mod orient;
mod shells;
mod weld;

pub(crate) use shells::Shells;

pub use components::{Component, split_components};
pub use error::RepairError;
pub use orient::{OrientReport, Oriented, orient};
pub use weld::{WeldReport, Welded, merge_targets, weld};
