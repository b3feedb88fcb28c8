//! The ROS 2 options of `elbowroom live`.

use std::sync::Arc;
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

use elbowroom::cell::Cell;
use elbowroom::live::ros2::{Ros2Robot, Ros2Settings, Watchdog};
use elbowroom::ros2::rmw_zenoh::Distribution;

use super::LiveArgs;
use super::stop_signal::stop_signal;
use crate::output::{ExitStatus, Failure, note};

/// Reads the settings from the options; for a missing option, from the environment variables of ROS 2.
pub(super) fn ros2_settings(args: &LiveArgs) -> Result<Ros2Settings, Failure> {
    if !(args.ros2.publish || !args.ros2.robot.is_empty() || args.ros2.watchdog.is_some()) {
        return Ok(Ros2Settings::default());
    }
    let robots: Result<Vec<Ros2Robot>, _> = args.ros2.robot.iter().map(|robot| robot.parse()).collect();
    let environment = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let domain = match (args.ros2.domain, environment("ROS_DOMAIN_ID")) {
        (Some(domain), _) => domain,
        (None, None) => 0,
        (None, Some(text)) => text
            .parse()
            .map_err(|_| Failure::Wrong(format!("ROS_DOMAIN_ID is {text}: not a number\n  help: --ros2-domain N")))?,
    };
    let distribution = args.ros2.distro.clone().or_else(|| environment("ROS_DISTRO"));
    Ok(Ros2Settings {
        publish: args.ros2.publish,
        robots: robots.map_err(|e| Failure::Wrong(e.to_string()))?,
        domain,
        distribution: if distribution.as_deref() == Some("humble") {
            Distribution::Humble
        } else {
            Distribution::Jazzy
        },
        router: args.ros2.router.clone(),
    })
}

/// Runs the watchdog until Ctrl-C, or for the time given by the options.
pub(super) fn run_watchdog(
    cell: &Cell,
    settings: &Ros2Settings,
    bound_ms: u64,
    args: &LiveArgs,
) -> Result<ExitStatus, Failure> {
    let stop = stop_signal()?;
    let bound = Duration::from_millis(bound_ms);
    let watchdog = Watchdog::start(cell, settings, &args.robots, bound, Some(Arc::new(|event: &str| note(event))))
        .map_err(|e| Failure::Wrong(e.to_string()))?;
    note(format_args!("watchdog: {bound_ms} ms, domain {}, router {}", settings.domain, settings.router()));
    let ended = match args.duration {
        Some(seconds) => stop.recv_timeout(Duration::from_secs_f64(seconds)),
        None => stop.recv().map_err(|_| RecvTimeoutError::Disconnected),
    };
    drop(watchdog);
    // The process was asked to end, or the time is over.
    match ended {
        Ok(()) | Err(RecvTimeoutError::Timeout) => Ok(ExitStatus::Success),
        Err(RecvTimeoutError::Disconnected) => Err(Failure::Wrong("Ctrl-C is not handled any more".into())),
    }
}
