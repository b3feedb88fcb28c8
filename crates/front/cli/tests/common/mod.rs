//! Runs the built command as a shell would.
#![allow(dead_code, reason = "every test program uses a part of it")]

#[cfg(feature = "live")]
pub mod live_process;

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

pub use elbowroom_testkit::folder::{examples, model};
use serde_json::Value;

/// Result of a call.
pub struct Answer {
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Answer {
    /// Checks the exit status; prints the output on a mismatch.
    #[track_caller]
    pub fn expect(self, status: i32) -> Self {
        assert_eq!(self.status, status, "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self
    }

    /// Parses the only JSON document on standard output.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}:\n{}", self.stdout))
    }
}

pub fn command(dir: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_elbowroom"));
    // Tests run under cargo, users mostly do not.
    command.current_dir(dir).args(args).env_remove("CARGO").env_remove("COLUMNS");
    command
}

/// Runs `elbowroom args…` in `dir`.
pub fn elbowroom(dir: &Path, args: &[&str]) -> Answer {
    answer(command(dir, args).output().unwrap())
}

/// Runs `elbowroom args…` in `dir`, with this text on standard input.
pub fn with_input(dir: &Path, args: &[&str], input: &str) -> Answer {
    let mut child =
        command(dir, args).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A command that ends without reading closes the pipe.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    answer(child.wait_with_output().unwrap())
}

pub fn answer(output: Output) -> Answer {
    Answer {
        status: output.status.code().expect("ended by a signal"),
        stdout: String::from_utf8(output.stdout).expect("UTF-8 on standard output"),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Returns the keys of an object, in the order of the document.
pub fn keys(v: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = v.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

/// A small cell with a short run: a DH arm with two joints that swings towards a post.
pub const SWING: &str = r#"version = 1
units = { length = "mm", angle = "deg" }

[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]

[region.post]
shape = "cylinder"
base = [495, 495, -500]
radius = 50
height = 1000
warning = 200
guards = ["tcp"]

[program.arm]
steps = [{ move = "joint", to = [90, 0], speed = 50 }]
"#;

/// Makes a folder with [`SWING`] as `cell.toml`.
pub fn swing() -> tempfile::TempDir {
    with_cell(SWING)
}

/// Makes a folder with this `cell.toml`.
pub fn with_cell(text: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("cell.toml"), text).unwrap();
    dir
}

/// Returns [`SWING`] with a solid, for regions that guard more than the TCP.
pub fn solid_swing() -> String {
    let links = "links = [[], { capsule = { from = [0, 0, 0], to = [-300, 0, 0], radius = 40 } }]\n";
    SWING.replacen("\n[region", &format!("{links}\n[region"), 1)
}

/// An arm with two joints and a slide at its end, in millimetres and degrees, without its start.
macro_rules! slide_arm {
    () => {
        r#"[robot.arm]
dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }, { kind = "prismatic", min = -400, max = 0, speed = 500 }]
links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }, { capsule = { from = [0, 0, 0], to = [0, 0, 300], radius = 20 } }]
base = { at = [0, 0, 600] }
"#
    };
}
pub(crate) use slide_arm;

/// A part that stands on a table, within reach of [`slide_arm`].
macro_rules! part_on_table {
    () => {
        r#"[object.part]
shape = "box"
at = [700, 0, 250]
size = [60, 60, 100]
[object.table]
shape = "box"
at = [500, 0, 100]
size = [1000, 1800, 200]
"#
    };
}
pub(crate) use part_on_table;
