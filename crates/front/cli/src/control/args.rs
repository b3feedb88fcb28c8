//! Arguments of `elbowroom control`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use crate::region::args::Class;
use crate::taught_shape::TaughtShapeArgs;

/// Commands for a running cell (docs/control.md).
#[derive(Debug, Subcommand)]
pub(crate) enum ControlCommand {
    /// Make a token: its hash goes to a file of the service, its secret to standard output, once
    Token(TokenArgs),
    /// Make the key with which the processes of a cell recognize each other
    NetworkKey(NetworkKeyArgs),
    /// List regions, whether they are on, and who holds exchange regions
    Regions(RegionsArgs),
    /// Switch a temporary region on or off
    Switch(SwitchArgs),
    /// Move a temporary region
    Move(MoveArgs),
    /// Add a region
    Add(AddArgs),
    /// Teach a region at a running robot, and compare it with the obstacle
    Teach(TeachAtRobotArgs),
    /// Remove a temporary region
    Remove(RemoveArgs),
    /// Declare that you have seen a silent robot at rest outside its exchange regions
    Clear(ClearArgs),
    /// Verify and list the changes that a service has logged beside the cell file
    Log(LogArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control token --role programmer --name \"line 4, panel\" --file tokens.toml > panel.secret
  elbowroom live cell.toml --control 127.0.0.1:7448 --tokens tokens.toml")]
pub(crate) struct TokenArgs {
    /// The role of the token's holder
    #[arg(long, value_enum)]
    pub(crate) role: Class,
    /// The token's holder: a place or a function, for the log
    #[arg(long)]
    pub(crate) name: String,
    /// The file of tokens; created if missing
    #[arg(long, value_name = "FILE")]
    pub(crate) file: PathBuf,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control network-key --out cell.key
  elbowroom live cell.toml --network-key cell.key")]
pub(crate) struct NetworkKeyArgs {
    /// The new file; only its owner may read it
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
}

/// The service, and the secret of a token.
#[derive(Debug, Args)]
pub(crate) struct ServiceArgs {
    /// The control address of the service
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:7448")]
    pub(crate) at: String,
    /// The file with the secret of a token; default: the file named by the environment variable `ELBOWROOM_SECRET`
    #[arg(long, value_name = "FILE")]
    pub(crate) secret: Option<PathBuf>,
    /// The certificate of a service on another computer (PEM), as `live --certificate` has it
    #[arg(long, value_name = "FILE.pem")]
    pub(crate) certificate: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control regions --secret panel.secret")]
pub(crate) struct RegionsArgs {
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// Print one JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum State {
    On,
    Off,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control switch cart on --secret panel.secret --note \"cart arrives\"")]
pub(crate) struct SwitchArgs {
    /// The region
    pub(crate) region: String,
    /// On or off
    pub(crate) state: State,
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// A comment for the log
    #[arg(long, value_name = "TEXT")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control move cart 'base=[-900, 0, 0]' --secret panel.secret --note \"other dock\"")]
pub(crate) struct MoveArgs {
    /// The region
    pub(crate) region: String,
    /// The new place of the region, as keys of the cell file
    #[arg(value_name = "KEY=VALUE", required = true)]
    pub(crate) to: Vec<String>,
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// A comment for the log
    #[arg(long, value_name = "TEXT")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control add trolley trolley.toml --secret panel.secret
  elbowroom teach cell.toml --shape box --name trolley --states taught.csv | elbowroom control add trolley - --secret panel.secret")]
pub(crate) struct AddArgs {
    /// Name of the region
    pub(crate) region: String,
    /// The file with its keys, as in a cell file, or with the table [region.NAME]; - is standard input
    pub(crate) file: PathBuf,
    /// Add the region switched off; temporary regions only
    #[arg(long)]
    pub(crate) off: bool,
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// A comment for the log
    #[arg(long, value_name = "TEXT")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The points are the same as for `elbowroom teach`: move the robot to each, and press Enter. Then move it to the obstacle and see
its distance from the region, which should be 0 where the tool touches the obstacle. Before all
points are there, the distance is from what they determine. A fence takes corners until c closes it.

Examples:
  elbowroom control teach trolley --robot left --shape box --secret panel.secret >> cell.toml
  elbowroom control teach trolley --robot left --shape box --warning 200 --add --secret panel.secret
  elbowroom control teach yard --robot left --shape fence --height 2000 --secret panel.secret"
)]
pub(crate) struct TeachAtRobotArgs {
    /// Name of the region
    pub(crate) region: String,
    /// The robot that is moved to the points
    #[arg(long)]
    pub(crate) robot: String,
    #[command(flatten)]
    pub(crate) shape: TaughtShapeArgs,
    /// Make a permanent region instead of a temporary one
    #[arg(long)]
    pub(crate) permanent: bool,
    /// Add the region to the running cell, too
    #[arg(long)]
    pub(crate) add: bool,
    /// Add the region switched off; temporary regions only
    #[arg(long, requires = "add")]
    pub(crate) off: bool,
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// A comment for the log
    #[arg(long, value_name = "TEXT", requires = "add")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control remove trolley --secret panel.secret")]
pub(crate) struct RemoveArgs {
    /// The region
    pub(crate) region: String,
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// A comment for the log
    #[arg(long, value_name = "TEXT")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom control clear left --outside pallet --repeat left --secret integrator.secret

See the robot at rest and outside of every region that you name: others may enter them at once.")]
pub(crate) struct ClearArgs {
    /// The robot
    pub(crate) robot: String,
    /// All exchange regions of the robot
    #[arg(long, value_name = "REGIONS", value_delimiter = ',', required = true)]
    pub(crate) outside: Vec<String>,
    /// The robot again, to confirm
    #[arg(long, value_name = "ROBOT")]
    pub(crate) repeat: String,
    #[command(flatten)]
    pub(crate) service: ServiceArgs,
    /// A comment for the log
    #[arg(long, value_name = "TEXT")]
    pub(crate) note: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct LogArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Print one JSON document
    #[arg(long)]
    pub(crate) json: bool,
}
