//! What a monitored robot and a cell publish, as JSON: the same document on the network, in the browser and in recordings.
//!
//! Metres, radians and seconds; poses in the world frame, quaternions as `[x, y, z, w]`. `docs/live.md` has the schema.

mod cell_status;
mod event_status;
mod robot_status;
mod status_sample;

pub use cell_status::{CellStatus, PlacedStatus, SlotStatus};
pub use event_status::EventStatus;
pub use robot_status::{HealthStatus, PointStatus, PoseStatus, RegionStatus, RobotStatus};
pub use status_sample::{SPARE_REGIONS, StatusSample};
