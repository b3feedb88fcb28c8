//! The bounding volume hierarchy (BVH) of a triangle mesh: 16 children per node, 8 triangles per leaf, and its traversal by
//! one query. Two meshes against each other: [`mesh_mesh`](crate::mesh_mesh).

// A kernel that is not inlined into the function its instruction set is chosen for is compiled for the lowest one.
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
