//! Queries on two triangle meshes: simultaneous traversal of their trees, with tests of sixteen boxes. See README.md
//! in this folder.

// A kernel is compiled for the lowest instruction set unless it is inlined into the function that selects the set.
#![allow(clippy::inline_always)]

mod bvh_bound;
mod collision;
mod containment;
mod continuous_witness;
mod cutoff;
mod distance;
#[cfg(test)]
mod f32_bounds_tests;
mod facing_kernel;
mod gilbert;
mod landmark_descent;
mod landmarks;
mod leaf_kernel;
mod leaf_pairs;
mod local_minima;
mod mesh_features;
mod mesh_pair;
mod nearest_directions;
mod nearest_pair;
mod nearest_pair_search;
mod node_kernel;
mod node_pair;
mod normal_cones;
mod relative_placement;
mod surface_patch;
mod triangle_batch;
mod triangle_kernel;
mod vertex_faces;
mod warm_start;
mod workspace;

pub use bvh_bound::{BvhBound, bvh_lower_bound, bvh_lower_bound_to_shape};
pub use collision::{colliding_triangles, for_each_contact};
pub(crate) use distance::{EXPECT_FAR, EXPECT_NEAR, features_within};
pub use distance::{distance_upper_bound, is_farther_than, mesh_separation, mesh_separation_with, triangles_within};
pub use landmarks::{Landmarks, PlacedLandmarks};
pub use local_minima::{LocalMinimum, for_each_local_minimum};
pub use mesh_features::MeshFeatures;
pub(crate) use nearest_pair_search::FirstBound;
pub use normal_cones::NormalConeHierarchy;
pub use warm_start::WarmStart;
pub(crate) use workspace::with_thread_workspace;
pub use workspace::{QueryStats, Workspace};
