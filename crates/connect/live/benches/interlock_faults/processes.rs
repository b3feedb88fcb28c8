//! Processes of the cell: a node per robot and the arbiter, each connected through a relay.

use std::error::Error;
use std::process::{Child, Command, Stdio};

use elbowroom_live::network::ZENOH_RUNTIME;

use crate::log::{Log, Speaker};
use crate::relay::Relay;

/// A process, which is killed when it is dropped, and its connection.
pub struct Process {
    arguments: Vec<String>,
    child: Child,
    relay: Relay,
    log: Log,
    speaker: Speaker,
}

impl Process {
    /// Starts a part of the cell: `arbiter`, or the index of a robot.
    pub fn start(part: &str, robots: usize, hub: &str, log: &Log) -> Result<Self, Box<dyn Error>> {
        let relay = Relay::to(hub)?;
        let arguments = ["--robots", &robots.to_string(), "--part", part, relay.address()].map(str::to_owned).to_vec();
        let speaker = part.parse().ok();
        Ok(Self { child: spawn(&arguments, log, speaker)?, arguments, relay, log: log.clone(), speaker })
    }

    pub fn kill(&mut self) {
        // A process that has ended cannot be killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Returns how the process has ended by itself, if it has.
    pub fn has_ended(&mut self) -> Option<String> {
        self.child.try_wait().ok()?.map(|status| status.to_string())
    }

    pub fn restart(&mut self) -> Result<(), Box<dyn Error>> {
        self.kill();
        self.child = spawn(&self.arguments, &self.log, self.speaker)?;
        Ok(())
    }

    pub fn pause(&self, is_paused: bool) -> Result<(), Box<dyn Error>> {
        let signal = if is_paused { "-STOP" } else { "-CONT" };
        let status = Command::new("kill").args([signal, &self.child.id().to_string()]).status()?;
        if status.success() { Ok(()) } else { Err(format!("kill {signal}: {status}").into()) }
    }

    pub fn cut(&self, is_cut: bool) {
        self.relay.cut(is_cut);
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

fn spawn(arguments: &[String], log: &Log, speaker: Speaker) -> std::io::Result<Child> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(arguments).env("ZENOH_RUNTIME", ZENOH_RUNTIME);
    // A part ends with its standard input, and so with this process.
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    if let Some(output) = child.stdout.take() {
        log.follow(speaker, output);
    }
    Ok(child)
}
