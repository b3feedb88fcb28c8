//! Exchange regions under faults: a process per node, random ones killed, paused, restarted and cut off, the arbiter too.
//!
//! ```sh
//! cargo bench -p elbowroom-live --bench interlock_faults -- --robots 64 --seconds 1800 [--every 2] [--seed 1] [--json]
//! ```
//!
//! Arms in a row swing through a region with each neighbour. Their controllers run in this process, which knows the true poses;
//! nodes and arbiter are processes of their own, connected through relays that can be cut.
#![allow(clippy::print_stdout, reason = "a program")]

mod arms;
mod cell;
mod faults;
#[path = "../latency/latencies.rs"]
mod latencies;
mod processes;
mod relay;
mod requests;

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Read;
use std::process::ExitCode;
use std::time::Duration;

use arms::Seen;
use elbowroom_live::network::{ZenohNetwork, ZenohSettings};
use elbowroom_live::{Keys, Service, ServiceOptions};
use faults::Faults;
use latencies::Latencies;
use processes::Process;
use requests::{Measured, Requests};

const MOST_ROBOTS: usize = 64;
const MOST_SECONDS: u64 = 86_400;
const ARBITER: &str = "arbiter";

/// The arguments.
#[derive(Debug, Clone)]
struct Options {
    robots: usize,
    seconds: u64,
    every_s: f64,
    seed: u64,
    json: bool,
    /// What a process is that this one has started: its part, and the address that it connects to.
    part: Option<(String, String)>,
}

fn main() -> ExitCode {
    let done = options().and_then(|options| match options.part.clone() {
        None => inject(&options),
        Some((part, hub)) => serve(&options, &part, hub).map(|()| true),
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
    let mut options = Options { robots: 64, seconds: 1800, every_s: 2.0, seed: 1, json: false, part: None };
    let mut arguments = elbowroom_testkit::bench::arguments();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--robots" => options.robots = value()?.parse()?,
            "--seconds" => options.seconds = value()?.parse()?,
            "--every" => options.every_s = value()?.parse()?,
            "--seed" => options.seed = value()?.parse()?,
            "--json" => options.json = true,
            "--part" => options.part = Some((value()?, value()?)),
            _ => {
                let known = "--robots N, --seconds S, --every S, --seed N, --json";
                return Err(format!("{argument} is unknown\n  help: {known}").into());
            }
        }
    }
    let is_allowed = (2..=MOST_ROBOTS).contains(&options.robots)
        && (1..=MOST_SECONDS).contains(&options.seconds)
        && (0.1..=3600.0).contains(&options.every_s);
    let limits = format!("2 to {MOST_ROBOTS} robots, 1 to {MOST_SECONDS} seconds, a fault every 0.1 to 3600 s");
    if is_allowed { Ok(options) } else { Err(limits.into()) }
}

/// Guards one robot, or grants the regions, until its standard input ends.
fn serve(options: &Options, part: &str, hub: String) -> Result<(), Box<dyn Error>> {
    let is_arbiter = part == ARBITER;
    let robots = if is_arbiter { vec![] } else { vec![cell::name(part.parse()?)] };
    let service = ServiceOptions { robots, connect: Some(hub), arbiter: is_arbiter, ..ServiceOptions::default() };
    let service = Service::start(cell::cell(options.robots)?, &service)?;
    // Nothing is ever sent: it ends with its writer.
    std::io::stdin().read_to_end(&mut Vec::new())?;
    service.stop()?;
    Ok(())
}

/// Runs the cell under faults; false where two robots were in one region, or one has never entered any.
fn inject(options: &Options) -> Result<bool, Box<dyn Error>> {
    let cell = cell::cell(options.robots)?;
    let hub = std::net::TcpListener::bind("127.0.0.1:0")?.local_addr()?.to_string();
    let network = ZenohNetwork::open(&ZenohSettings { listen: Some(hub.clone()), ..ZenohSettings::default() })?;
    let requests = Requests::listen(&Keys::new(&cell.name), options.robots, &network)?;
    let parts = (0..options.robots).map(|robot| robot.to_string()).chain([ARBITER.to_owned()]);
    let processes = parts.map(|part| Process::start(&part, options.robots, &hub)).collect::<Result<Vec<_>, _>>()?;
    let faults = Faults::new(processes, options.seed);
    let (time, every) = (Duration::from_secs(options.seconds), Duration::from_secs_f64(options.every_s));
    let (seen, counts) = std::thread::scope(|scope| {
        let requests = &requests;
        let injected = scope.spawn(move || faults.run(every, time, requests).map_err(|e| e.to_string()));
        let seen = arms::run(&cell, &network, time).map_err(|e| e.to_string());
        let counts = injected.join().unwrap_or_else(|_| Err("the faults have ended early".to_owned()));
        Ok::<_, String>((seen?, counts?))
    })?;
    print(options, &seen, &counts, &requests.measured());
    Ok(seen.shared == 0 && seen.entries.iter().all(|count| *count > 0))
}

fn print(options: &Options, seen: &Seen, counts: &BTreeMap<String, u64>, measured: &Measured) {
    let entries: u64 = seen.entries.iter().sum();
    let fewest = seen.entries.iter().min().copied().unwrap_or(0);
    let longest_s = seen.longest_s.iter().copied().fold(0.0, f64::max);
    if options.json {
        let latencies = |l: &Latencies| {
            let ms = |share| l.quantile_us(share) as f64 / 1e3;
            serde_json::json!({ "count": l.count(), "median_ms": ms(0.5), "p99_ms": ms(0.99), "worst_ms": ms(1.0) })
        };
        let report = serde_json::json!({
            "robots": options.robots, "seconds": options.seconds, "seed": options.seed,
            "faults": counts, "ticks": seen.ticks, "late_ticks": seen.late_ticks,
            "entries": entries, "fewest_entries": fewest, "longest_between_entries_s": longest_s, "shared": seen.shared,
            "grant_undisturbed": latencies(&measured.undisturbed), "grant_other": latencies(&measured.others),
            "arbiter_restart": latencies(&measured.restarts),
        });
        println!("{report}");
        return;
    }
    println!("{} robots, {} s, seed {}", options.robots, options.seconds, options.seed);
    for (fault, count) in counts {
        println!("{count:>8}  {fault}");
    }
    println!("{:>8}  ticks of the controllers, {} late", seen.ticks, seen.late_ticks);
    println!("{entries:>8}  entries, at least {fewest} of each robot, longest wait for the next {longest_s:.1} s");
    println!("{:>8}  ticks with two robots in one region", seen.shared);
    println!("                                    count   median ms      p99 ms    worst ms");
    let row = |what: &str, l: &Latencies| {
        let ms = |share| l.quantile_us(share) as f64 / 1e3;
        println!("{what:<31} {:>9} {:>11.3} {:>11.3} {:>11.3}", l.count(), ms(0.5), ms(0.99), ms(1.0));
    };
    row("request to grant, region free", &measured.undisturbed);
    row("taken, or with a fault", &measured.others);
    let mut all = measured.undisturbed.clone();
    all.merge(&measured.others);
    row("all requests", &all);
    row("arbiter's start to first grant", &measured.restarts);
}
