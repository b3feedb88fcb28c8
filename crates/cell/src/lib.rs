//! A whole cell from one file, run in simulated time.
//!
//! A cell file names robots, tools, objects, regions and programs ([`Cell::load`]; every key is in `docs/cell-file.md`).
//! [`simulate`] runs the programs under the monitor on one clock and returns a [`Recording`], which [`Summary`] and [`csv`]
//! turn into what scripts and people read.
//!
//! ```
//! use elbowroom_cell::{Cell, RunOptions, simulate};
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! [region.end]
//! shape = "plane"
//! origin = [0, 0, 1000]
//! x = [0, 1, 1000]
//! y = [1, 0, 1000]       # its normal looks down: all above z = 1000 is forbidden
//! warning = 300
//! guards = ["tcp"]
//! [program.rail]
//! steps = [{ move = "joint", to = [1500], speed = 50 }]
//! "#)?;
//! let outcome = simulate(&cell, &RunOptions::default())?;
//! assert!(!outcome.recording.robots[0].finished); // it stopped at the border
//! assert!(!outcome.bad_news());
//! # Ok::<(), elbowroom_formats::FormatError>(())
//! ```

mod cell;
pub mod check;
pub mod configure;
pub mod csv;
mod fence;
mod file;
pub mod inspect;
pub mod map;
pub mod motion;
mod mover;
pub mod plan;
mod png;
mod poses;
pub mod query;
mod recording;
pub mod report;
mod resting;
pub mod run;
pub mod seal;
mod summary;
pub mod watch;

pub use cell::{
    Action, AvoidanceSpec, Cell, CellLaws, CellRegion, CellRobot, Encoder, Follow, JointLimits, MapSpec, Program,
    ProgramBody, Step, Target, TrajectoryRow, Travel, Units,
};
pub use file::{CellFile, NumberTable};
pub use mover::{Drive, Leg, Mover, Repeat, Way};
pub use poses::PoseTrack;
pub use recording::{
    AvoidanceSample, AvoidanceTrack, Collision, Deadlock, EventRow, ObjectTrack, Outcome, Recording, RegionPoses,
    RegionTrack, RobotEnding, RobotTrack, Sample, Span, TickTimes,
};
pub use run::{InputFault, InputFaultKind, RunOptions, RunOutcome, simulate};
pub use summary::Summary;
