//! What can be typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use elbowroom::cell::query::{Ask, Level};
use elbowroom::cspace::Model;

/// Collision awareness for industrial robot cells.
///
/// Without a command, the example cell of the interference-region paper's figure 12 runs and its report is written to
/// elbowroom-out/figure12.
///
/// Exit status: 0 done and free of trouble; 1 the answer is bad news (a collision, a forbidden region entered, no path);
/// 2 the input or the call is wrong.
#[derive(Debug, Parser)]
#[command(name = "elbowroom", version, after_help = "Not a certified safety device.")]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a cell's programs in simulated time under the monitor
    Run(RunArgs),
    /// Say for every region and robot whether entry is excluded by the laws that are on, and what is missing
    Check(CheckArgs),
    /// Ask for collisions, distances or tolerances of a cell or a robot, one answer per joint state
    Query(QueryArgs),
    /// Say what is in a robot or mesh file
    Inspect(InspectArgs),
    /// Write a robot as a URDF with STL meshes, or as 3DS
    Convert(ConvertArgs),
    /// Turn a cell's objects into blocked cells of a robot's joint space
    Map(MapArgs),
    /// Find a collision-free, timed path of a robot from one joint state to another
    Plan(PlanArgs),
    /// Show the rules by which a robot evades what moves, or write them to a file to change
    Rules(RulesArgs),
    /// Turn points that the robot was driven to into a region for the cell file
    Teach(TeachArgs),
    /// Change regions and laws of a sealed cell on behalf of a class, seal it, and show who changed what
    #[command(subcommand)]
    Region(crate::region::args::RegionCommand),
    /// List the example cells, or copy them to a folder to start from
    Example(ExampleArgs),
    /// Print a completion script for a shell
    ///
    /// For bash: elbowroom completions bash > ~/.local/share/bash-completion/completions/elbowroom
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom rules                             the rules that come along, as a table
  elbowroom rules --write my_rules.toml       a copy to change; name it in the cell file: [avoidance.ROBOT] rules = ...
  elbowroom rules my_rules.toml --picture out size.svg and direction.svg: the control surfaces")]
pub(crate) struct RulesArgs {
    /// A file of rules; without it, those that come along
    pub(crate) file: Option<PathBuf>,
    /// Write the rules that come along to this file, with comments
    #[arg(long, value_name = "FILE", conflicts_with = "file")]
    pub(crate) write: Option<PathBuf>,
    /// Draw the control surfaces into this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) picture: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom run cell.toml                     a summary on the screen
  elbowroom run cell.toml --out out           and trace.csv, events.csv, report.html in out/
  elbowroom run cell.toml --out out --compare the report shows the run without the monitor beside it
  elbowroom run cell.toml --json | jq .regions")]
#[allow(clippy::struct_excessive_bools)] // each is a flag that is typed
pub(crate) struct RunArgs {
    /// The cell file (docs/cell-file.md has every key)
    pub(crate) cell: PathBuf,
    /// Write trace.csv, events.csv and report.html to this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Let the monitor watch without slowing anything
    #[arg(long)]
    pub(crate) no_monitor: bool,
    /// Let robots that evade keep to their programs, whatever comes
    #[arg(long)]
    pub(crate) no_avoidance: bool,
    /// Also run without the monitor and show both in the report
    #[arg(long, requires = "out", conflicts_with = "no_monitor")]
    pub(crate) compare: bool,
    /// Run the programs this many times in a row
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Print one JSON document instead of the summary
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom check cell.toml                   a table with the reasons, and what to write where entry is possible
  elbowroom check cell.toml --json | jq '.regions[] | select(.excluded | not)'

Nothing is run: the answer comes from the laws, the stopping times and the speeds of the programs (docs/laws.md).
Exit status: 1 where a region that is meant to keep a robot out does not.")]
pub(crate) struct CheckArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom query cell.toml --ask collision                         the cell as it starts
  elbowroom query cell.toml --ask distance --states q.csv           a row per state, as CSV
  elbowroom query --urdf arm.urdf --srdf arm.srdf --ask tolerance=0.02 --states q.csv --json
  elbowroom query cell.toml --ask collision --level L2              with a box around each link

Columns: index,collides,distance_m,a,b,ax,ay,az,bx,by,bz,level (docs/query.md says what is in them).
Exit status: 1 where --ask collision finds one.")]
pub(crate) struct QueryArgs {
    /// The cell file; or --urdf
    #[arg(required_unless_present = "urdf", conflicts_with = "urdf")]
    pub(crate) cell: Option<PathBuf>,
    /// One robot alone, its root link being the world: a URDF, or a 3DS, GLB or glTF model
    #[arg(long, value_name = "FILE", visible_alias = "model")]
    pub(crate) urdf: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) joints: JointArgs,
    /// The SRDF that belongs to the URDF: the pairs that it disables are not looked at
    #[arg(long, value_name = "FILE", conflicts_with = "cell")]
    pub(crate) srdf: Option<PathBuf>,
    /// Unit of a 3DS model, or of a URDF's meshes whose format states none
    #[arg(long, value_enum, conflicts_with = "cell")]
    pub(crate) unit: Option<Unit>,
    /// What to ask: collision, distance, or tolerance=METRES
    #[arg(long, value_name = "WHAT")]
    pub(crate) ask: Ask,
    /// Joint states (a header of joint names, a row of radians or metres each); default: the start
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) states: Option<PathBuf>,
    /// How closely to look: auto, L1, L2, L3, capsule or hull. All but auto and L3 err on the safe side
    #[arg(long, default_value = "auto")]
    pub(crate) level: Level,
    /// Print one JSON document instead of CSV
    #[arg(long)]
    pub(crate) json: bool,
}

