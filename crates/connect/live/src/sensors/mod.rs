//! Cameras and point clouds of a live cell: the simulated controllers avoid what they see.

mod checked_robot;
mod frame_checks;
mod frame_inputs;
mod guarded_program;
mod joint_history;
mod path_worker;
mod robot_regions;
mod sensor_guards;
mod sensor_news;

pub(crate) use frame_checks::{check_frames, unguarded};
pub use frame_inputs::FrameInput;
pub(crate) use guarded_program::GuardedProgram;
pub(crate) use sensor_guards::{GuardedPrograms, SensorGuards};
