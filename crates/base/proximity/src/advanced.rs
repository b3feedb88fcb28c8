//! Specialist queries on two triangle meshes: triangle pairs, statistics, upper bounds, levels of detail.
//!
//! These queries use [`TriMesh`](crate::TriMesh) instead of [`Shape`](crate::Shape), and a
//! [`Workspace`](crate::Workspace). Most users do not need them:
//! [`Workspace::separation`](crate::Workspace::separation) accepts a limit and a warm start for any two shapes.
//!
//! | how do I … | |
//! | --- | --- |
//! | find the nearest two triangles | [`mesh_separation_with`], then [`Workspace::closest_features`](crate::Workspace::closest_features) |
//! | find one or all pairs of triangles that touch | [`colliding_triangles`], [`for_each_contact`] |
//! | find a pair of triangles within a tolerance | [`triangles_within`], [`is_farther_than`] |
//! | find every local minimum of the distance of two surfaces | [`for_each_local_minimum`] |
//! | get an upper bound of the distance first | [`distance_upper_bound`] |
//! | choose which of many pairs of meshes to measure first | [`Landmarks`] |
//! | bound the distance by the boxes of the BVH alone | [`bvh_lower_bound`], [`bvh_lower_bound_to_shape`] |
//! | ask whether any of several meshes touches any of others, such as two arms | [`MeshGroup`] |
//! | count the nodes and triangles visited | [`Workspace::stats`](crate::Workspace::stats) |

pub use crate::mesh_group::{GroupWorkspace, MeshGroup};
pub use crate::mesh_mesh::{
    BvhBound, Landmarks, LocalMinimum, MeshFeatures, NormalConeHierarchy, PlacedLandmarks, bvh_lower_bound,
    bvh_lower_bound_to_shape, colliding_triangles, distance_upper_bound, for_each_contact, for_each_local_minimum,
    is_farther_than, mesh_separation, mesh_separation_with, triangles_within,
};
