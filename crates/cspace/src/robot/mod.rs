//! Maps of any robot: exact solids, any number of joints, proven cell by cell.
//!
//! A box of joint space is free if no part of the robot is nearer to anything, at the middle of the box, than it can move
//! within the box. Boxes that are not proven free are cut in two, down to single cells and, at the border, below them:
//! the cost grows with the surface of what is blocked, not with the number of cells.
//!
//! | file | what |
//! | --- | --- |
//! | `joints.rs` | which joints, how links hang on them |
//! | `part.rs`, `pieces.rs` | the robot in small pieces, each with the joints that move it |
//! | `swept.rs` | what joints that are not of the map can sweep |
//! | `pace.rs` | how far a piece moves within a box of joint space |
//! | `target.rs`, `stand_in.rs` | what stands around, and simpler solids in its place |
//! | `search.rs`, `border.rs`, `look.rs` | boxes cut in two; cells looked at closely; one pair |
//! | `blocks.rs`, `dense.rs` | the answer: a tree of boxes, or byte by byte |
//! | `filler.rs` | all of it together, on threads |

mod blocks;
mod border;
mod dense;
mod filler;
mod joints;
mod look;
mod pace;
mod part;
mod pieces;
mod search;
mod stand_in;
mod swept;
mod target;

pub use blocks::{Block, Blocks};
pub use dense::Dense;
pub use filler::{FillCounts, RobotFiller};
pub use joints::{MOST_JOINTS, Others, RobotMapError};
