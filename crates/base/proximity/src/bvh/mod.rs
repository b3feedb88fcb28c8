//! The bounding volume hierarchy (BVH) of a triangle mesh, and its traversal by one query.
//!
//! A node has 16 children, a leaf 8 triangles. For two meshes against each other, see
//! [`mesh_mesh`](crate::mesh_mesh).

// A kernel is compiled for the lowest instruction set unless it is inlined into the function that selects the set.
#![allow(clippy::inline_always)]

mod box_distance;
mod bvh16;
mod leaf_bounds;
mod least_height;
mod node;
mod node_bound;
mod ray;
mod traversal;
mod triangle_order;
mod unit_frame;

pub(crate) use box_distance::BoxDistance;
pub(crate) use bvh16::Bvh16;
pub(crate) use leaf_bounds::{box_of, most_central};
pub(crate) use least_height::LeastHeight;
pub(crate) use node::{ARITY, LEAF_SIZE, Leaf, Node};
pub(crate) use node_bound::NodeBound;
pub(crate) use ray::Ray;
pub(crate) use unit_frame::UnitFrame;
