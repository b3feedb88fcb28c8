//! Obstacles as blocked cells of joint space: which joint values would touch something.
//!
//! Three joints (base, shoulder, elbow) are cut into cells ([`Axis`], [`Grid`]); a [`Table`] has one bit per cell. A cell is
//! blocked if *any* configuration in its box touches, never by its middle alone (S2, "Real-time joint-space models").
//!
//! Two ways to fill them:
//!
//! | | [`Filler`], [`JointMap`] | [`RobotFiller`] |
//! | --- | --- | --- |
//! | robot | two capsules and a sphere in a plane ([`PlanarArm`]) | any chain of links, any solids, 1 to 8 joints |
//! | obstacles | convex | any: meshes, floors |
//! | time, 2 degrees | some hundredths of a millisecond | tenths of a second |
//! | answer | rows of intervals ([`Layer`]) | a tree of boxes ([`Blocks`]) |

mod arm;
mod axis;
mod changes;
mod fill;
mod grid;
mod layer;
mod layer_map;
mod map;
mod model;
mod npy;
mod obstacle;
mod reader;
mod robot;
mod seed;
mod signs;
mod table;

pub use arm::{ArmError, PlanarArm};
pub use axis::{Axis, AxisError, MOST_CELLS};
pub use changes::Changes;
pub use fill::{FillError, Filler};
pub use grid::{Cell, Grid, TooManyCells};
pub use layer::{Layer, Span};
pub use layer_map::LayerMap;
pub use map::JointMap;
pub use model::{Model, UnknownModel, spheres_until};
pub use obstacle::{Obstacle, ObstacleError};
pub use reader::{Reader, Snapshot};
pub use robot::{Block, Blocks, Dense, FillCounts, MOST_JOINTS, Others, RobotFiller, RobotMapError};
pub use seed::{Expansion, expand};
pub use signs::JointSigns;
pub use table::Table;
