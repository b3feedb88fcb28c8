//! Arguments of the commands of the feature `live`.

use std::path::PathBuf;

use clap::{ArgGroup, Args};

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("with_ros2").args(["ros2", "ros2_robot", "ros2_watchdog"]).multiple(true))]
#[command(after_help = "Examples:
  elbowroom live cell.toml --simulate                  the whole cell in one process, with simulated controllers
  elbowroom live cell.toml --arbiter --listen 127.0.0.1:7447                       the arbiter alone
  elbowroom live cell.toml --robots left --connect 127.0.0.1:7447 --simulate       one robot, in a process of its own
  elbowroom live cell.toml --robots right --connect 127.0.0.1:7447 --simulate
  elbowroom live cell.toml --simulate --ros2           with the topics of ROS 2 (docs/ros2.md)
  elbowroom live cell.toml --ros2-robot left=/joint_states,/left_controller/speed_scaling_input
  elbowroom live cell.toml --ros2-watchdog 100         beside each controller of ROS 2: stops it when the service is silent

A process without --connect listens at 127.0.0.1:7447. Each robot publishes JSON under elbowroom/CELL/ROBOT/status
(Zenoh); docs/live.md has all keys. Ctrl-C ends it: then every controller stops by itself.")]
#[allow(clippy::struct_excessive_bools)] // each is a command-line flag
#[allow(clippy::doc_markdown)] // help texts are printed as they are
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct LiveArgs {
    /// The cell file (docs/cell-file.md has every key)
    pub(crate) cell: PathBuf,
    /// Guard only these robots in this process
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) robots: Vec<String>,
    #[command(flatten)]
    pub(crate) network: NetworkArgs,
    /// Grant exchange regions in this process; without --robots, nothing else
    #[arg(long)]
    pub(crate) arbiter: bool,
    #[command(flatten)]
    pub(crate) page: PageArgs,
    /// Serve the control interface at this address, beside the arbiter (docs/control.md)
    #[arg(long, value_name = "ADDR", requires = "tokens")]
    pub(crate) control: Option<String>,
    /// The file of tokens for the control interface
    #[arg(long, value_name = "FILE", requires = "control")]
    pub(crate) tokens: Option<PathBuf>,
    /// Let programs switch temporary regions without a token, even with --tokens
    #[arg(long, requires = "control")]
    pub(crate) program_switches: bool,
    /// Record everything into this MCAP file
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,
    /// Run the programs of the cell file in place of the controllers
    #[arg(long)]
    pub(crate) simulate: bool,
    /// Where a camera's pictures come from, `NAME=SOURCE`: `-` (standard input) or a named pipe, PNG pictures one after another, or
    /// `key`, messages under elbowroom/CELL/sensor/NAME/frames; default: the folder of the cell file, without one `key`; repeatable
    #[arg(long, value_name = "NAME=SOURCE", requires = "simulate", value_parser = frame_source)]
    pub(crate) frames: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) ros2: Ros2Args,
    /// End after this time; default: at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    pub(crate) duration: Option<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom view cell.toml                       prints an address to open in a browser
  elbowroom view cell.toml --draw                draws targets of virtual fixtures there")]
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct ViewArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Draw targets of virtual fixtures on objects in the page, and write them into the cell file; only at this computer
    #[arg(long, conflicts_with = "certificate")]
    pub(crate) draw: bool,
    #[command(flatten)]
    pub(crate) page: PageArgs,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom replay run.mcap                      the same overrides to the bit, or the first that differs")]
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct ReplayArgs {
    /// The recording
    pub(crate) recording: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

/// What the service has to do with ROS 2.
#[derive(Debug, Args)]
#[allow(clippy::doc_markdown)] // help texts are printed as they are
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct Ros2Args {
    /// Publish the cell in ROS 2, for RMW_IMPLEMENTATION=rmw_zenoh_cpp
    #[arg(long = "ros2", id = "ros2")]
    pub(crate) publish: bool,
    /// A robot whose controller speaks ROS 2, and its topics: `ROBOT[=JOINT_STATES,SPEED_SCALING[,CONTROLLER_STATE]]`; repeatable
    #[arg(long = "ros2-robot", id = "ros2_robot", value_name = "ROBOT=TOPICS")]
    pub(crate) robot: Vec<String>,
    /// Only publish speed scaling 0 for each robot of whose service nothing was heard for this long
    #[arg(long = "ros2-watchdog", id = "ros2_watchdog", value_name = "MS", value_parser = clap::value_parser!(u64).range(10..=60_000), conflicts_with_all = ["arbiter", "simulate", "web", "record", "ros2"])]
    pub(crate) watchdog: Option<u64>,
    /// The router of ROS 2 (rmw_zenohd, or this service itself); default: 127.0.0.1:7447
    #[arg(long = "ros2-router", id = "ros2_router", value_name = "ADDR", requires = "with_ros2")]
    pub(crate) router: Option<String>,
    /// The domain; default: ROS_DOMAIN_ID, or 0
    #[arg(long = "ros2-domain", id = "ros2_domain", value_name = "N", requires = "with_ros2")]
    pub(crate) domain: Option<u32>,
    /// The release of ROS 2: humble, jazzy, kilted or rolling; default: ROS_DISTRO, or jazzy
    #[arg(long = "ros2-distro", id = "ros2_distro", value_name = "NAME", requires = "with_ros2", value_parser = ["humble", "jazzy", "kilted", "rolling"])]
    pub(crate) distro: Option<String>,
}

/// A sensor and where its pictures come from.
fn frame_source(text: &str) -> Result<(String, String), String> {
    let (name, source) = text.split_once('=').ok_or("write NAME=SOURCE, such as above=- or above=/tmp/pictures")?;
    Ok((name.to_owned(), source.to_owned()))
}

fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number of seconds".to_owned())?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err("must be more than 0".to_owned()) }
}

/// Address of the page, and its access from other computers.
#[derive(Debug, Args)]
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct PageArgs {
    /// Show the cell in a browser at this address; port 0 takes any free one (`view`: 127.0.0.1:0 without it)
    #[arg(long, value_name = "ADDR")]
    pub(crate) web: Option<String>,
    /// The certificate of this computer (PEM): encrypts the page and the control interface, and permits any address for them
    #[arg(long, value_name = "FILE.pem", requires = "certificate_key")]
    pub(crate) certificate: Option<PathBuf>,
    /// The private key of the certificate (PEM)
    #[arg(long, value_name = "FILE.pem", requires = "certificate")]
    pub(crate) certificate_key: Option<PathBuf>,
}

/// Network addresses of the processes of a cell, and its key.
#[derive(Debug, Args)]
#[allow(clippy::doc_markdown)] // help texts are printed as they are
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct NetworkArgs {
    /// Accept connections at this address
    #[arg(long, value_name = "ADDR")]
    pub(crate) listen: Option<String>,
    /// Connect to the process at this address
    #[arg(long, value_name = "ADDR")]
    pub(crate) connect: Option<String>,
    /// Accept only processes that have this key, made by `elbowroom control network-key` (docs/security.md)
    #[arg(long, value_name = "FILE")]
    pub(crate) network_key: Option<PathBuf>,
    /// Also accept controllers by UDP datagrams at this address (clients/c)
    #[arg(long, value_name = "ADDR")]
    pub(crate) udp: Option<String>,
}
