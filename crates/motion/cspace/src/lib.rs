//! Obstacles in configuration space: the joint values at which a robot is in collision.
//!
//! Joints are divided into cells ([`GridAxis`], [`Grid`]); an [`OccupancyBitmap`] has one bit per cell of three joints
//! (base, shoulder, elbow). A cell is blocked if *any* configuration in its box is in collision; testing only its
//! centre would not be enough (the joint-space paper, `docs/references.md`).
//!
//! Three builders compute blocked cells:
//!
//! | | [`PlanarMapBuilder`], [`JointMap`] | [`CoverMapBuilder`] | [`RobotMapBuilder`] |
//! | --- | --- | --- | --- |
//! | robot | two capsules and a sphere ([`PlanarArm`]) | any links and solids, 3 joints | the same, 1 to 8 joints |
//! | obstacles | convex | any: meshes, floors | any: meshes, floors |
//! | time, 2 degrees | hundredths of a millisecond | milliseconds | tenths of a second |
//! | result | spans of rows ([`Layer`]) | spans of rows ([`Layer`]) | a tree of boxes ([`BoxTree`]) |
//!
//! ```
//! use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, JointMap, PlanarArm};
//! use elbowroom_spatial::Vec3;
//! let axis = |name: &str, min, max| GridAxis::from_degrees(name, min, max, 2.0);
//! let grid = Grid::new([axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?])?;
//! let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
//! let mut reader = map.reader(); // for the thread that plans
//! let entered = map.set_obstacle("head", &ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?);
//! assert!(entered.blocked() > 50_000);
//! assert!(map.is_blocked([0.3, 0.7, 0.5])); // the wrist is in the sphere
//! assert!(!map.is_blocked([2.0, 0.7, 0.5]));
//! assert!(map.is_blocked([4.0, 0.7, 0.5])); // beyond the limits
//! map.publish();
//! assert_eq!(reader.latest().blocked(), map.occupancy().blocked());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`NearestNeighbours`] searches among configurations, for planners.
//!
//! **Invariant.** For the robot model and the obstacles from which a builder made a layer, a free cell never contains a
//! configuration that collides with them. A configuration outside the grid always counts as blocked.

mod bits;
mod cell_changes;
mod convex_obstacle;
mod cuboid;
mod grid;
mod grid_axis;
mod joint_map;
mod layer;
mod layer_map;
mod map_reader;
mod nearest_neighbours;
mod npy;
mod obstacle_model;
mod occupancy_bitmap;
mod planar_arm;
mod planar_map;
mod robot_map;
mod seed_expansion;
mod sphere_lattice;

pub use cell_changes::CellChanges;
pub use convex_obstacle::{ConvexObstacle, ConvexObstacleError};
pub use grid::{CellIndex, Grid, TooManyCells};
pub use grid_axis::{AxisParameter, GridAxis, GridAxisError};
pub use joint_map::JointMap;
pub use layer::{Layer, RowSpan};
pub use layer_map::LayerMap;
pub use map_reader::{MapReader, MapSnapshot};
pub use nearest_neighbours::NearestNeighbours;
pub use obstacle_model::{ObstacleModel, UnknownObstacleModel, spheres_until};
pub use occupancy_bitmap::OccupancyBitmap;
pub use planar_arm::{ArmDimension, ArmError, PlanarArm};
pub use planar_map::{PlanarMapBuilder, PlanarMapError};
pub use robot_map::{
    BoxTree, CellBox, CoverMapBuilder, CoverMapSettings, CoverObstacle, MAX_JOINTS, OccupancyArray, RemainingJoints,
    RobotMapBuilder, RobotMapError, RobotMapSettings, RobotMapStats, SphereRefinement,
};
pub use seed_expansion::{SeedExpansion, expand_from_seeds};
