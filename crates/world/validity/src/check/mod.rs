//! Checks of states and edges of a robot among obstacles.

mod block;
mod block_request;
mod boxes;
mod checker;
mod hits;
mod joint_stretch;
mod motion_table;
#[cfg(test)]
mod motion_tests;
mod node_obstacles;
mod pair_table_builder;
mod placed_centres;
mod segment;
mod several_edges;
mod single;
#[cfg(test)]
mod single_tests;
mod single_workspace;
mod workspace;

pub use checker::{NotCertain, ValidityChecker};
pub use several_edges::EDGES_AT_ONCE;
