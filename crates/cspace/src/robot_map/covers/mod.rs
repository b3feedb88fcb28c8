//! Maps of three joints on sphere covers, in milliseconds.
//!
//! The joint nearest the base carries all that the map moves. Its cells are lanes: for a box of values of the two other
//! joints, sixteen of its cells are tested at a time, and only the obstacle turns. Where a sphere of the robot is, seen from
//! that joint, depends on the two other joints alone and is the same for all obstacles.
//!
//! A box is free of a sphere if a plane separates the sphere from the obstacle in the whole box (`kernel.rs`). Boxes that are
//! neither free nor blocked are halved along all axes, down to single cells.
//!
//! | file | contents |
//! | --- | --- |
//! | `builder.rs` | [`CoverMapBuilder`]: all of it together |
//! | `axis_roles.rs` | the axis in lanes, the two others, and how many cells of each differ |
//! | `step_chain.rs`, `cover_class.rs`, `ball_tree.rs` | the moving joints; covers of the links and their motion |
//! | `block_level.rs` | boxes of one size, and where the joints are at their centres |
//! | `obstacle.rs`, `solid_core.rs`, `obstacle_lanes.rs` | obstacles; distances from them; an obstacle seen from sixteen cells |
//! | `filler.rs`, `group_test.rs`, `witnesses.rs` | boxes halved; one box; balls that blocked others |
//! | `kernel.rs`, `place_memo.rs` | sixteen balls at a time; places that are known |
//! | `planar_filler.rs` | arms in a plane with round links, which have a faster filler |
//! | `settlement.rs` | cells that the covers leave open, by exact queries |
//! | `cell_bits.rs` | blocked cells as bits |

mod axis_roles;
mod ball_tree;
mod block_level;
mod builder;
mod cell_bits;
mod cover_class;
mod filler;
mod group_test;
mod kernel;
mod obstacle;
mod obstacle_lanes;
mod place_memo;
mod planar_filler;
mod settlement;
mod solid_core;
mod step_chain;
mod witnesses;

pub use builder::{CoverMapBuilder, CoverMapSettings};
pub use obstacle::CoverObstacle;
