//! Interference regions, checked every control tick (Romanelli 2011).
//!
//! An **interference region** is a solid that a robot must not enter ([`RegionKind::Forbidden`]), that it reports
//! ([`RegionKind::Monitored`]) or that it shares with other robots ([`RegionKind::Exchange`]). A **warning zone** surrounds
//! it; there the speed override falls with the distance. In every control tick a [`Monitor`] computes the largest
//! speed override that the laws allow, and its reason, from **virtual TCPs**: for each region the closest point of
//! the guarded volumes.
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
//!         grids: vec![],
//!         laws: Laws::default(),
//!         chain,
//!     })?,
//!     None,
//! )?;
//! let report = monitor.tick(&Snapshot::stationary(0.0, &[1.4]));
//! assert!((report.speed_override - 0.5).abs() < 1e-12); // 0.1 m left of a 0.2 m warning zone
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! This is not a certified safety device.
//!
//! **Invariant.** Under any input, a tick never allocates, locks or panics. If the input is stale, out of order, not
//! finite or implausible, the override is always 0, with an [`OverrideReason`].

// Unit tests share the robots of the integration tests.
#[cfg(test)]
#[path = "../tests/common/mod.rs"]
mod common;
#[cfg(test)]
extern crate self as elbowroom_monitor;

mod attached_volumes;
mod braking_check;
mod broad_phase;
mod carried_volume;
mod checksum;
mod configuration;
mod configuration_edit;
mod continued_monitor;
mod decision;
mod distance_to_guarded;
mod event;
mod grid;
mod grid_states;
mod guarded_monitor;
pub mod laws;
mod monitor;
mod monitor_queries;
mod override_history;
mod override_law;
mod placement;
mod point_motion;
mod recovery;
mod region;
mod region_approach;
mod region_clearance;
mod region_clearances;
mod region_distance_query;
mod region_groups;
mod region_neighbours;
mod region_state;
mod region_states;
mod region_sweep;
mod report;
mod rounded_box;
mod snapshot;
mod source_check;
mod source_limits;
mod stopping;
mod switch_error;
mod taught_points;
pub mod teach;
mod tick_context;
mod unchanged_reading;
mod volume;
mod volume_region_pair;
mod volume_travel;
mod warm_start_cache;
mod watchdog;
mod zone_client;
mod zone_state;

pub use attached_volumes::AttachError;
pub use configuration::{ConfigError, Configuration, ConfigurationParts};
pub use configuration_edit::{ConfigurationEdit, EditError};
pub use continued_monitor::same_regions;
pub use elbowroom_interlock::{
    AccessClass, ExchangeState, Grant, Interlock, Occupancy, RobotSet, RobotSlot, SlotGrants, SlotId, WaitForGraph,
    ZoneArbiter,
};
pub use elbowroom_proximity::VolumeModel;
pub use event::{Event, EventKind};
pub use grid::{GridSpace, OutputGrid, OutputGridAxis};
pub use guarded_monitor::{GuardedMonitor, NotObeyed};
pub use laws::{Laws, StoppingSettings};
pub use monitor::Monitor;
pub use region::{Guards, Life, Region, RegionId, RegionKind, SourceId, VolumeId};
pub use region_distance_query::RegionDistanceQuery;
pub use region_groups::group_overlapping;
pub use region_sweep::{ClosestApproach, RegionSweep};
pub use report::{Fault, NamedReason, OverrideReason, TickReport, VirtualTcp};
pub use snapshot::{Snapshot, SourceState};
pub use source_limits::{SourceLimits, SourceSpec};
pub use switch_error::SwitchError;
pub use volume::{Part, Presence, Volume, arm_volumes};
