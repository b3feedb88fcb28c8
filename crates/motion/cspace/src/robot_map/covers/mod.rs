//! Maps of three joints on sphere covers, in milliseconds.
//!
//! The joint nearest the base carries all that the map moves. Boxes of joint space that differ in its value alone are worked on
//! sixteen at a time, as the bits of a word: its axis is the one "in lanes". Where a sphere of the robot is, seen from that
//! joint, depends on the two other joints alone, and is computed once for all of them; only the obstacle turns.
//!
//! A box is free of a sphere if a plane separates the sphere from the obstacle in the whole box; sixteen spheres of a group are
//! tested at a time (`kernel.rs`). Boxes that are neither free nor blocked are halved along all axes, down to single cells.
//!
//! | file | contents |
//! | --- | --- |
//! | `builder.rs` | [`CoverMapBuilder`]: all of it together |
//! | `axis_roles.rs` | the axis in lanes, the two others, and how many cells of each differ |
//! | `step_chain.rs`, `cover_class.rs`, `ball_tree.rs` | the moving joints; covers of the links and their motion |
//! | `block_level.rs` | boxes of one size, and where the joints are at their centres |
//! | `obstacle.rs`, `solid_core.rs`, `obstacle_lanes.rs` | obstacles; distances from them; an obstacle seen from sixteen cells |
//! | `box_division.rs`, `group_test.rs`, `witnesses.rs` | boxes halved; one box; balls that blocked others |
//! | `kernel.rs`, `place_memo.rs` | sixteen balls at a time; places that are known |
//! | `slice_map.rs`, `slice_kernel.rs` | one slice, copied over the first joint |
//! | `seeds.rs` | where links are nearest to an obstacle, for the expansion from seeds |
//! | `planar_arm_map.rs` | arms in a plane with round links, which have a faster way |
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
