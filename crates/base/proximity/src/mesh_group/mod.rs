//! Two groups of meshes, such as the links of two arms, and the query whether any mesh of one touches any mesh of
//! the other.
//!
//! Most pairs are decided without their triangles. Bounding spheres and capsules of all pairs are compared sixteen
//! at a time; for the remaining pairs, sixteen spheres inside each solid prove collisions.

// A kernel is compiled for the lowest instruction set unless it is inlined into the function that selects the set.
#![allow(clippy::inline_always)]

mod capsule_row;
mod group;
mod group_frame;
mod interior_spheres;
mod sphere_row;

pub use group::{GroupWorkspace, MeshGroup};
