//! Command-line arguments.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use elbowroom::query::map::MapModel;
use elbowroom::query::{Level, QueryKind};

use crate::arg_values::{margin, milliseconds};
use crate::model_args::{JointArgs, Unit};
use crate::taught_shape::TaughtShapeArgs;

/// Collision awareness for industrial robot cells.
///
/// Without a command, the example cell of the interference-region paper's figure 12 runs and its report is written to
/// elbowroom-out/figure12.
///
/// Exit status: 0 success; 1 negative result (a collision, a forbidden region entered, no path);
/// 2 invalid input or call.
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
    /// Report for each region and robot whether the enabled laws exclude entry, and what is missing
    Check(CheckArgs),
    /// Compute collisions, distances or tolerances of a cell or a robot, one row per joint state
    Query(QueryArgs),
    /// Report the contents of a robot or mesh file
    Inspect(crate::inspect::args::InspectArgs),
    /// Write a robot as a URDF with STL meshes, as 3DS or SRDF; a planning scene as a cell file
    Convert(ConvertArgs),
    /// Compute the joint-space occupancy of a cell's objects for one robot
    Map(MapArgs),
    /// Find a collision-free, timed path of a robot from one joint state to another, or solve a file of planning problems
    Plan(crate::plan_args::PlanArgs),
    /// Answer queries about very many states, on one machine or on a cluster (needs the Python package)
    Sweep(SweepArgs),
    /// Print the fuzzy rules of obstacle avoidance, or write them to a file for editing
    Rules(RulesArgs),
    /// Build a region for the cell file from taught points
    Teach(TeachArgs),
    /// Generate the shield of a virtual fixture, and report whether its tool reaches the target
    Fixture(FixtureArgs),
    /// Report what a camera of a cell sees, picture by picture: obstacles, and the joint-space cells that they block
    #[command(name = "watch")]
    WatchCamera(WatchArgs),
    /// Edit regions and laws by access class, seal a cell, show its edit log; write regions as zones of a controller
    #[command(subcommand)]
    Region(crate::region::args::RegionCommand),
    /// List the example cells, or copy them to a folder to start from
    Example(ExampleArgs),
    /// Guard real controllers over a network (needs the feature `live`)
    Live(crate::live::LiveArgs),
    /// Switch regions of a running cell, clear silent robots, under tokens with roles
    #[command(subcommand)]
    Control(crate::control::args::ControlCommand),
    /// Show a cell in a browser (needs the feature `live`)
    View(crate::live::ViewArgs),
    /// Run the monitor again over a recording, and compare (needs the feature `live`)
    Replay(crate::live::ReplayArgs),
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
  elbowroom rules                              the built-in rules, as a table
  elbowroom rules --write my_rules.toml        a copy for editing
  elbowroom rules my_rules.toml --picture out  size.svg and direction.svg: the control surfaces

