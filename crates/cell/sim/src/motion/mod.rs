//! Conversion of programs to joint values over time.
//!
//! A [`MovePath`] is the path of a move, a [`Segment`] adds the time law within the joint limits, a [`ProgramPlan`]
//! joins the steps of a program, and a [`ProgramClock`] advances along it as fast as the monitor's override and the
//! joint decelerations permit.
//!
//! Defaults if model and cell file state no values: full speed in 0.25 s, full acceleration in 0.1 s, and a stop from
//! full speed in 0.1 s.

mod clock;
mod geometry;
mod grip_action;
mod instant_steps;
mod line;
mod plan;
mod planned_parts;
mod planned_paths;
mod program_plan;
mod segment;

pub use clock::ProgramClock;
pub use geometry::MovePath;
pub use grip_action::{GripAction, HeldObjects};
pub use instant_steps::RegionSwitch;
pub use line::TcpLine;
pub use plan::{first_grip, plan, repeated_plan};
pub use planned_paths::{PathSearch, PlannedPaths};
pub use program_plan::{PlanStep, ProgramPlan};
pub use segment::Segment;