/// What moves in a 3DS, GLB or glTF model.
#[derive(Debug, Args)]
pub(crate) struct JointArgs {
    /// The file that says which nodes of a 3DS, GLB or glTF model move (docs/models.md); default: MODEL.joints.toml
    /// beside it
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) joints: Option<PathBuf>,
    /// One node that moves, in metres and degrees, as `link_2: axis=y, min=-150, max=20, speed=110`; may be repeated
    #[arg(long, value_name = "NODE: axis=…")]
    pub(crate) joint: Vec<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom convert arm.3ds --out arm                     arm/arm.urdf and arm/meshes/*.stl
  elbowroom convert arm.urdf --out arm --to 3ds           arm/arm.3ds and arm/arm.joints.toml
  elbowroom convert arm.glb --out arm --joint \"link_1: axis=z, min=-170, max=170, speed=100\"
  elbowroom convert cell.toml --robot ns16 --out ns16     the robot of a cell, with its tool and load

Exit status: 0 where the files are written.")]
pub(crate) struct ConvertArgs {
    /// The robot: a URDF, a 3DS, GLB or glTF model, or a cell file that has it (docs/models.md)
    pub(crate) model: PathBuf,
    /// The folder to write to
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// What to write; both as urdf,3ds
    #[arg(long, value_enum, value_delimiter = ',', default_value = "urdf")]
    pub(crate) to: Vec<Written>,
    /// The robot of a cell file; may be left out where there is one
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// An SRDF that belongs to the model
    #[arg(long, value_name = "FILE")]
    pub(crate) srdf: Option<PathBuf>,
    /// Unit of a 3DS model, or of a URDF's meshes whose format states none
    #[arg(long, value_enum)]
    pub(crate) unit: Option<Unit>,
    #[command(flatten)]
    pub(crate) joints: JointArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Written {
    /// NAME.urdf, meshes/NAME/*.stl, and NAME.srdf where pairs are disabled
    Urdf,
    /// NAME.3ds, and NAME.joints.toml with what a 3DS file cannot say
    #[value(name = "3ds")]
    Tds,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom map cell.toml                                a table of what each object blocks
  elbowroom map cell.toml --out map.npy --json           the cells as NumPy reads them, 0 free, 1 blocked
  elbowroom map cell.toml --png slices                   pictures, and slices/index.html that shows them
  elbowroom map cell.toml --model spheres=8              as the paper would, to compare

Joints and steps are in [map.ROBOT] of the cell file; without it the first three joints, 2 degrees (docs/map.md).
A cell is blocked if any configuration in it can touch an object.")]
pub(crate) struct MapArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The robot; may be left out where there is one, or one [map.ROBOT]
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// What stands for each object: exact, slices, sphere, spheres=N or box
    #[arg(long, default_value = "exact")]
    pub(crate) model: Model,
    /// Write the cells to this file: one byte each, 0 free, 1 blocked, axes in the order of the joints
    #[arg(long, value_name = "FILE.npy")]
    pub(crate) out: Option<PathBuf>,
    /// Write pictures of slices, and a page that shows them, to this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) png: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom inspect arm.urdf                     joints, meshes, Denavit-Hartenberg table, warnings
  elbowroom inspect arm.urdf --dh modified       the table in Craig's convention
  elbowroom inspect arm.urdf --states q.csv      the pose of every link in the root link, as CSV
  elbowroom inspect table.stl --unit mm --json")]
pub(crate) struct InspectArgs {
    /// A robot (URDF, 3DS, GLB, glTF) or a mesh (STL, OBJ, DAE, PLY, OFF)
    pub(crate) model: PathBuf,
    /// The SRDF that belongs to the URDF
    #[arg(long, value_name = "FILE")]
    pub(crate) srdf: Option<PathBuf>,
    /// Unit of a 3DS model, or of meshes whose format states none
    #[arg(long, value_enum)]
    pub(crate) unit: Option<Unit>,
    #[command(flatten)]
    pub(crate) joints: JointArgs,
    /// The link at which the Denavit-Hartenberg table ends
    #[arg(long, value_name = "LINK")]
    pub(crate) tip: Option<String>,
    /// The Denavit-Hartenberg tables to print, with commas between; --json has them all
    #[arg(long, value_enum, value_delimiter = ',', value_name = "TABLE,…", conflicts_with = "states")]
    pub(crate) dh: Vec<Dh>,
    /// Joint states (a header of joint names, a row of radians or metres each): print link poses instead
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) states: Option<PathBuf>,
    /// Leave out what takes time: resolution levels, the pair matrix, visual meshes
    #[arg(long, conflicts_with = "models")]
    pub(crate) brief: bool,
    /// Also write a picture of the model with the axes of its joints: a PNG, or a page with four views
    #[arg(long, value_name = "FILE.png|.html", conflicts_with = "states")]
    pub(crate) picture: Option<PathBuf>,
    /// Also write hull, middle and coarse triangles of each link as STL (metres, link's frame) to this folder
    #[arg(long, value_name = "DIR", conflicts_with = "states")]
    pub(crate) models: Option<PathBuf>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Dh {
    /// Rz(theta) Tz(d) Tx(a) Ty(b) Rx(alpha) along the axes; the default
    Generalized,
    /// Rz(theta) Tz(d) Tx(a) Rx(alpha), where no row needs b
    Classical,
    /// Rx(alpha) Tx(a) Rz(theta) Tz(d), Craig's
    Modified,
    /// Generalized, a row for each frame of the model
    Direct,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Unit {
    M,
    Cm,
    Mm,
    In,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0               from the robot's start
  elbowroom plan cell.toml --robot arm --from -0.5,0,0,0,0,0 --to 0.5,0,0,0,0,0 --json
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0 --out path.csv   and timed samples for the controller
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0 --clearance 0.02 --time-limit 20

Objects, the other robots at their start, the robot itself with tool and load count, by the pair matrix of the cell;
permanent forbidden regions count for what the monitor guards against them.
Exit status: 1 where no path was found, which proves nothing: there may be one (docs/plan.md).")]
pub(crate) struct PlanArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Name of the robot; may be left out where there is one
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// Where it is: a number per joint in the order of the chain, rad (m where it slides), with commas between;
    /// default: the robot's start
    #[arg(long, value_name = "q,…", allow_hyphen_values = true)]
    pub(crate) from: Option<Numbers>,
    /// Where it shall go, likewise
    #[arg(long, value_name = "q,…", allow_hyphen_values = true)]
    pub(crate) to: Numbers,
    /// Write timed samples to this file: `t_s` and a column per joint, linear between rows
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Time from sample to sample in seconds; default: the cell's tick
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) period: Option<f64>,
    /// Stop looking after this time in seconds
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) time_limit: f64,
    /// Stay away from everything by more than this, in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(crate) clearance: f64,
    /// Another whole number may find another path; the same finds the same
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub(crate) json: bool,
}

/// Numbers with commas between.
#[derive(Debug, Clone)]
pub(crate) struct Numbers(pub(crate) Vec<f64>);

impl std::str::FromStr for Numbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |(i, word): (usize, &str)| {
            let value = word.trim().parse::<f64>().ok().filter(|v| v.is_finite());
            value.ok_or_else(|| format!("value {} is \"{}\", no finite number: write 0.5,-1.2,0", i + 1, word.trim()))
        };
        text.split(',').enumerate().map(number).collect::<Result<_, _>>().map(Self)
    }
}

/// A time that can be waited for.
fn seconds(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|v| *v >= 1e-5 && *v <= 1e6);
    value.ok_or_else(|| "write a number of seconds from 0.00001 to 1000000, as 2.5".into())
}

#[derive(Debug, Args)]
#[command(after_help = "The points are where the robot's TCP is at the states, in this order:
  sphere           centre, surface point          sphere4   four surface points
  cylinder         base centre, rim point, a point at the height of the top
  plane            origin, point on x, point in the xy plane (the region lies below)
  box              two opposite corners           box3      three base corners, and --height

Example:
  elbowroom teach cell.toml --shape sphere --name lamp --states taught.csv >> cell.toml")]
pub(crate) struct TeachArgs {
    /// The cell file that has the robot
    pub(crate) cell: PathBuf,
    /// What the points determine
    #[arg(long, value_enum)]
    pub(crate) shape: TaughtShape,
    /// Name of the region
    #[arg(long)]
    pub(crate) name: String,
    /// Joint states of the taught points, one row each
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) states: PathBuf,
    /// The robot that was driven; may be left out where there is one
    #[arg(long)]
    pub(crate) robot: Option<String>,
    /// Teach with the flange instead of the TCP
    #[arg(long)]
    pub(crate) flange: bool,
    /// Height of box3, in the cell file's unit of length: positive goes up from the taught corners, negative down
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) height: Option<f64>,
    /// Thickness of the warning zone, in the cell file's unit of length
    #[arg(long, default_value_t = 0.0)]
    pub(crate) warning: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TaughtShape {
    Sphere,
    Sphere4,
    Cylinder,
    Plane,
    Box,
    Box3,
}

#[derive(Debug, Args)]
pub(crate) struct ExampleArgs {
    /// Copy all examples and their models here; without it they are listed
    pub(crate) dir: Option<PathBuf>,
}
