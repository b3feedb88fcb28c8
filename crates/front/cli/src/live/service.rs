//! `elbowroom live`: guards real controllers over a network.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use elbowroom::cell::Cell;
use elbowroom::cell::access::NetworkKey;
use elbowroom::live::network::ZENOH_RUNTIME;
use elbowroom::live::ros2::Ros2Settings;
use elbowroom::live::{ControlOptions, DEFAULT_ADDRESS, FrameInput, Keys, Service, ServiceOptions, region_journal_of};

use super::LiveArgs;
use super::endpoints::endpoint;
use super::open_addresses::open_addresses;
use super::ros2::{ros2_settings, run_watchdog};
use super::stop_signal::stop_signal;
use crate::output::{ExitStatus, Failure, note};

/// Interval between checks whether the process has to end.
const POLL: Duration = Duration::from_millis(200);

pub(crate) fn live(args: &LiveArgs) -> Result<ExitStatus, Failure> {
    with_few_threads();
    let cell = Cell::load(&args.cell)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let ros2 = ros2_settings(args)?;
    if let Some(bound_ms) = args.ros2.watchdog {
        return run_watchdog(&cell, &ros2, bound_ms, args);
    }
    if args.page.certificate.is_some() && args.page.web.is_none() && args.control.is_none() {
        let what = "--certificate: neither a page nor a control interface is served";
        return Err(Failure::Wrong(format!("{what}\n  write: --web ADDR or --control ADDR beside it")));
    }
    open_addresses(&args.network).iter().for_each(note);
    let keys = Keys::new(&cell.name);
    let options = ServiceOptions {
        robots: args.robots.clone(),
        listen: args.network.listen.clone(),
        connect: args.network.connect.clone(),
        network_key: args.network.network_key.as_deref().map(NetworkKey::read).transpose()?,
        udp: args.network.udp.clone(),
        arbiter: args.arbiter,
        journal: Some(region_journal_of(&args.cell)),
        simulate: args.simulate,
        frames: args.frames.iter().map(frame_source).collect::<Result<_, _>>()?,
        web: args.page.web.as_deref().map(|text| endpoint("--web", text, &args.page)).transpose()?,
        record: args.record.clone(),
        control: control(args)?,
        ros2,
        on_event: Some(Arc::new(|event: &str| note(event))),
    };
    let stop = stop_signal()?;
    let checksum = cell.approval.checksum.clone();
    let service = Service::start(cell, &options).map_err(|e| Failure::Wrong(e.to_string()))?;
    let address = args.network.listen.as_deref().or(args.network.connect.as_deref()).unwrap_or(DEFAULT_ADDRESS);
    let mechanisms = match service.mechanisms() {
        0 => String::new(),
        count => format!(", {count} mechanism(s) read"),
    };
    note(format_args!(
        "{} robot(s) guarded{mechanisms}{}, {address}, configuration {}\nstatus: {}",
        service.guarded(),
        if service.is_arbiter() { ", arbiter" } else { "" },
        checksum.get(..16).unwrap_or_default(),
        keys.status("ROBOT"),
    ));
    note_of_ros2(args, &options.ros2);
    if let Some(url) = service.web_address() {
        note(url);
    }
    if let Some(address) = service.control_address() {
        note(format_args!("control: {address}"));
    }
    let status = wait(&stop, args.duration.map(Duration::from_secs_f64), &service)?;
    service.stop().map_err(|e| Failure::Wrong(e.to_string()))?;
    Ok(status)
}

/// A sensor, and where its pictures come from.
fn frame_source((sensor, source): &(String, String)) -> Result<(String, FrameInput), Failure> {
    let source = match source.as_str() {
        "-" => FrameInput::StandardInput,
        "key" => FrameInput::Key,
        path if !is_pipe(Path::new(path)) => {
            let what = format!("--frames {sensor}={path}: no named pipe is there");
            let instead = format!("mkfifo {path} before it; a folder belongs into the cell file: frames = \"DIR\"");
            return Err(Failure::Wrong(format!("{what}\n  write: {instead}")));
        }
        path => FrameInput::Pipe(path.into()),
    };
    Ok((sensor.clone(), source))
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    std::fs::metadata(path).is_ok_and(|m| m.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_pipe(path: &Path) -> bool {
    path.exists() && !path.is_dir()
}

fn control(args: &LiveArgs) -> Result<Option<ControlOptions>, Failure> {
    let Some((address, tokens)) = args.control.as_deref().zip(args.tokens.clone()) else { return Ok(None) };
    let endpoint = endpoint("--control", address, &args.page)?;
    Ok(Some(ControlOptions { endpoint, tokens, log: None, program_switches: args.program_switches }))
}

/// Replaces this process by a new start of the program with the Zenoh thread settings that cause the fewest wake-ups per
/// message. Zenoh reads the variable once, at its start; an existing value is kept.
#[cfg(unix)]
fn with_few_threads() {
    use std::os::unix::process::CommandExt;
    if std::env::var_os("ZENOH_RUNTIME").is_none()
        && let Ok(program) = std::env::current_exe()
    {
        let arguments = std::env::args_os().skip(1);
        // Returns only on failure; the process then keeps Zenoh's default threads.
        let _ = std::process::Command::new(program).args(arguments).env("ZENOH_RUNTIME", ZENOH_RUNTIME).exec();
    }
}

#[cfg(not(unix))]
fn with_few_threads() {}

fn note_of_ros2(args: &LiveArgs, ros2: &Ros2Settings) {
    if ros2.is_used() {
        let what = if args.ros2.publish { "the cell is published, " } else { "" };
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
