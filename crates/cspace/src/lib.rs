//! Obstacles as blocked cells of joint space: which joint values would touch something.
//!
//! Three joints (base, shoulder, elbow) are cut into cells ([`Axis`], [`Grid`]); a [`Table`] has one bit per cell. A cell is
//! blocked if *any* configuration in its box touches, never by its middle alone (S2, "Real-time joint-space models").

mod arm;
mod axis;
mod fill;
mod grid;
mod layer;
mod obstacle;
mod table;

pub use arm::{ArmError, PlanarArm};
pub use axis::{Axis, AxisError, MOST_CELLS};
pub use fill::{FillError, Filler};
pub use grid::{Cell, Grid, TooManyCells};
pub use layer::{Layer, Span};
pub use obstacle::{Obstacle, ObstacleError};
pub use table::Table;
