//! MCAP recordings of a cell: writer, reader and replay.
//!
//! [`RunRecorder`] records a simulated run, [`Recorder`] a live service. A recording has the profile `ros2`: Foxglove,
//! Rerun and the tools of ROS 2 read it. It also has the configuration and the input of every monitor, bit by bit, so
//! that [`replay`] runs the monitors again and compares their answers. `docs/recordings.md` lists the topics.
//!
//! ```
//! use elbowroom_cell::Cell;
//! use elbowroom_recording::{CellWriter, RunRecorder, replay};
//! use elbowroom_sim::{PlannedPaths, RunOptions, run::simulate_observed};
//! let cell = Cell::parse("rail.toml", r#"
//! version = 1
//! units = { length = "mm", angle = "deg" }
//! [robot.rail]
//! dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
//! [program.rail]
//! steps = [{ move = "joint", to = [1500], speed = 50 }]
//! "#)?;
//! let mut file = std::io::Cursor::new(Vec::new());
//! let mut recorder = RunRecorder::new(CellWriter::new(&mut file, &cell, 0)?, &cell);
//! simulate_observed(&PlannedPaths::new(&cell), &RunOptions::default(), &mut |_| {}, Some(&mut recorder))?;
//! recorder.finish()?;
//! let found = replay(&file.into_inner()[..])?;
//! assert!(found.ticks > 1000 && found.differences == 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** If the same version of the program replays a recording, every monitor always gives the recorded
//! answers to the bit, up to the first tick that the recording lacks or the first change of its regions.

mod bag_reader;
mod bag_writer;
mod cell_writer;
mod configuration;
mod configuration_defect;
mod damage;
mod error;
mod joint_recording;
mod recorder;
mod records;
mod replay;
mod replay_result;
mod replayed_monitor;
mod run_recorder;
mod solid;
mod tick;
mod tick_writer;
mod topics;

pub use bag_reader::{BagMessage, BagReader};
pub use cell_writer::CellWriter;
pub use configuration_defect::ConfigurationDefect;
pub use damage::Damage;
pub use error::{BagError, TickDefect};
pub use joint_recording::JointRecording;
pub use recorder::{Recorder, TickRecorder};
pub use replay::replay;
pub use replay_result::{Difference, Replay, RobotReplay};
pub use run_recorder::RunRecorder;
