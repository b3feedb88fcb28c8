//! Arguments of `elbowroom plan --problems`.

use std::path::PathBuf;

use clap::Args;

/// A file of planning problems and its robot.
#[derive(Debug, Args)]
pub(crate) struct ProblemArgs {
    /// The robot of --problems: a URDF
    #[arg(long, value_name = "FILE", requires = "problems", help_heading = "Sets of planning problems")]
    pub(crate) urdf: Option<PathBuf>,
    /// The SRDF of the URDF: link pairs that it disables are not tested
    #[arg(long, value_name = "FILE", requires = "urdf", help_heading = "Sets of planning problems")]
    pub(crate) srdf: Option<PathBuf>,
    /// Planning problems in `MotionBenchMaker`'s layout, {SET: {ID: {scene, request}}} (docs/plan.md)
    #[arg(
        long,
        value_name = "FILE.json",
        requires = "urdf",
        conflicts_with_all = ["robot", "from", "to", "out"],
        help_heading = "Sets of planning problems"
    )]
    pub(crate) problems: Option<PathBuf>,
    /// Only these sets
    #[arg(
        long,
        value_name = "SET,…",
        value_delimiter = ',',
        requires = "problems",
        help_heading = "Sets of planning problems"
    )]
    pub(crate) only: Vec<String>,
    /// Only the first N problems of each set
    #[arg(
        long,
        value_name = "N",
        requires = "problems",
        value_parser = clap::value_parser!(u32).range(1..),
        help_heading = "Sets of planning problems"
    )]
    pub(crate) limit: Option<u32>,
    /// Write the timed path of each solved problem to SET-ID.csv in this folder
    #[arg(long, value_name = "DIR", requires = "problems", help_heading = "Sets of planning problems")]
    pub(crate) paths: Option<PathBuf>,
}
