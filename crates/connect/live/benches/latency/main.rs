//! Time from a joint state to its override, over Zenoh or by UDP datagrams on the loopback network, with a process per node and
//! per controller.
//!
//! ```sh
//! cargo bench -p elbowroom-live --bench latency -- --robots 8 --seconds 60 [--rate 500] [--udp | --through-arbiter] [--json]
//! ```
//!
//! Each node's process accepts its controller's connection, or receives its datagrams; a node answers by Zenoh first,
//! then by UDP. `--through-arbiter` sends both ways through the arbiter's process instead, as in a cell in which only
//! the arbiter listens. `ZENOH_RUNTIME='()'` measures with Zenoh's own threads.
#![allow(clippy::print_stdout, reason = "a program")]

mod cell;
mod controller;
mod latencies;
mod measured;

use std::error::Error;
use std::io::Read;
use std::process::{Child, Command, ExitCode, Stdio};
use std::time::Duration;

use elbowroom_live::network::{Network, UdpNetwork, ZENOH_RUNTIME, ZenohNetwork, ZenohSettings};
use elbowroom_live::{Service, ServiceOptions};
use measured::Measured;

const MOST_ROBOTS: usize = 64;
const MOST_SECONDS: u64 = 3_600;

/// Options of the bench.
#[derive(Debug, Clone)]
struct Options {
    robots: usize,
    seconds: u64,
    rate_hz: u64,
    through_arbiter: bool,
    /// Whether controllers use UDP.
    udp: bool,
    json: bool,
    /// For a process that this program has started: its part, the robot, its address, the arbiter's address.
    part: Option<(String, usize, String, String)>,
}

fn main() -> ExitCode {
    let done = options().and_then(|options| match options.part.clone() {
        None => measure_all(&options),
        Some((part, robot, address, arbiter)) if part == "node" => node(&options, robot, address, arbiter),
        Some((_, robot, address, _)) => controller(&options, robot, &address),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options =
        Options { robots: 1, seconds: 60, rate_hz: 500, through_arbiter: false, udp: false, json: false, part: None };
    let mut arguments = elbowroom_testkit::bench::arguments();
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--robots" => options.robots = value()?.parse()?,
            "--seconds" => options.seconds = value()?.parse()?,
            "--rate" => options.rate_hz = value()?.parse()?,
            "--through-arbiter" => options.through_arbiter = true,
            "--udp" => options.udp = true,
            "--json" => options.json = true,
            "--part" => options.part = Some((value()?, value()?.parse()?, value()?, value()?)),
            _ => {
                let known = "--robots N, --seconds S, --rate HZ, --udp, --through-arbiter, --json";
                return Err(format!("{argument} is unknown\n  help: {known}").into());
            }
        }
    }
    let is_allowed = (1..=MOST_ROBOTS).contains(&options.robots)
        && (1..=MOST_SECONDS).contains(&options.seconds)
        && (1..=1000).contains(&options.rate_hz)
        && !(options.udp && options.through_arbiter);
    let limits = format!(
        "1 to {MOST_ROBOTS} robots, 1 to {MOST_SECONDS} seconds, 1 to 1000 Hz, not both of --udp and --through-arbiter"
    );
    if is_allowed { Ok(options) } else { Err(limits.into()) }
}

/// A process that is killed when it is dropped.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        // A process that has ended cannot be killed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start(options: &Options, part: &str, robot: usize, address: &str, arbiter: &str) -> std::io::Result<Process> {
    let mut command = Command::new(std::env::current_exe()?);
    for (name, value) in
        [("--robots", options.robots as u64), ("--seconds", options.seconds), ("--rate", options.rate_hz)]
    {
        command.arg(name).arg(value.to_string());
    }
    if options.through_arbiter {
        command.arg("--through-arbiter");
    }
    if options.udp {
        command.arg("--udp");
    }
    command.args(["--part", part, &robot.to_string(), address, arbiter]);
    // As a service should be started; another value is kept, for comparison.
    if std::env::var_os("ZENOH_RUNTIME").is_none() {
        command.env("ZENOH_RUNTIME", ZENOH_RUNTIME);
    }
    // A node ends with its standard input, and so with this process.
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map(Process)
}

