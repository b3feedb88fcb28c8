//! Maps of any robot: exact solids, any number of joints, proven cell by cell.
//!
//! A box of joint space is free if, at the centre of the box, every part of the robot is farther from the obstacles
//! than it can move within the box. Boxes that are not proven free are bisected, down to single cells and, at the
//! boundary, below them. The cost therefore grows with the surface of the blocked region, not with the number of cells.
//!
//! | file | contents |
//! | --- | --- |
//! | `builder.rs`, `settings.rs`, `error.rs` | [`RobotMapBuilder`]: the whole process, on threads |
//! | `driven_chain.rs` | the joints that are axes of the map, and the axes that move each link |
//! | `rigid_groups.rs`, `robot_pieces.rs`, `solid_pieces.rs`, `triangle_soup.rs` | the robot in small pieces with their joints |
//! | `enclosure.rs` | solids swept by joints that are not axes of the map |
//! | `motion_bound.rs` | bound of the motion of a piece within a box of joint space |
//! | `placed_obstacle.rs`, `obstacle_solids.rs`, `sector_bounds.rs` | obstacles, and simpler solids that replace them |
//! | `subdivision.rs`, `pair_evaluator.rs`, `cell_contact.rs`, `pair_distance.rs` | bisected boxes; pairs in a box; cells at the boundary; one pair |
//! | `sphere_refinement.rs` | spheres that replace an obstacle, until a deadline |
//! | `covers/` | maps on sphere covers, in real time |
//! | `box_tree.rs`, `occupancy_array.rs` | the map as a tree of boxes, or one byte per cell |

mod box_tree;
mod box_tree_intersection;
mod builder;
mod cell_contact;
mod covers;
mod driven_chain;
mod enclosure;
mod error;
mod motion_bound;
mod obstacle_solids;
mod occupancy_array;
mod pair_distance;
mod pair_evaluator;
mod placed_obstacle;
mod rigid_groups;
mod robot_pieces;
mod sector_bounds;
mod settings;
mod solid_pieces;
mod sphere_refinement;
mod subdivision;
mod triangle_soup;

pub use box_tree::{BoxTree, CellBox};
pub use builder::RobotMapBuilder;
pub use covers::{CoverMapBuilder, CoverMapSettings, CoverObstacle};
pub use driven_chain::RemainingJoints;
pub use error::RobotMapError;
pub use occupancy_array::OccupancyArray;
pub use settings::{MAX_JOINTS, RobotMapSettings, RobotMapStats};
pub use sphere_refinement::SphereRefinement;
