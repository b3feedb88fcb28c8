//! `elbowroom live`: guards real controllers over a network.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use elbowroom::cell::Cell;
use elbowroom::live::ros2::Ros2Settings;
use elbowroom::live::{DEFAULT_ADDRESS, Keys, Service, ServiceOptions};

use super::LiveArgs;
use super::ros2::{ros2_settings, run_watchdog};
use super::stop_signal::stop_signal;
use crate::output::{ExitStatus, Failure, note};

/// How often the process looks whether it has to end.
const POLL: Duration = Duration::from_millis(200);

pub(crate) fn live(args: &LiveArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let ros2 = ros2_settings(args)?;
    if let Some(bound_ms) = args.ros2_watchdog {
        return run_watchdog(&cell, &ros2, bound_ms, args);
    }
    let keys = Keys::new(&cell.name);
    let options = ServiceOptions {
        robots: args.robots.clone(),
        listen: args.listen.clone(),
        connect: args.connect.clone(),
        arbiter: args.arbiter,
        simulate: args.simulate,
        web: args.web.clone(),
        record: args.record.clone(),
        ros2,
        on_event: Some(Arc::new(|event: &str| note(event))),
    };
    let stop = stop_signal()?;
    let checksum = cell.checksum.clone();
    let service = Service::start(cell, &options).map_err(|e| Failure::Wrong(e.to_string()))?;
    let address = args.listen.as_deref().or(args.connect.as_deref()).unwrap_or(DEFAULT_ADDRESS);
    note(format_args!(
        "{} robot(s) guarded{}, {address}, configuration {}\nstatus: {}",
        service.guarded(),
        if service.is_arbiter() { ", arbiter" } else { "" },
        checksum.get(..16).unwrap_or_default(),
        keys.status("ROBOT"),
    ));
    note_of_ros2(args, &options.ros2);
    if let Some(url) = service.web_address() {
        note(url);
    }
    let status = wait(&stop, args.duration.map(Duration::from_secs_f64), &service)?;
    service.stop().map_err(|e| Failure::Wrong(e.to_string()))?;
    Ok(status)
}

fn note_of_ros2(args: &LiveArgs, ros2: &Ros2Settings) {
    if ros2.is_used() {
        let what = if args.ros2 { "the cell is published, " } else { "" };
        note(format_args!(
            "ROS 2: {what}{} robot(s), domain {}, router {}",
            ros2.robots.len(),
            ros2.domain,
            ros2.router()
        ));
    }
}

fn wait(stop: &Receiver<()>, duration: Option<Duration>, service: &Service) -> Result<ExitStatus, Failure> {
    let started = Instant::now();
    loop {
        if stop.recv_timeout(POLL) != Err(RecvTimeoutError::Timeout)
            || duration.is_some_and(|duration| started.elapsed() >= duration)
        {
            return Ok(ExitStatus::Success);
        }
        if !service.is_running() {
            return Err(Failure::Wrong("the simulated controllers have ended".into()));
        }
    }
}
