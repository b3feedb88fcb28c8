//! Errors of starting and ending a service.

use elbowroom_formats::Diagnostic;
use elbowroom_recording::BagError;
use elbowroom_view::ViewError;
use thiserror::Error;

use crate::control::ControlError;
use crate::network::NetworkError;
use crate::ros2::Ros2Error;

/// Why a service does not start.
#[derive(Debug, Error)]
pub enum ServiceError {
    /// The cell cannot be guarded.
    #[error(transparent)]
    Cell(#[from] Diagnostic),
    /// The network cannot be used.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The page cannot be served.
    #[error("--web: {0}")]
    Web(#[from] ViewError),
    /// The control interface cannot be served.
    #[error("--control: {0}")]
    Control(#[from] ControlError),
    /// A process without the arbiter cannot serve the control interface.
    #[error(
        "--control: this process does not have the arbiter\n  help: live CELL --arbiter --control ADDR, or the whole cell in one process"
    )]
    ControlWithoutArbiter,
    /// The recording cannot be written.
    #[error("--record: {0}")]
    Recording(#[from] BagError),
    /// The ROS 2 connection cannot be made as requested.
    #[error(transparent)]
    Ros2(#[from] Ros2Error),
    /// Another process guards the robot.
    #[error(
        "robot {name}: another process guards it already\n  help: end that one before; two of them would answer its controller, and ask for its exchange regions, one against the other"
    )]
    GuardedAlready {
        /// Name of the robot.
        name: String,
    },
    /// A robot that the cell does not have.
    #[error("--robots {name}: no robot of the cell has this name\n  help: one of {}", known.join(", "))]
    Robot {
        /// The unknown name.
        name: String,
        /// Names of the cell's robots.
        known: Vec<String>,
    },
    /// Pictures that nobody can use.
    #[error("--frames {sensor}: {why}")]
    Frames {
        /// The name of the sensor.
        sensor: String,
        /// What is wrong, and what to write instead.
        why: String,
    },
    /// The system does not start a thread.
    #[error("a thread cannot be started: {0}")]
    Thread(std::io::Error),
}
