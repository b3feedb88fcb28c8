//! The commands of the feature `live`: the service, the cell in a browser, recordings.

mod args;
#[cfg(feature = "live")]
mod endpoints;
#[cfg(feature = "live")]
mod joint_recording;
#[cfg(feature = "live")]
mod open_addresses;
#[cfg(feature = "live")]
mod record;
#[cfg(feature = "live")]
mod replay;
#[cfg(feature = "live")]
mod ros2;
#[cfg(feature = "live")]
mod service;
#[cfg(feature = "live")]
mod stop_signal;
#[cfg(feature = "live")]
mod view;

pub(crate) use args::{LiveArgs, ReplayArgs, ViewArgs};
#[cfg(feature = "live")]
pub(crate) use {joint_recording::convert_recording, record::run_recorded, replay::replay, service::live, view::view};

#[cfg(not(feature = "live"))]
pub(crate) use missing::{convert_recording, live, replay, run_recorded, view};

/// Stands in for the commands of the feature; says how to get them.
#[cfg(not(feature = "live"))]
mod missing {
    use std::path::Path;

    use elbowroom::sim::{RunOptions, RunOutcome};

    use super::{LiveArgs, ReplayArgs, ViewArgs};
    use crate::output::{ExitStatus, Failure};
    use crate::simulation::Simulation;

    pub(crate) fn live(_: &LiveArgs) -> Result<ExitStatus, Failure> {
        not_built("live")
    }

    pub(crate) fn view(_: &ViewArgs) -> Result<ExitStatus, Failure> {
        not_built("view")
    }

    pub(crate) fn replay(_: &ReplayArgs) -> Result<ExitStatus, Failure> {
        not_built("replay")
    }

    pub(crate) fn run_recorded(_: &Simulation<'_>, _: &RunOptions, _: &Path) -> Result<RunOutcome, Failure> {
        not_built("run --mcap")
    }

    pub(crate) fn convert_recording(_: &Path, _: Option<&str>, _: &Path) -> Result<ExitStatus, Failure> {
        not_built("convert RECORDING.mcap")
    }

    fn not_built<T>(command: &str) -> Result<T, Failure> {
        Err(Failure::Wrong(format!(
            "`{command}` is not in this build, which has no network.\n  help: cargo build --release --features live"
        )))
    }
}
