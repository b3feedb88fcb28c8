//! Checks, generated files and benches of the workspace: `cargo xtask help` lists them.
#![allow(clippy::print_stdout, reason = "this program talks to the person who started it")]

mod contacts;
mod figures;
mod fuzz_cells;
mod judge;
mod layers;
mod models;
mod paths;
mod peers;
mod python;
mod release;
mod robots;
mod rpq;
mod scaling;
mod shell;
mod snippets;
mod solid;
mod suite;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HELP: &str = "\
cargo xtask COMMAND

  test [--only STEP]… [--list] [--offline]
        installs what the tests need and runs every check; --list names the steps.
        --offline installs nothing and says what it therefore leaves out
  layers
        who may depend on whom, and that every crate takes the workspace lints
  models [--check]
        writes the generated robots and tools under examples/models; --check compares instead
  figures [--check]
        writes the figures of docs/laws.md under docs/figures; --check compares instead
  fuzz [SECONDS]
        throws mutated files at every parser, SECONDS each (default 60)
  fuzz cells [--count N] [--kind stop|exchange|faults|all] [--seed S] [--case I] [--no-shrink] [--json]
        runs N random cells (default 1000) of each kind under the monitor, and judges the recordings by kinematics and
        distances of its own, between ticks too: nobody enters, never two in an exchange region, no silent deadlock.
        Failing cells are made smaller and written to target/fuzz-cells
  fuzz cells --replay FILE
        runs one cell file under the same judge; lines `# fault: …` in it are injected
  rpq [--states N] [--out DIR] [--json]
        the paper's test of proximity queries: two RX60B at five distances, N states (default 5000), time per query by
        resolution level, pair matrix and weight matrix; --out writes the figures of docs/rpq.md
  judge [--data DIR] [--states N] [--only NAME] [--json]
        every robot and cell of DIR (default ../shared/data) beside Pinocchio and Coal: distances and contacts on N random
        states (default 200; 10000 with ELBOWROOM_LONG=1), and the pair matrix beside the SRDF
  contacts [--data DIR] [--states N] [--only NAME]
        the collision point beside Coal: robots of DIR just within a contact with themselves, a box and a mesh, N states each
        (default 100; 2500 with ELBOWROOM_LONG=1): point, triangles, normals, the link nearest to the base
  paths [--pairs N] [--robot-pairs N] [--points N] [--data DIR] [--only NAME] [--json]
        planned paths beside Coal: N random starts and goals in each of three cells of the joint-space map (default 1000) and for
        each of six robots of DIR among boxes (default 40); every path and every timed motion at N points (default 10000)
  peers [--data DIR] [--json]
        elbowroom beside Coal, FCL and parry on one workload: installs them in target/peers, compares every answer, and
        prints the ratios. DIR holds a workload in the format of xtask/peers/README.md. BUDGET: seconds per round
        (default 0.5); ONLY: part of `lib|set|query`
  scaling [--out DIR]
        time and memory of meshes of 1,000 to 2,000,000 triangles; --out writes the figures of docs/benchmarks.md
  bench [ARGS…]
        cargo bench, with ARGS

Exit status: 0 all well, 1 a check failed, 2 the call is wrong.
";

/// The parsers that `fuzz` throws files at, besides the cell file's.
const PARSERS: [&str; 9] = ["urdf", "srdf", "stl", "obj", "dae", "gltf", "ply", "off", "mesh"];

/// What went wrong, in the words to print.
enum Failure {
    /// A check found something: exit 1.
    Check(String),
    /// The command line makes no sense: exit 2.
    Usage(String),
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Check(message)
    }
}

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    match dispatch(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Check(message)) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            eprintln!("error: {message}\n\n{HELP}");
            ExitCode::from(2)
        }
    }
}

fn dispatch(words: &[&str]) -> Result<(), Failure> {
    let root = workspace_root()?;
    match words {
        [] | ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            Ok(())
        }
        ["test", options @ ..] => suite::run(&root, &suite::Options::parse(options).map_err(Failure::Usage)?),
        ["layers"] => Ok(layers::run(&root)?),
        ["models"] => Ok(models::write(&root)?),
        ["models", "--check"] => Ok(models::check(&root)?),
        ["figures"] => Ok(figures::write(&root)?),
        ["figures", "--check"] => Ok(figures::check(&root)?),
        ["fuzz", "cells", rest @ ..] => {
            fuzz_cells::run(&root, &fuzz_cells::Options::parse(rest).map_err(Failure::Usage)?)
        }
        ["fuzz"] => fuzz(&root, "60"),
        ["fuzz", seconds] => fuzz(&root, seconds),
        ["judge", rest @ ..] => judge::run(&root, rest),
        ["contacts", rest @ ..] => contacts::run(&root, rest),
        ["paths", rest @ ..] => paths::run(&root, rest),
        ["rpq", rest @ ..] => rpq::run(&root, rest),
        ["peers", options @ ..] => Ok(peers::run(&root, &peers::Options::parse(options).map_err(Failure::Usage)?)?),
        ["scaling"] => Ok(scaling::run(&root, None)?),
        ["scaling", "--out", folder] => Ok(scaling::run(&root, Some(Path::new(folder)))?),
        ["bench", rest @ ..] => {
            let args: Vec<&str> = ["bench", "--workspace"].iter().chain(rest).copied().collect();
            Ok(shell::cargo(&root, &args, &[])?)
        }
        _ => Err(Failure::Usage(format!("unknown call `{}`", words.join(" ")))),
    }
}

fn fuzz(root: &Path, seconds: &str) -> Result<(), Failure> {
    if seconds.parse::<u64>().is_err() {
        return Err(Failure::Usage(format!("`fuzz {seconds}`: SECONDS is a whole number")));
    }
    let example = |package, name| ["run", "--quiet", "--release", "-p", package, "--example", name, "--"];
    for parser in PARSERS {
        let mut args = example("elbowroom-formats", "fuzz").to_vec();
        args.extend([parser, seconds]);
        // Real files, where they are, damage more interestingly than the built-in samples.
        let data = root.join("../shared/data").display().to_string();
        args.push(&data);
        shell::cargo(root, &args, &[])?;
    }
    let mut args = example("elbowroom-cell", "fuzz_cell").to_vec();
    args.extend(["examples/figure12/cell.toml", seconds]);
    Ok(shell::cargo(root, &args, &[])?)
}

/// The value of an option that counts something.
fn count(option: &str, value: &str) -> Result<usize, String> {
    let number = value.parse().ok().filter(|n| *n > 0);
    number.ok_or_else(|| format!("`{option} {value}`: write a whole number of 1 or more"))
}

/// Where the real robots are: as told, or as `ELBOWROOM_DATA` has it, or beside the workspace.
fn data_folder(root: &Path, told: Option<&Path>) -> PathBuf {
    let told = told.map(Path::to_path_buf).or_else(|| std::env::var_os("ELBOWROOM_DATA").map(PathBuf::from));
    told.unwrap_or_else(|| root.join("../shared/data"))
}

/// The directory above `xtask`, wherever the command was started.
fn workspace_root() -> Result<PathBuf, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().map(Path::to_path_buf).ok_or_else(|| format!("{} has no parent directory", here.display()))
}
