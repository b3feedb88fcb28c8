//! Arguments of `elbowroom plan`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::arg_values::{Configuration, KeptAxisArg, LinkPoint, Numbers, seconds};

#[derive(Debug, Args)]
#[command(after_help = "Examples:
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0     from the robot's start
  elbowroom plan cell.toml --robot arm --from -0.5,0,0,0,0,0 --to 0.5,0,0,0,0,0 --json
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0 --out path.csv
  elbowroom plan cell.toml --robot arm --from home --to-pose 900,200,700,180,0,0   millimetres and degrees, as in the cell
  elbowroom plan cell.toml --robot arm --point link_3,0,0,80 --to-point 700,200,900   a point of a link; mm in this cell
  elbowroom plan cell.toml --robot arm --from home --to-pose 900,200,700,180,0,0 --linear       straight
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0 --keep z=5            what the gripper holds stays upright
  elbowroom plan cell.toml --robot arm --to 0.5,-0.3,1.2,0,0,0 --clearance 0.02 --time-limit 20
  elbowroom plan cell.toml --robot left --to reach --robot right --to home --out both.csv   both at the same time
  elbowroom plan --urdf arm.urdf --srdf arm.srdf --problems problems.json
  elbowroom plan --urdf arm.urdf --problems problems.json --only shelf --limit 10 --paths paths

--out writes timed samples for the controller.
Obstacles are the objects, the other robots at their start, and the robot itself with tool and
load, by the allowed collision matrix of the cell; the volumes that the monitor guards stay out of
permanent forbidden regions.
Exit status: 1 if no path was found; a path may exist nevertheless (docs/plan.md). With --problems:
1 if a problem with a free start and a free goal was not solved.")]
pub(crate) struct PlanArgs {
    /// The cell file; or --urdf with --problems
    #[arg(required_unless_present = "urdf", conflicts_with = "urdf")]
    pub(crate) cell: Option<PathBuf>,
    /// Name of the robot; optional if there is only one. Several robots move at the same time: --robot, --from and --to for
    /// each, in the same order
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Vec<String>,
    /// Start configuration: a comma-separated value per joint in chain order, rad (m for prismatic joints), or the name
    /// of one of the robot's `states`, or `start`; default: its `start`
    #[arg(long, value_name = "q,…|NAME", allow_hyphen_values = true)]
    pub(crate) from: Vec<Configuration>,
    #[command(flatten)]
    pub(crate) goal: GoalArgs,
    #[command(flatten)]
    pub(crate) tcp: TcpArgs,
    /// --from and --to are in the cell file's units, as in a program
    #[arg(long, conflicts_with = "urdf")]
    pub(crate) cell_units: bool,
    /// The robot holds this object: as its program grips it, else in their relative pose at the start; may be repeated
    #[arg(long, value_name = "ROBOT=OBJECT", conflicts_with = "urdf")]
    pub(crate) carry: Vec<String>,
    /// Write the timed trajectory to this file: `t_s` and a column per joint, linear between rows
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) out: Option<PathBuf>,
    /// Write a page that plays the path in the 3-D scene, with the distances from regions, and opens offline
    #[arg(long, value_name = "FILE.html", conflicts_with = "urdf")]
    pub(crate) report: Option<PathBuf>,
    /// Sampling period in seconds; default: the cell's control period, 0.002 with --problems
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) period: Option<f64>,
    #[command(flatten)]
    pub(crate) search: SearchArgs,
    #[command(flatten)]
    pub(crate) problems: crate::plan_problems::args::ProblemArgs,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where a path ends.
#[derive(Debug, Args)]
pub(crate) struct GoalArgs {
    /// Goal configuration, as --from
    #[arg(long, value_name = "q,…|NAME", allow_hyphen_values = true, required_unless_present_any = ["urdf", "to_pose", "to_point"])]
    pub(crate) to: Vec<Configuration>,
    /// Goal as a pose of the TCP in the world, in the cell file's units: x,y,z,roll,pitch,yaw or x,y,z,qx,qy,qz,qw
    #[arg(long, value_name = "x,y,z,r,p,y", allow_hyphen_values = true, conflicts_with_all = ["to", "urdf"])]
    pub(crate) to_pose: Option<Numbers>,
    /// Arm configuration at --to-pose, for six axes with a spherical wrist: front or back, up or down, `no_flip` or flip, or
    /// some of them
    #[arg(long, value_name = "WORD,…", value_delimiter = ',', requires = "to_pose", conflicts_with_all = ["to", "to_point"])]
    pub(crate) configuration: Vec<String>,
    /// Use only the solution for --to-pose that is nearest to these joint values, as --from
    #[arg(long, value_name = "q,…|NAME", allow_hyphen_values = true, requires = "to_pose", conflicts_with_all = ["to", "to_point"])]
    pub(crate) near: Option<Configuration>,
    /// Goal of a point: the link it belongs to, and its coordinates in the link's frame, in the cell file's units
    /// (`inspect --at` has its chain)
    #[arg(long, value_name = "LINK,x,y,z", allow_hyphen_values = true, requires = "to_point", conflicts_with_all = ["to", "to_pose", "urdf"])]
    pub(crate) point: Option<LinkPoint>,
    /// Where --point ends in the world, in the cell file's units; the link may turn as it likes
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true, requires = "point", conflicts_with_all = ["to", "to_pose", "urdf"])]
    pub(crate) to_point: Option<Numbers>,
}

/// How the TCP moves.
#[derive(Debug, Args)]
pub(crate) struct TcpArgs {
    /// The TCP moves straight to --to-pose, in one posture
    #[arg(long, requires = "to_pose", conflicts_with_all = ["keep", "configuration", "near", "optimize", "urdf"])]
    pub(crate) linear: bool,
    /// An axis of the TCP keeps the direction that it has at the start, within an angle in the cell file's unit: z=5, or
    /// 0,0.7,0.7=5
    #[arg(long, value_name = "AXIS=ANGLE", allow_hyphen_values = true, conflicts_with = "urdf")]
    pub(crate) keep: Option<KeptAxisArg>,
}

/// Search options of a path.
#[derive(Debug, Args)]
pub(crate) struct SearchArgs {
    /// rrt-connect: any joints, proven on sphere covers and in the exact scene; grid: through the free cells of the robot's
    /// joint-space map (`[map.NAME]`), for three joints
    #[arg(long, value_enum, default_value_t = Planner::RrtConnect, conflicts_with = "urdf")]
    pub(crate) planner: Planner,
    /// Time limit of the search in seconds; with --problems, of each problem
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) time_limit: f64,
    /// Search for shorter paths until the time limit
    #[arg(long)]
    pub(crate) optimize: bool,
    /// Security margin to all obstacles, in metres
    #[arg(long, value_name = "METRES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub(crate) clearance: f64,
    /// Seed of the random sampling; the same seed gives the same path
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
}

/// The planners of `elbowroom plan`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Planner {
    /// Two trees of random samples
    RrtConnect,
    /// Free cells of a map
    Grid,
}
