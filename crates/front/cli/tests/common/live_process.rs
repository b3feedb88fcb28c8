//! Process of `elbowroom live`.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::command;

/// Makes the command of `elbowroom live` with two robots that share a region, without the environment variables of ROS 2.
pub fn live(arguments: &[&str]) -> Command {
    let mut command = command(Path::new("."), &["live"]);
    command.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live_cell.toml")).args(arguments);
    command.env_remove("ROS_DOMAIN_ID").env_remove("ROS_DISTRO").stderr(Stdio::null()).stdin(Stdio::null());
    command
}

/// A process that is killed when it is dropped.
pub struct LiveProcess(pub Child);

impl LiveProcess {
    /// Starts [`live`]. The process always ends with the test.
    pub fn start(arguments: &[&str]) -> Self {
        Self(live(arguments).args(["--for", "100"]).spawn().expect("elbowroom starts"))
    }
}

impl Drop for LiveProcess {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
