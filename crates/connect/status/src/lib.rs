//! Status of a monitored robot and of a cell, as JSON: the same document on the network, in the browser and in recordings.
//!
//! Metres, radians and seconds; poses in the world frame, quaternions as `[x, y, z, w]`. `docs/live.md` has the schema.
//!
//! ```
//! use elbowroom_status::{CellStatus, EventStatus, RobotStatus};
//! let rail = RobotStatus {
//!     robot: "rail".into(),
//!     q: vec![0.5],
//!     speed_override: 0.25,
//!     reason: "region \"column\" is near".into(),
//!     region: Some("column".into()),
//!     ..RobotStatus::default()
//! };
//! let warned = EventStatus { t_s: 1.5, robot: "rail".into(), region: "column".into(), event: "warned".into() };
//! let status = CellStatus { t_s: 1.5, robots: vec![rail], events: vec![warned], ..CellStatus::default() };
//! let json = serde_json::to_value(&status)?;
//! assert_eq!(json["robots"][0]["override"], 0.25);
//! assert_eq!(json["events"][0]["region"], "column");
//! assert_eq!(serde_json::from_value::<CellStatus>(json)?, status);
//! # Ok::<(), serde_json::Error>(())
//! ```
//!
//! **Invariant.** Once a [`StatusSample`] has been made for a monitor, filling it after a tick never allocates, as
//! long as at most [`SPARE_REGIONS`] regions are added.

mod cell_status;
mod event_status;
mod robot_status;
mod status_sample;

pub use cell_status::{CellStatus, PlacedStatus, SlotStatus};
pub use event_status::EventStatus;
pub use robot_status::{HealthStatus, PointStatus, PoseStatus, RegionStatus, RobotStatus, ServiceStatus};
pub use status_sample::{SPARE_REGIONS, StatusSample};