/// Returns an address with a free port: each transport has its own ports.
fn free_address(udp: bool) -> std::io::Result<String> {
    let any = "127.0.0.1:0";
    let address = if udp {
        std::net::UdpSocket::bind(any)?.local_addr()?
    } else {
        std::net::TcpListener::bind(any)?.local_addr()?
    };
    Ok(address.to_string())
}

fn measure_all(options: &Options) -> Result<(), Box<dyn Error>> {
    let arbiter = free_address(false)?;
    let service = ServiceOptions { arbiter: true, listen: Some(arbiter.clone()), ..ServiceOptions::default() };
    let service = Service::start(cell::cell(options.robots)?, &service)?;
    let (mut nodes, mut controllers) = (Vec::new(), Vec::new());
    for robot in 0..options.robots {
        let address = if options.through_arbiter { arbiter.clone() } else { free_address(options.udp)? };
        nodes.push(start(options, "node", robot, &address, &arbiter)?);
        controllers.push(start(options, "controller", robot, &address, &arbiter)?);
    }
    let mut all = Measured { robot: "all".to_owned(), ..Measured::default() };
    let mut each = Vec::new();
    for controller in &mut controllers {
        let mut output = String::new();
        if let Some(stdout) = &mut controller.0.stdout {
            stdout.read_to_string(&mut output)?;
        }
        let measured: Measured = serde_json::from_str(&output).map_err(|e| format!("a controller has failed: {e}"))?;
        all.merge(&measured);
        each.push(measured);
    }
    drop(nodes);
    service.stop()?;
    print(options, &each, &all);
    Ok(())
}

fn print(options: &Options, each: &[Measured], all: &Measured) {
    if options.json {
        let robots: Vec<_> = each.iter().map(Measured::json).collect();
        let report = serde_json::json!({
            "robots": options.robots, "seconds": options.seconds, "rate_hz": options.rate_hz,
            "through_arbiter": options.through_arbiter, "udp": options.udp, "each": robots, "all": all.json(),
        });
        println!("{report}");
        return;
    }
    println!("{}", Measured::HEADER);
    each.iter().chain([all]).for_each(|measured| println!("{}", measured.row()));
}

/// Guards one robot until its standard input ends, or well after all is measured.
fn node(options: &Options, robot: usize, address: String, arbiter: String) -> Result<(), Box<dyn Error>> {
    let robots = vec![cell::name(robot)];
    let of_controller = (!options.through_arbiter).then_some(address);
    let (listen, udp) = if options.udp { (None, of_controller) } else { (of_controller, None) };
    let service = ServiceOptions { robots, listen, udp, connect: Some(arbiter), ..Default::default() };
    let service = Service::start(cell::cell(options.robots)?, &service)?;
    let longest = Duration::from_secs(options.seconds + 120);
    std::thread::spawn(move || {
        std::thread::sleep(longest);
        std::process::exit(1);
    });
    // Nothing is ever sent: the input ends with its writer.
    std::io::stdin().read_to_end(&mut Vec::new())?;
    service.stop()?;
    Ok(())
}

fn controller(options: &Options, robot: usize, address: &str) -> Result<(), Box<dyn Error>> {
    let cell = cell::cell(options.robots)?;
    let network: Box<dyn Network> = if options.udp {
        Box::new(UdpNetwork::bind("127.0.0.1:0", &[address])?)
    } else {
        Box::new(ZenohNetwork::open(&ZenohSettings { connect: Some(address.to_owned()), ..ZenohSettings::default() })?)
    };
    let measured = controller::measure(&cell, &cell::name(robot), &*network, options.seconds, options.rate_hz)?;
    println!("{}", serde_json::to_string(&measured)?);
    Ok(())
}
