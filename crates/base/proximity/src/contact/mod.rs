//! Contact points: the point where two surfaces meet, its triangle, and the normals.
//!
//! | | the point |
//! | --- | --- |
//! | mesh – mesh, box, hull | on both surfaces: the middle of the longest segment in which two triangles cross |
//! | mesh – sphere, capsule, cylinder, half-space | of the mesh, deepest in the other (cylinder: nearly), and the nearest point of the other's surface |
//! | simple – simple | the witness points after the shortest [separating translation](crate::penetration()), moved back: their distance is the depth |
//! | one wholly inside the other | a point of the inner shape, and the nearest point of the outer surface |
//! | not touching, within a limit | the nearest points |
//!
//! Decisions are computed in f64 without fused operations, so the point does not depend on the instruction set.
//! Among crossings of equal length (to a billionth of the size) the smaller triangle indices win, in the same way
//! for either order of the shapes.

mod contact_point;
mod convex_convex;
mod crossing;
mod mesh_mesh;
mod mesh_polyhedron;
mod mesh_smooth;
mod placed;
mod query;
mod surface;
mod triangle_contacts;

pub use contact_point::{ContactPoint, ContactSettings, Detail};
pub use query::contact_point;
pub use triangle_contacts::{TriangleContact, for_each_triangle_contact, triangle_surface};
