//! Arguments of `elbowroom inspect`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use elbowroom::inspect::DhConvention;

use crate::arg_values::{LinkPoint, PoseNumbers};
use crate::model_args::{JointArgs, Unit};

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom inspect arm.urdf                     joints, meshes, Denavit-Hartenberg table, warnings
  elbowroom inspect arm.urdf --dh modified       the table in Craig's convention
  elbowroom inspect arm.urdf --write-srdf arm.srdf   the pairs that need not be tested
  elbowroom inspect cell.toml --pairs pairs.toml     all pairs of a cell, to decide on
  elbowroom inspect arm.urdf --states q.csv      the pose of every link in the root link: a table in a terminal, else CSV
  elbowroom inspect arm.urdf --pose 0.8,0,0.9,0,3.14159265,0     all joint values with the tip there
  elbowroom inspect arm.urdf --at link_3,0.1,0,0.05  the chain that ends in a point of a surface
  elbowroom inspect arm.urdf --brief --picture levels.html --levels  the boxes of each resolution level
  elbowroom inspect table.stl --unit mm --json")]
#[allow(clippy::struct_excessive_bools)] // each is a command-line flag
pub(crate) struct InspectArgs {
    /// A robot (URDF, 3DS, GLB, glTF, VRML) or a mesh (STL, OBJ, DAE, PLY, OFF); with --pairs also a cell file
    pub(crate) model: PathBuf,
    /// The SRDF of the URDF
    #[arg(long, value_name = "FILE")]
    pub(crate) srdf: Option<PathBuf>,
    /// Unit of a 3DS model, or of meshes whose format states none
    #[arg(long, value_enum)]
    pub(crate) unit: Option<Unit>,
    #[command(flatten)]
    pub(crate) joints: JointArgs,
    #[command(flatten)]
    pub(crate) chain: ChainArgs,
    /// The Denavit-Hartenberg tables to print, comma-separated; --json has all of them
    #[arg(long, value_enum, value_delimiter = ',', value_name = "TABLE,…", conflicts_with = "states")]
    pub(crate) dh: Vec<Dh>,
    /// Joint states (a header of joint names, then a row of radians or metres per state; - is standard input):
    /// print link poses instead: in mm and degrees in a terminal, else as CSV in metres
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) states: Option<PathBuf>,
    /// With --states: print link poses in mm and degrees, also to a file or pipe
    #[arg(long, requires = "states", conflicts_with = "json")]
    pub(crate) table: bool,
    /// Skip the slow parts: resolution levels, the allowed collision matrix, visual meshes
    #[arg(long, conflicts_with = "models")]
    pub(crate) brief: bool,
    #[command(flatten)]
    pub(crate) drawing: DrawingArgs,
    /// Also write hull, middle and coarse triangles of each link as STL (metres, link frame) to this folder
    #[arg(long, value_name = "DIR", conflicts_with = "states")]
    pub(crate) models: Option<PathBuf>,
    /// Write the results of sampling and geometry for all pairs to this file (docs/query.md); its rows with a `reason` stay.
    /// MODEL may then be a cell file
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["states", "brief"])]
    pub(crate) pairs: Option<PathBuf>,
    /// With --pairs: skip the pairs that are in contact in all samples
    #[arg(long, requires = "pairs")]
    pub(crate) accept: bool,
    /// Write an SRDF for the robot to this file: pairs of links that need not be tested, each with its reason
    #[arg(long, value_name = "FILE.srdf", conflicts_with_all = ["states", "brief"])]
    pub(crate) write_srdf: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is drawn.
#[derive(Debug, Args)]
pub(crate) struct DrawingArgs {
    /// Also write a picture of the model with its joint axes: a PNG, or an HTML page with four views
    #[arg(long, value_name = "FILE.png|.html", conflicts_with = "states")]
    pub(crate) picture: Option<PathBuf>,
    /// With --picture FILE.html: a page with the boxes of `query --level` L1, L2 and L2:1 to L2:8 around a robot, a
    /// slider over the levels, and sliders for the joints
    #[arg(long, requires = "picture", conflicts_with_all = ["states", "at"])]
    pub(crate) levels: bool,
}

/// Which chain of the model is asked about.
#[derive(Debug, Args)]
pub(crate) struct ChainArgs {
    /// The last link of the Denavit-Hartenberg table, and the link of --pose
    #[arg(long, value_name = "LINK")]
    pub(crate) tip: Option<String>,
    /// Print instead all joint values with which the tip is at this pose in the root link, in metres and radians
    #[arg(long, value_name = "X,Y,Z,ROLL,PITCH,YAW", allow_hyphen_values = true,
        conflicts_with_all = ["states", "table", "dh", "at", "picture", "models", "pairs", "write_srdf"])]
    pub(crate) pose: Option<PoseNumbers>,
    /// Print instead the chain that ends in this point of a link (metres, link frame): tables, Jacobian, reach; with
    /// --states the point's place in each state
    #[arg(long, value_name = "LINK,X,Y,Z", allow_hyphen_values = true,
        conflicts_with_all = ["tip", "table", "models", "pairs", "write_srdf"])]
    pub(crate) at: Option<LinkPoint>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Dh {
    /// Rz(theta) Tz(d) Tx(a) Ty(b) Rx(alpha) along the axes; the default
    Generalized,
    /// Rz(theta) Tz(d) Tx(a) Rx(alpha); exists if no row needs b
    Classical,
    /// Rx(alpha) Tx(a) Rz(theta) Tz(d), Craig's
    Modified,
    /// Generalized, one row per frame of the model
    Direct,
}

impl From<Dh> for DhConvention {
    fn from(table: Dh) -> Self {
        match table {
            Dh::Generalized => Self::Generalized,
            Dh::Classical => Self::Classical,
            Dh::Modified => Self::Modified,
            Dh::Direct => Self::Direct,
        }
    }
}
