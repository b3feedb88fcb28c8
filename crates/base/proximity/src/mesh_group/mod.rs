//! Two groups of meshes, such as the links of two arms: whether any mesh of one touches any of the other.
//!
//! Most pairs are settled without their triangles: bounding spheres and capsules of all pairs are compared sixteen at a time,
//! and of what is left, sixteen spheres inside each solid prove collisions.

// A kernel that is not inlined into the function its instruction set is chosen for is compiled for the lowest one.
#![allow(clippy::inline_always)]

mod capsule_row;
mod group;
mod group_frame;
mod interior_spheres;
mod sphere_row;

pub use group::{GroupWorkspace, MeshGroup};
