//! Simulation of the programs of a cell under the interference-region monitors.
//!
//! [`simulate`] runs the programs of a [`Cell`](elbowroom_cell::Cell) on one clock and returns a [`Recording`].
//! [`RunSummary`] and [`csv`] write the recording for scripts, `elbowroom_report` writes it for people.
//! [`check`](check::check) decides, without a run, which regions the active laws keep the robots out of; [`motion`]
//! times the programs for the run and the check.
//!
//! ```
//! use elbowroom_cell::Cell;
//! use elbowroom_sim::{RunOptions, simulate};
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! [region.end]
//! shape = "plane"
//! origin = [0, 0, 1000]
//! x = [0, 1, 1000]
//! y = [1, 0, 1000]       # its normal points down: all above z = 1000 is forbidden
//! warning = 300
//! guards = ["tcp"]
//! [program.rail]
//! steps = [{ move = "joint", to = [1500], speed = 50 }]
//! "#)?;
//! let outcome = simulate(&cell, &RunOptions::default())?;
//! assert!(!outcome.recording.robots[0].finished); // it stopped at the border
//! assert!(!outcome.has_violation());
//! # Ok::<(), elbowroom_diagnostic::Diagnostic>(())
//! ```
//!
//! **Invariant.** If [`check`](check::check) says that entry into a region is excluded, a run under the monitors never
//! enters it by more than 1 µm.

pub mod check;
pub mod csv;
mod hand;
mod held_object;
pub mod motion;
mod operator_summary;
mod playback;
mod recording;
pub mod replanning;
pub mod run;
mod starts;
mod summary;
mod virtual_robot_summary;

pub use held_object::held_object;
pub use motion::{PathSearch, PlannedPaths};
pub use operator_summary::OperatorSummary;
pub use playback::playback;
pub use recording::{
    AvoidanceSample, AvoidanceTrack, Collision, Deadlock, Evasion, EventRow, ForceSample, GoverningPoint,
    GuidanceSample, GuidanceState, GuidanceTrack, HandOverRecord, HeldPeriod, HoldReason, ObjectTrack, Outcome,
    PartKind, PathReplan, PerceptionTrack, RecordedRegionKind, Recording, RegionPoses, RegionTrack, ReplanRecord,
    RobotEnding, RobotTrack, RunEnd, RunEvent, Sample, SensorTrack, Span, Stop, TickTimes, ViewTrack,
    VirtualRobotSample, VirtualRobotTrack, WorkPieceStop,
};
pub use run::{InputFault, InputFaultKind, RunOptions, RunOutcome, SilentFrom, simulate};
pub use starts::check_starts;
pub use summary::{AvoidanceSummary, PerceptionSummary, RunSummary, SensorSummary};
pub use virtual_robot_summary::{HandOverSummary, ViewSummary, VirtualRobotSummary};
