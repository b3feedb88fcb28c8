//! Exchange regions under faults: a process per node, random ones killed, paused, restarted and cut off, the arbiter too.
//!
//! ```sh
//! cargo bench -p elbowroom-live --bench interlock_faults -- --robots 64 --seconds 1800 [--every 2] [--seed 1] [--json]
//! ```
//!
//! Arms in a row swing through a region with each neighbour. Their controllers run in this process, which knows the
//! true poses; nodes and arbiter are separate processes, connected through relays that can be cut. A temporary region
//! in the middle of each swing is switched at random. If a robot waits for a free region longer than two seconds, the
//! processes' lines must give the reason.
#![allow(clippy::print_stdout, reason = "a program")]

mod arms;
mod cell;
mod faults;
#[path = "../latency/latencies.rs"]
mod latencies;
mod log;
mod processes;
mod relay;
mod requests;
mod switches;

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Read;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use arms::Seen;
use elbowroom_live::network::{ZenohNetwork, ZenohSettings};
use elbowroom_live::{Keys, Service, ServiceOptions};
use faults::Faults;
use latencies::Latencies;
use log::{Log, Wait};
use processes::Process;
use requests::{Measured, Requests};
use switches::Switches;

const MOST_ROBOTS: usize = 64;
const MOST_SECONDS: u64 = 86_400;
const ARBITER: &str = "arbiter";
/// Longest time until a robot enters its next region, whatever fails, s.
const MOST_STANDING_S: f64 = 120.0;

/// Options of the bench.
#[derive(Debug, Clone)]
struct Options {
    robots: usize,
    seconds: u64,
    every_s: f64,
    seed: u64,
    json: bool,
    /// For a process that this program has started: its part, and the address that it connects to.
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
    let on_event = Arc::new(|line: &str| println!("{line}"));
    let service = ServiceOptions { robots, connect: Some(hub), arbiter: is_arbiter, ..ServiceOptions::default() };
    let service = ServiceOptions { on_event: Some(on_event), ..service };
    let service = Service::start(cell::cell(options.robots)?, &service)?;
    // Nothing is ever sent: the input ends with its writer.
    std::io::stdin().read_to_end(&mut Vec::new())?;
    service.stop()?;
    Ok(())
}

/// Results of a run.
struct Outcome {
    seen: Seen,
    faults: BTreeMap<String, u64>,
    /// Number of times that temporary regions were switched on.
    switched: u64,
    measured: Measured,
    unexplained: Vec<Wait>,
    lines: usize,
}

impl Outcome {
    fn longest_s(&self) -> f64 {
        self.seen.longest_s.iter().copied().fold(0.0, f64::max)
    }

    fn is_good(&self) -> bool {
        let Seen { shared, entered, held, ticks, .. } = self.seen;
        // Within a minute some arm reaches a region that is on; otherwise no region was ever switched.
        let is_tested = held > 0 || ticks * cell::TICK_MS < 60_000;
        is_tested && shared == 0 && entered == 0 && self.unexplained.is_empty() && self.longest_s() < MOST_STANDING_S
    }
}

/// Runs the cell under faults; returns false if two robots were in one region, one was in a region that was switched
/// on, one was stopped for minutes, or one has waited without a reported reason.
fn inject(options: &Options) -> Result<bool, Box<dyn Error>> {
    let cell = cell::cell(options.robots)?;
    let hub = std::net::TcpListener::bind("127.0.0.1:0")?.local_addr()?.to_string();
    let network = ZenohNetwork::open(&ZenohSettings { listen: Some(hub.clone()), ..ZenohSettings::default() })?;
    let (keys, log) = (Keys::new(&cell.name), Log::default());
    let requests = Requests::listen(&keys, options.robots, &network)?;
    let switches = Switches::listen(&keys, options.robots, &network)?;
    let parts = (0..options.robots).map(|robot| robot.to_string()).chain([ARBITER.to_owned()]);
    let processes = parts.map(|part| Process::start(&part, options.robots, &hub, &log));
    let faults = Faults::new(processes.collect::<Result<Vec<_>, _>>()?, options.seed);
    let (time, every) = (Duration::from_secs(options.seconds), Duration::from_secs_f64(options.every_s));
    let (seen, faults, switched) = std::thread::scope(|scope| {
        let (requests, switches) = (&requests, &switches);
        let injected = scope.spawn(move || faults.run(every, time, requests).map_err(|e| e.to_string()));
        let switching = scope.spawn(move || switches.run(time, options.seed));
        let seen = arms::run(&cell, &network, switches, time).map_err(|e| e.to_string());
        let faults = injected.join().unwrap_or_else(|_| Err("the faults have ended early".to_owned()));
        let switched = switching.join().map_err(|_| "the switches have ended early".to_owned());
        Ok::<_, String>((seen?, faults?, switched?))
    })?;
    let (measured, end) = (requests.measured(), Instant::now());
    let (unexplained, lines) = (log.unexplained(&measured.waits, end), log.count());
    let outcome = Outcome { seen, faults, switched, measured, unexplained, lines };
    print(options, &outcome);
    Ok(outcome.is_good())
}

fn words(Wait { robot, slot, from, to }: &Wait) -> String {
    let (region, wait_s) = (cell::between(slot + 1), (*to - *from).as_secs_f64());
    format!("{} waited {wait_s:.1} s for {region}", cell::name(*robot))
}

fn print(options: &Options, outcome: &Outcome) {
    let Outcome { seen, faults, switched, measured, unexplained, lines } = outcome;
    let entries: u64 = seen.entries.iter().sum();
    let fewest = seen.entries.iter().min().copied().unwrap_or(0);
    let longest_s = outcome.longest_s();
    if options.json {
        let latencies = |l: &Latencies| {
            let ms = |share| l.quantile_us(share) as f64 / 1e3;
            serde_json::json!({ "count": l.count(), "median_ms": ms(0.5), "p99_ms": ms(0.99), "worst_ms": ms(1.0) })
        };
        let report = serde_json::json!({
            "robots": options.robots, "seconds": options.seconds, "seed": options.seed,
            "faults": faults, "ticks": seen.ticks, "late_ticks": seen.late_ticks,
            "entries": entries, "fewest_entries": fewest, "longest_between_entries_s": longest_s, "shared": seen.shared,
            "switched_on": switched, "entered_while_on": seen.entered, "ticks_held": seen.held,
            "waits": measured.waits.len(), "unexplained_waits": unexplained.iter().map(words).collect::<Vec<_>>(),
            "grant_undisturbed": latencies(&measured.undisturbed), "grant_other": latencies(&measured.others),
            "arbiter_restart": latencies(&measured.restarts),
        });
        println!("{report}");
        return;
    }
    println!("{} robots, {} s, seed {}", options.robots, options.seconds, options.seed);
    for (fault, count) in faults {
        println!("{count:>8}  {fault}");
    }
    println!("{:>8}  ticks of the controllers, {} late", seen.ticks, seen.late_ticks);
    println!("{entries:>8}  entries, at least {fewest} of each robot, longest wait for the next {longest_s:.1} s");
    println!("{:>8}  ticks with two robots in one region", seen.shared);
    println!(
        "{switched:>8}  temporary regions switched on, {} ticks of robots before them, {} entered",
        seen.held, seen.entered
    );
    let (waits, unexplained_waits) = (measured.waits.len(), unexplained.len());
    println!(
        "{waits:>8}  waits of more than a second, {unexplained_waits} not explained by the {lines} lines that were said"
    );
    for wait in unexplained {
        println!("          {}", words(wait));
    }
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
