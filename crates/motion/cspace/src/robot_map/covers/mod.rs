//! Maps of three joints on sphere covers, in milliseconds.
//!
//! The joint nearest the base carries all links that the map moves. Boxes of joint space that differ only in its value
//! are processed sixteen at a time, as the bits of a word: its axis is called "the axis in lanes". The position of a
//! sphere of the robot relative to that joint depends only on the two other joints and is computed once for all of
//! these boxes; only the obstacle turns.
//!
//! A box is free of a sphere if a plane separates the sphere from the obstacle in the whole box; sixteen spheres of a
//! group are tested at the same time (`kernel.rs`). Boxes that are neither free nor blocked are halved along all axes,
//! down to single cells.
//!
//! | file | contents |
//! | --- | --- |
//! | `builder.rs` | [`CoverMapBuilder`]: the whole process |
//! | `axis_roles.rs` | the axis in lanes, the two other axes, and the number of different cells of each |
//! | `step_chain.rs`, `cover_class.rs`, `ball_tree.rs` | the moving joints; covers of the links and their motion |
//! | `block_level.rs` | boxes of one size, and the frames of the joints at their centres |
//! | `obstacle.rs`, `solid_core.rs`, `obstacle_lanes.rs` | obstacles; distances from them; an obstacle seen from sixteen cells |
//! | `box_division.rs`, `group_test.rs`, `witnesses.rs` | boxes halved; one box; balls that blocked other cells |
//! | `kernel.rs`, `place_memo.rs` | sixteen balls at a time; known places |
//! | `slice_map.rs`, `slice_kernel.rs` | one slice, copied over the first joint |
//! | `seeds.rs` | cells at which links are nearest to an obstacle, for the expansion from seeds |
//! | `planar_arm_map.rs` | a faster method for arms in a plane with round links |
//! | `cell_bits.rs` | blocked cells as bits |

mod axis_roles;
mod ball_tree;
mod block_level;
mod box_division;
mod builder;
mod cell_bits;
mod cover_class;
mod group_test;
mod kernel;
mod obstacle;
mod obstacle_lanes;
mod place_memo;
mod planar_arm_map;
mod seeds;
mod slice_kernel;
mod slice_map;
mod solid_core;
mod step_chain;
mod witnesses;

pub use builder::{CoverMapBuilder, CoverMapSettings};
pub use obstacle::CoverObstacle;