Name a file of rules in the cell file: [avoidance.ROBOT] rules = ...")]
pub(crate) struct RulesArgs {
    /// A file of rules; default: the built-in rules
    pub(crate) file: Option<PathBuf>,
    /// Write the built-in rules, with comments, to this file
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
  elbowroom fixture cell.toml --name cut                  width of the opening, and whether the tool reaches the target
  elbowroom fixture cell.toml --name cut --out shield.stl  and the shield as a mesh in metres, in the world
  elbowroom fixture cell.toml --name cut --json | jq .reachable

Exit status: 1 if the tool does not reach the target, 2 if the target is not on the surface.")]
pub(crate) struct FixtureArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Name of the fixture: [fixture.NAME] of the cell; default: the only one
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// Write the shield to this STL file
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Print one JSON document instead of the text
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom run cell.toml                      a summary on the screen
  elbowroom run cell.toml --out out            and trace.csv, events.csv, report.html in out/
  elbowroom run cell.toml --out out --compare  and a comparison with a run without the monitor
  elbowroom run cell.toml --json | jq .regions")]
#[allow(clippy::struct_excessive_bools)] // each is a command-line flag
pub(crate) struct RunArgs {
    /// The cell file (docs/cell-file.md has every key)
    pub(crate) cell: PathBuf,
    /// Write trace.csv, events.csv and report.html to this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Let the monitor observe without limiting the speed override
    #[arg(long)]
    pub(crate) no_monitor: bool,
    /// Disable obstacle avoidance: all robots follow their programs
    #[arg(long)]
    pub(crate) no_avoidance: bool,
    /// Show all of the run without the monitor in the report, not only its distances
    #[arg(long, requires = "out", conflicts_with = "no_monitor")]
    pub(crate) compare: bool,
    /// Run the programs this many times in a row
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Record the run into this MCAP file, for viewers and `elbowroom replay` (in builds with the feature `live`)
    #[arg(long, value_name = "FILE")]
    pub(crate) mcap: Option<PathBuf>,
    /// Print one JSON document instead of the summary
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom check cell.toml      a table with reasons, and the missing keys where entry is possible
  elbowroom check cell.toml --json | jq '.regions[] | select(.excluded | not)'

Nothing is simulated: the result follows from the laws, the stopping times and the program speeds
(docs/laws.md).
Exit status: 1 if entry into a forbidden or exchange region is not excluded.")]
pub(crate) struct CheckArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom query cell.toml --ask collision                         the start state of the cell
  elbowroom query cell.toml --ask distance --states q.csv           a row per state, as CSV
  elbowroom query --urdf arm.urdf --srdf arm.srdf --ask tolerance=0.02 --states q.csv --json
  elbowroom query cell.toml --ask collision --level L2              with a bounding volume per link
  elbowroom query cell.toml --ask distance --level L2:3             with at most eight boxes per link
  elbowroom query cell.toml --ask distance --between arm,conveyor   nothing but these two
  elbowroom query cell.toml --ask distance --all-pairs 0.1          every pair nearer than 0.1 m
  elbowroom query cell.toml --ask time --states path.csv            the first contact of the motion between the rows
  elbowroom query cell.toml --ask contacts --pairs pairs.toml       all triangles that touch, but for what may touch
  elbowroom query cell.toml --ask limits --states q.csv             the joint that is farthest beyond its limits

Columns: index,collides,distance_m,a,b,ax,ay,az,bx,by,bz,level; the other columns are in docs/query.md.
Exit status: 1 if --ask collision finds a collision.")]
pub(crate) struct QueryArgs {
    /// The cell file; or --urdf
    #[arg(required_unless_present = "urdf", conflicts_with = "urdf")]
    pub(crate) cell: Option<PathBuf>,
    /// A single robot with its root link at the world origin: a URDF, or a 3DS, GLB, glTF or VRML model
    #[arg(long, value_name = "FILE", visible_alias = "model")]
    pub(crate) urdf: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) joints: JointArgs,
    /// The SRDF of the URDF: link pairs that it disables are not tested
    #[arg(long, value_name = "FILE", conflicts_with = "cell")]
    pub(crate) srdf: Option<PathBuf>,
    /// Length unit of a 3DS model, or of a URDF's meshes whose format states none
    #[arg(long, value_enum, conflicts_with = "cell")]
    pub(crate) unit: Option<Unit>,
    /// The query: collision, distance, tolerance=METRES, point (the collision point and its link), contacts (all triangles
    /// that touch), time (the first contact of the motion from each state to the next) or limits (the joint that is farthest
    /// beyond its limits)
    #[arg(long, value_name = "WHAT")]
    pub(crate) ask: QueryKind,
    /// Joint states (a header of joint names, then a row of radians or metres per state; - is standard input);
    /// default: the start state
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) states: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) effort: EffortArgs,
    /// A file of pairs that may touch, and of weights (docs/query.md); beside the cell's own
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) pairs: Option<PathBuf>,
    /// Only these pairs: robots, links as robot/link, objects or regions; with --urdf links, or `robot` for all of them
    #[arg(long, value_name = "A,B;C,D…")]
    pub(crate) between: Option<String>,
    /// Leave out pairs within one robot
    #[arg(long)]
    pub(crate) no_self: bool,
    /// The robot holds this object: as its program grips it, else in their relative pose at the start; may be repeated
    #[arg(long, value_name = "ROBOT=OBJECT", conflicts_with = "urdf")]
    pub(crate) carry: Vec<String>,
    /// A row for each pair no farther apart than this (metres), the nearest first, instead of one row per state
    #[arg(long, value_name = "METRES", value_parser = margin, allow_negative_numbers = true)]
    pub(crate) all_pairs: Option<f64>,
    /// Print one JSON document instead of CSV
    #[arg(long)]
    pub(crate) json: bool,
}

