//! Interference regions, checked every control tick (S1).
//!
//! An **interference region** is a solid that a robot must not enter ([`Kind::Forbidden`]), that it reports
//! ([`Kind::Monitored`]) or that it shares with others ([`Kind::Exchange`]). Around it lies a **warning zone** in which
//! the speed override falls with the distance. A [`Monitor`] answers one question per control tick: how fast may this
//! robot go now, and why. It works on **virtual TCPs**: for each region the closest point of the guarded volume.
//!
//! ```
//! use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
//! use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Laws, Monitor, Region, Snapshot, Volume};
//! use elbowroom_spatial::{Pose, Vec3};
//!
//! // A linear axis along x that carries a TCP.
//! let rail = Joint {
//!     name: "rail".into(),
//!     kind: JointKind::Prismatic,
//!     parent: LinkId(0),
//!     child: LinkId(1),
//!     origin: Pose::IDENTITY,
//!     axis: Vec3::X,
//!     limits: Limits::range(0.0, 2.0),
//!     mimic: None,
//! };
//! let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
//! let mut monitor = Monitor::new(
//!     Configuration::new(ConfigurationParts {
//!         robot: "rail".into(),
//!         base_in_world: Pose::IDENTITY,
//!         volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)],
//!         regions: vec![Region::sphere("pillar", Vec3::X * 2.0, 0.5).warning(0.2).guards(Guards::TCP)],
//!         sources: vec![],
//!         laws: Laws::default(),
//!         chain,
//!     })?,
//!     None,
//! )?;
//! let report = monitor.tick(&Snapshot::still(0.0, &[1.4]));
//! assert!((report.speed_override - 0.5).abs() < 1e-12); // 0.1 m left of a 0.2 m warning zone
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The tick neither allocates, nor locks, nor panics; input that is stale, out of order, not a number or implausible
//! is override 0 with a [`Reason`]. This is not a certified safety device.

mod access;
mod bound;
mod brake_watch;
mod broad;
mod checksum;
mod commands;
mod config;
mod events;
mod gaps;
mod gauge;
mod interlock;
pub mod laws;
mod monitor;
mod placement;
mod presence;
mod recovery;
mod region;
mod report;
mod seat;
mod snapshot;
mod source_watch;
mod stopping;
mod sweep;
pub mod teach;
mod verdict;
mod volume;
mod watchdog;
mod witness;

pub use access::{AccessClass, Edit, EditError, SwitchError};
pub use config::{ConfigError, Configuration, ConfigurationParts};
pub use events::{Event, EventKind};
pub use gauge::Gauge;
pub use interlock::{Board, Grant, RobotSlot, SlotId, Stay, group_overlapping};
pub use laws::{Laws, Stopping};
pub use monitor::Monitor;
pub use region::{Guards, Kind, Life, Region, RegionId, SourceId};
pub use report::{Fault, Reason, TickReport, VirtualTcp};
pub use seat::ExchangeState;
pub use snapshot::{Snapshot, Source};
pub use source_watch::{SourceLimits, SourceSpec};
pub use sweep::{Least, Sweep};
pub use volume::{Part, Volume, VolumeModel, arm_volumes};
