//! Errors of writing and reading a recording.

use std::path::PathBuf;

use elbowroom_monitor::{AttachError, SwitchError};

use crate::{ConfigurationDefect, Damage};

/// Why a recording cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum BagError {
    /// Error of the file system.
    #[error("{}: {source}", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// An existing file of other origin would be overwritten.
    #[error("{}: is there already\n  write: the name of a recording that is not there yet, beside which there is no URDF of that name", .0.display())]
    Exists(PathBuf),
    /// A record cannot be written.
    #[error("the recording cannot be written: {0}{help}", help = instead(.0))]
    Write(mcap::McapError),
    /// The file is not an MCAP file.
    #[error(
        "is not an MCAP file: it does not begin with the bytes 89 M C A P 30\n  help: a file that `elbowroom run --mcap`, `elbowroom live --record` or `ros2 bag record -s mcap` wrote"
    )]
    Foreign,
    /// The bytes of the file are damaged.
    #[error("is damaged behind message {messages}: {source}")]
    Damaged {
        /// Number of messages that could be read before.
        messages: u64,
        /// The reason.
        source: Damage,
    },
    /// A message is not of its channel's type.
    #[error(
        "message {message} on {topic} is not a {what}: {source}\n  write: a recording of this version of elbowroom"
    )]
    Message {
        /// Number of the message in the file, from 0.
        message: u64,
        /// Its topic.
        topic: String,
        /// The type of the topic.
        what: &'static str,
        /// The reason.
        source: elbowroom_ros2::CdrError,
    },
    /// The file has nothing to replay.
    #[error(
        "has no ticks of a monitor ({messages} messages of other kinds)\n  help: a file that `elbowroom run --mcap` or `elbowroom live --record` wrote"
    )]
    NothingToReplay {
        /// Messages in the file.
        messages: u64,
    },
    /// The file has no joint states on the topic.
    #[error("has no sensor_msgs/msg/JointState on {}\n  help: {}", wanted.as_deref().unwrap_or("any topic"), topics(found))]
    NoJointStates {
        /// The requested topic.
        wanted: Option<String>,
        /// Topics that have joint states.
        found: Vec<String>,
    },
    /// Several topics have joint states.
    #[error("has joint states on several topics\n  help: {}", topics(found))]
    SeveralTopics {
        /// The topics.
        found: Vec<String>,
    },
    /// The number of positions differs from the number of names.
    #[error("message {message} on {topic} has {names} names and {positions} positions")]
    JointStateLength {
        /// Number of the message in the file, from 0.
        message: u64,
        /// Its topic.
        topic: String,
        /// Number of names.
        names: usize,
        /// Number of positions.
        positions: usize,
    },
    /// A recorded configuration cannot be built.
    #[error("the configuration of robot {robot} is not valid: {source}")]
    Configuration {
        /// The robot.
        robot: String,
        /// The reason.
        source: ConfigurationDefect,
    },
    /// A recorded tick does not fit its configuration.
    #[error("tick {sequence} of robot {robot}: {source}")]
    Tick {
        /// The robot.
        robot: String,
        /// The number of the tick.
        sequence: u64,
        /// The reason.
        source: TickDefect,
    },
}

/// Why a recorded tick does not fit its configuration.
#[derive(Debug, thiserror::Error)]
pub enum TickDefect {
    /// The recording has no configuration of the robot.
    #[error("no configuration of the robot comes before it")]
    NoConfiguration,
    /// The configuration has no region with this index.
    #[error("region {0} was switched, and there is none")]
    NoRegion(usize),
    /// The monitor does not switch the region.
    #[error(transparent)]
    Switch(#[from] SwitchError),
    /// The pose of an attached volume is not valid.
    #[error("a volume was attached at a pose that is none")]
    Pose,
    /// The monitor does not attach or detach the volume.
    #[error(transparent)]
    Attach(#[from] AttachError),
}

fn topics(found: &[String]) -> String {
    match found {
        [] => "`ros2 bag record -s mcap /joint_states` records them".into(),
        found => format!("--topic {}", found.join(" or --topic ")),
    }
}

/// Returns the help for a record that cannot be written.
fn instead(e: &mcap::McapError) -> &'static str {
    match e {
        mcap::McapError::Io(e) if e.kind() == std::io::ErrorKind::StorageFull => {
            "\n  help: a path on a disk with space left; what was written before can be replayed"
        }
        _ => "",
    }
}
