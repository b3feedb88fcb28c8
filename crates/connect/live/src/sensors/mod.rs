//! Cameras and point clouds of a live cell: the simulated controllers avoid what they see.

mod frame_inputs;
mod guarded_program;
mod joint_history;
mod sensor_guards;

pub use frame_inputs::FrameSource;
pub(crate) use guarded_program::GuardedProgram;
pub(crate) use sensor_guards::{GuardedPrograms, SensorGuards};
