//! The commands of the feature `live`: the service, the cell in a browser, recordings.

mod args;
#[cfg(feature = "live")]
mod replay;
#[cfg(feature = "live")]
mod service;
#[cfg(feature = "live")]
mod view;

pub(crate) use args::{LiveArgs, ReplayArgs, ViewArgs};
#[cfg(feature = "live")]
pub(crate) use {replay::replay, service::live, view::view};

#[cfg(not(feature = "live"))]
pub(crate) use missing::{live, replay, view};

/// Without the feature the commands say how to get them.
#[cfg(not(feature = "live"))]
mod missing {
    use super::{LiveArgs, ReplayArgs, ViewArgs};
    use crate::output::{ExitStatus, Failure};

    pub(crate) fn live(_: &LiveArgs) -> Result<ExitStatus, Failure> {
        not_built("live")
    }

    pub(crate) fn view(_: &ViewArgs) -> Result<ExitStatus, Failure> {
        not_built("view")
    }

    pub(crate) fn replay(_: &ReplayArgs) -> Result<ExitStatus, Failure> {
        not_built("replay")
    }

    fn not_built(command: &str) -> Result<ExitStatus, Failure> {
        Err(Failure::Wrong(format!(
            "`{command}` is not in this build, which has no network.\n  help: cargo build --release --features live"
        )))
    }
}
