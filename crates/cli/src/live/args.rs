//! Arguments of the commands of the feature `live`.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom live cell.toml --simulate                  the whole cell in one process, with simulated controllers
  elbowroom live cell.toml --arbiter --listen 127.0.0.1:7447                       the arbiter alone
  elbowroom live cell.toml --robots left --connect 127.0.0.1:7447 --simulate       one robot, in a process of its own
  elbowroom live cell.toml --robots right --connect 127.0.0.1:7447 --simulate

A process without --connect listens at 127.0.0.1:7447. Each robot publishes JSON under elbowroom/CELL/ROBOT/status
(Zenoh); docs/live.md has all keys. Ctrl-C ends it: then every controller stops by itself.")]
#[allow(clippy::struct_excessive_bools)] // each is a command-line flag
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct LiveArgs {
    /// The cell file (docs/cell-file.md has every key)
    pub(crate) cell: PathBuf,
    /// Guard only these robots in this process
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) robots: Vec<String>,
    /// Accept connections at this address
    #[arg(long, value_name = "ADDR")]
    pub(crate) listen: Option<String>,
    /// Connect to the process at this address
    #[arg(long, value_name = "ADDR")]
    pub(crate) connect: Option<String>,
    /// Take controllers by UDP datagrams at this address, too (clients/c)
    #[arg(long, value_name = "ADDR")]
    pub(crate) udp: Option<String>,
    /// Grant exchange regions in this process; without --robots, nothing else
    #[arg(long)]
    pub(crate) arbiter: bool,
    /// Show the cell in a browser at this address
    #[arg(long, value_name = "ADDR")]
    pub(crate) web: Option<String>,
    /// Serve the control interface at this loopback address, beside the arbiter (docs/control.md)
    #[arg(long, value_name = "ADDR", requires = "tokens")]
    pub(crate) control: Option<String>,
    /// The tokens of those who may use the control interface
    #[arg(long, value_name = "FILE", requires = "control")]
    pub(crate) tokens: Option<PathBuf>,
    /// Let programs switch temporary regions without a token, though there are tokens
    #[arg(long, requires = "control")]
    pub(crate) program_switches: bool,
    /// Record everything into this MCAP file
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,
    /// Run the programs of the cell file in place of the controllers
    #[arg(long)]
    pub(crate) simulate: bool,
    /// End after this time; default: at Ctrl-C
    #[arg(long = "for", value_name = "SECONDS", value_parser = seconds)]
    pub(crate) duration: Option<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom view cell.toml                       prints an address to open in a browser")]
#[cfg_attr(not(feature = "live"), allow(dead_code))]
pub(crate) struct ViewArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The address to serve at; port 0 takes any free one
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:0")]
    pub(crate) web: String,
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

fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number of seconds".to_owned())?;
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err("must be more than 0".to_owned()) }
}