/// How a query finds its answers.
#[derive(Debug, Args)]
pub(crate) struct EffortArgs {
    /// Resolution level: auto, L1, L2, L2:1 to L2:8 (depths of each link's box tree), L3, capsule or hull. All except auto
    /// and L3 are conservative
    #[arg(long, default_value = "auto")]
    pub(crate) level: Level,
    /// With --level auto: the coarsest level that may answer, L1, L2 or L3; answers stay the same
    #[arg(long, value_name = "LEVEL", default_value = "L1")]
    pub(crate) start: Level,
    /// Test pairs also if they are proven out of reach of each other; answers stay the same
    #[arg(long)]
    pub(crate) no_matrix: bool,
    /// Test pairs in the order of the links, not the likeliest first; of several contacts another may be named
    #[arg(long)]
    pub(crate) no_weights: bool,
    /// Also print the time per state and the levels that answered, on standard error or in the JSON document
    #[arg(long)]
    pub(crate) times: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom convert arm.3ds --out arm                  arm/arm.urdf and arm/meshes/*.stl
  elbowroom convert arm.urdf --out arm --to 3ds        arm/arm.3ds and arm/arm.joints.toml
  elbowroom convert arm.glb --out arm --joint \"link_1: axis=z, min=-170, max=170, speed=100\"
  elbowroom convert cell.toml --robot ns16 --out ns16  the robot of a cell, with its tool and load
  elbowroom convert arm.urdf arm.srdf                  its groups, states, and the pairs that need no test
  elbowroom convert shelf.scene shelf.toml             a MoveIt planning scene (or .yaml) as objects of a cell file
  elbowroom convert log.mcap log.csv                   the joint states of a ROS 2 recording as a `trajectory`

Exit status: 0 if the files were written.")]
pub(crate) struct ConvertArgs {
    /// The robot: a URDF, a 3DS, GLB, glTF or VRML model, or a cell file that has it; or a planning scene (docs/models.md); or an
    /// MCAP recording of ROS 2 (in builds with the feature `live`)
    pub(crate) model: PathBuf,
    /// The output, a new file: .srdf for a robot, .toml for a planning scene, .csv for a recording
    #[arg(required_unless_present = "out", conflicts_with_all = ["out", "to"])]
    pub(crate) output: Option<PathBuf>,
    /// The output folder of --to
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// The output format; urdf,3ds for both
    #[arg(long, value_enum, value_delimiter = ',', default_value = "urdf")]
    pub(crate) to: Vec<Written>,
    /// The robot of a cell file; optional if there is only one
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// An SRDF that belongs to the model
    #[arg(long, value_name = "FILE")]
    pub(crate) srdf: Option<PathBuf>,
    /// Length unit of a 3DS model, or of a URDF's meshes whose format states none
    #[arg(long, value_enum)]
    pub(crate) unit: Option<Unit>,
    /// The topic of a recording; optional if there is only one with joint states
    #[arg(long, value_name = "TOPIC")]
    pub(crate) topic: Option<String>,
    #[command(flatten)]
    pub(crate) joints: JointArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Written {
    /// NAME.urdf, meshes/NAME/*.stl, and NAME.srdf if pairs are disabled
    Urdf,
    /// NAME.3ds, and NAME.joints.toml with the joints, which a 3DS file cannot hold
    #[value(name = "3ds")]
    Tds,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom map cell.toml                       a table of the blocked cells per object
  elbowroom map cell.toml --out map.npy --json  the cells as NumPy reads them, 0 free, 1 blocked
  elbowroom map cell.toml --page map.html       the slices in a browser, with a slider
  elbowroom map cell.toml --png slices          pictures, and the page slices/index.html
  elbowroom map cell.toml --exact               fewer cells blocked needlessly, tenths of a second per object
  elbowroom map cell.toml --page map.html --path path.csv       a path of `plan --out` over the slices
  elbowroom map cell.toml --model slices        a quick obstacle model of the paper; blocks more
  elbowroom map cell.toml --model spheres=64 --deadline 5   as many spheres as five milliseconds allow

Joints and steps are in [map.ROBOT] of the cell file; without it the first three joints, 2 degrees
(docs/map.md).
A cell is blocked if any configuration in it can touch an object.")]
pub(crate) struct MapArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The robot; optional if there is only one, or only one [map.ROBOT]
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// Obstacle model: exact, slices, sphere, spheres=N or box; or seeds, the paper's expansion, which misses cells
    #[arg(long, default_value = "exact")]
    pub(crate) model: MapModel,
    /// Decide border cells by the robot's own solids, not by sphere covers of its links (always so unless there are three joints)
    #[arg(long)]
    pub(crate) exact: bool,
    /// With --model spheres=N: one sphere around each object first, then 2, 4, 8 … up to N until this many milliseconds have
    /// passed; any number of spheres blocks every cell that the object blocks
    #[arg(long, value_name = "MS", value_parser = milliseconds, allow_negative_numbers = true, conflicts_with = "exact")]
    pub(crate) deadline: Option<f64>,
    /// Also tell which links block the cells of each object
    #[arg(long, conflicts_with = "deadline")]
    pub(crate) links: bool,
    /// Write the occupancy to this file: one byte per cell, 0 free, 1 blocked, axes in the order of the joints
    #[arg(long, value_name = "FILE.npy")]
    pub(crate) out: Option<PathBuf>,
    /// Write pictures of slices, and an HTML page with them, to this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) png: Option<PathBuf>,
    /// Write one page with the slices and a slider, which opens offline
    #[arg(long, value_name = "FILE.html")]
    pub(crate) page: Option<PathBuf>,
    /// Draw this path over the slices of --page, and count its rows in blocked cells: states of the robot, as `plan --out`
    /// writes them
    #[arg(long, value_name = "FILE.csv", requires = "page")]
    pub(crate) path: Option<PathBuf>,
    /// Print one JSON document instead of the table
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "The points are where the robot's TCP is at the states, in this order:
  sphere           centre, surface point          sphere4   four surface points
  cylinder         base centre, rim point, a point at the height of the top
  plane            origin, point on x, point in the xy plane (the region lies below)
  box              two opposite corners           box3      three base corners, and --height
  fence            three or more corners on the floor, in order, and --height of the walls

Example:
  elbowroom teach cell.toml --shape sphere --name lamp --states taught.csv >> cell.toml")]
pub(crate) struct TeachArgs {
    /// The cell file with the robot
    pub(crate) cell: PathBuf,
    #[command(flatten)]
    pub(crate) shape: TaughtShapeArgs,
    /// Name of the region
    #[arg(long)]
    pub(crate) name: String,
    /// Joint states of the taught points, one row per point
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) states: PathBuf,
    /// The robot that was moved to the points; optional if there is only one
    #[arg(long)]
    pub(crate) robot: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom watch cell.toml                                    pictures and joint values that the cell file names
  elbowroom watch cell.toml --frames pictures --joints q.csv   others
  elbowroom watch cell.toml --frames pictures --json | jq -c '{t_s, obstacles}'
  elbowroom watch cell.toml --clouds clouds --json             point clouds of [cloud.NAME]
  ffmpeg -loglevel error -f v4l2 -i /dev/video0 -f image2pipe -c:v png - | elbowroom watch cell.toml --frames -

DIR has pictures (*.png, *.pgm, *.ppm) or clouds (*.pcd, *.ply), in the order of their names, and times.csv with the
columns file,t_s. The first pictures show the empty cell. [camera.NAME] of the cell file has lens, pose and templates,
[cloud.NAME] the pose of the sensor (docs/vision.md).")]
pub(crate) struct WatchArgs {
    /// The cell file
    pub(crate) cell: PathBuf,
    /// The camera or cloud; optional if there is only one
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,
    /// The folder of pictures; default: `frames` of the camera. `-`: PNG pictures one after another from standard input
    #[arg(long, value_name = "DIR", conflicts_with = "clouds")]
    pub(crate) frames: Option<PathBuf>,
    /// The folder of point clouds; default: `clouds` of the cloud
    #[arg(long, value_name = "DIR")]
    pub(crate) clouds: Option<PathBuf>,
    /// Pictures per second of the stream; default: each picture has its time of arrival
    #[arg(long, value_name = "RATE", requires = "frames")]
    pub(crate) fps: Option<f64>,
    /// Joint values over time (`t_s` and a column per joint); default: `joints` of the camera, or the robots' start
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) joints: Option<PathBuf>,
    /// Print one JSON document per picture, a line each
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct SweepArgs {
    /// TOML file of the task: the model, its states, and what is asked about them
    pub(crate) task: PathBuf,
    /// Folder for the Parquet parts and `manifest.json`; a sweep that was interrupted goes on there [default: the task's]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Where the work is done: `local` or `ray` [default: the task's]
    #[arg(long, value_name = "WHERE")]
    pub(crate) executor: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct ExampleArgs {
    /// Copy all examples and their models to this folder; without it they are listed
    pub(crate) dir: Option<PathBuf>,
}
