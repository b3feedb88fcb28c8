//! Regions on a measured encoder and a measured object, whose places another process sends late, out of order, with losses,
//! silences and restarts. Entries of robots by their own motion are counted.
//!
//! ```sh
//! cargo bench -p elbowroom-live --bench measured_sources -- --seconds 1800 [--loss 0.2]
//! ```
#![allow(clippy::print_stdout, reason = "a program")]

mod judge;
mod motion;
mod sender;

use std::error::Error;
use std::process::{Child, Command, ExitCode};
use std::time::{Duration, Instant};

use elbowroom_live::{Keys, Service, ServiceOptions};
use elbowroom_testkit::network::free_address;
use judge::Judge;
use motion::{ROBOTS, cell, now_us};

const MOST_SECONDS: u64 = 36_000;
/// Interval between two lines of progress.
const PROGRESS: Duration = Duration::from_mins(1);

struct Options {
    seconds: u64,
    /// Share of the measurements that are lost.
    loss: f64,
    /// For the process that measures: the address of the hub, and the time of day at which all motion begins.
    sender: Option<(String, u64)>,
}

fn main() -> ExitCode {
    let done = options().and_then(|options| match options.sender {
        Some((hub, epoch_us)) => sender::send(hub, epoch_us, options.loss).map(|()| true),
        None => run(&options),
    });
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options { seconds: 60, loss: 0.2, sender: None };
    let mut arguments = elbowroom_testkit::bench::arguments();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--seconds" => options.seconds = value()?.parse()?,
            "--loss" => options.loss = value()?.parse()?,
            "--sender" => options.sender = Some((value()?, value()?.parse()?)),
            _ => return Err(format!("{argument} is unknown\n  help: --seconds S, --loss SHARE").into()),
        }
    }
    if !(1..=MOST_SECONDS).contains(&options.seconds) || !(0.0..1.0).contains(&options.loss) {
        return Err(format!("--seconds is 1 to {MOST_SECONDS}, --loss is at least 0 and below 1").into());
    }
    Ok(options)
}

/// A process, which is killed when it is dropped.
struct Sender(Child);

impl Drop for Sender {
    fn drop(&mut self) {
        // A process that has ended cannot be killed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Runs the cell; false if a robot entered a region, or did not move.
fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    let (hub, epoch_us) = (free_address(), now_us());
    let arbiter = ServiceOptions { arbiter: true, listen: Some(hub.clone()), ..ServiceOptions::default() };
    let arbiter = Service::start(cell()?, &arbiter)?;
    let robots = ROBOTS.map(str::to_owned).to_vec();
    let guards = ServiceOptions { robots, connect: Some(hub.clone()), simulate: true, ..ServiceOptions::default() };
    let guards = Service::start(cell()?, &guards)?;
    let judge = Judge::start(&Keys::new(&cell()?.name), &**guards.network(), epoch_us)?;
    let arguments = ["--sender", &hub, &epoch_us.to_string(), "--loss", &options.loss.to_string()];
    let mut sender = Sender(Command::new(std::env::current_exe()?).args(arguments).spawn()?);
    let (begin, duration) = (Instant::now(), Duration::from_secs(options.seconds));
    let mut shown = begin;
    while begin.elapsed() < duration {
        std::thread::sleep(Duration::from_millis(200));
        if let Some(status) = sender.0.try_wait()? {
            return Err(format!("the process that measures has ended: {status}").into());
        }
        if shown.elapsed() >= PROGRESS {
            shown = Instant::now();
            show(&judge, begin.elapsed());
        }
    }
    show(&judge, begin.elapsed());
    let seen = judge.seen();
    drop(sender);
    guards.stop()?;
    arbiter.stop()?;
    Ok(seen.iter().all(|seen| seen.entries == 0 && seen.travelled_m > 0.5))
}

fn show(judge: &Judge, passed: Duration) {
    for (name, seen) in ROBOTS.iter().zip(judge.seen()) {
        println!(
            "{:.0} s, {name}: {} joint states, {:.0} m travelled, {} entries, nearest {:.1} mm in motion towards the region; \
             the region came to the robot at rest {} times; the source was lost {} times",
            passed.as_secs_f64(),
            seen.states,
            seen.travelled_m,
            seen.entries,
            1000.0 * seen.nearest_m,
            seen.reached_at_rest,
            seen.losses
        );
    }
}
