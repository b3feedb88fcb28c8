//! Checks, generated files and benches of the workspace: `cargo xtask help` lists them.
//!
//! This program is small, so that the first check runs after seconds. Commands that need the product's own crates are
//! in the program `elbowroom-devtools`, which it starts: in the profile of the tests for checks, as a release build for
//! measurements.
//!
//! **Invariant.** If a step of `test` fails, the steps after it always run nevertheless, and the exit status is always 1.
#![allow(clippy::print_stdout, reason = "this program talks to the person who started it")]

mod artifacts;
mod compile;
mod dependents;
mod dist;
mod documents;
mod faults;
mod functions;
mod inventory;
mod layers;
mod machine;
mod native;
mod peers;
mod planning;
mod quick;
mod references;
mod snippets;
mod soak;
mod suite;
mod test_run;
mod wheel;
mod workspace;

use std::path::Path;
use std::process::ExitCode;

use xtask::call::{self, Failure, workspace_root};
use xtask::shell;

const HELP: &str = "\
cargo xtask COMMAND

  test [--only STEP]… [--list] [--offline] [--again]
        installs what the tests need and runs every check; --list names the steps.
        Tests that passed do not run again before their program or a file that they may read changes; with --again they do.
        --offline installs nothing and says what it therefore leaves out
  quick [--since COMMIT]
        formats, layers, documents; lints and tests of the crates that differ from COMMIT (default HEAD) and of all that
        depend on them
  soak [NAME]…
        runs of minutes to hours that the suite leaves out; without a name, lists them (docs/measurements/soak.md)
  layers [--write]
        who may depend on whom, that every crate takes the workspace lints, and no circles of files inside a crate; limits
        of size, whose exceptions are in xtask/ratchet.toml, and no public item that nothing reaches.
        --write lowers and removes exceptions that are too large; it adds none
  faults [--only NAME]… [--list] [--check]
        plants each fault of xtask/faults.toml in a copy of the committed sources and runs the tests of its crate, then those
        of the crates that depend on it, until one fails; fails itself if a fault is not found. --list names the faults,
        --check only sees that every one can be planted
  dist
        the library for C and C++ as a release build: shared library, headers, package file of pkg-config, example and licences in
        target/dist/elbowroom-VERSION-TARGET, and as an archive (docs/c-api.md)
  wheel [--manylinux]
        the Python package as a wheel in target/wheels; its tests run with it in a new environment (docs/python.md); --manylinux:
        for every Linux with glibc 2.28 or newer (docs/releasing.md)
  documents
        no long line, no broken link, no unknown name in documents
  inventory [DIR]
        files, lines and public items of every crate, and how long files and functions get; DIR: of another checkout
  models [--check]
        writes the generated robots and tools under examples/models; --check compares instead
  figures [--check]
        writes the figures of the documents under docs/figures; --check compares instead
  reference [--check]
        writes the keys of docs/cell-file.md, the verbs of docs/commands.md and docs/options.md; --check compares instead
  fuzz [SECONDS]
        throws mutated files at every parser, SECONDS each (default 60)
  fuzz parser PARSER SECONDS [DIR [SEED]]
        the same for one of stl obj dae gltf ply off 3ds wrl urdf srdf scene yaml mesh, with the files of DIR too
  fuzz cell-file FILE SECONDS [SEED]
        the same for a cell file, which is also run for a few ticks
  fuzz cells [--count N] [--kind stop|exchange|faults|moving|tools|recordings|all] [--seed S] [--case I] [--no-shrink] [--keys] [--json]
        runs N random cells (default 1000) of each kind under the monitor, and checks the recordings by kinematics and
        distances of its own, between ticks too: nobody enters, never two in an exchange region, no silent deadlock.
        Failing cells are made smaller and written to target/fuzz-cells
  fuzz cells --replay FILE
        runs one cell file under the same oracle; lines `# fault: …` in it are injected
  golden [--data DIR] [--rows N] [--cells N] [--seeds N] [--only queries|overrides|plans] [--out FILE] [--against FILE]
        [--json]
        hashes of the exact bits of many answers: queries of N random states (default 1,000,000) over the robots of DIR, every
        tick of N random cells (default 1000) under the monitor, paths of the problems of DIR with N seeds each (default 5).
        --out records them, --against names each group that is not as recorded
  rpq [--states N] [--out DIR] [--json]
        the paper's test of proximity queries: two RX60B at five distances, N states (default 5000), time per query by
        resolution level, allowed collision matrix and weight matrix; --out writes the figures of docs/measurements/rpq.md
  evade [RUNS] [CELL] [--noise-mm N] [--delay-ms N] [--add FILE] [--csv FILE]
        RUNS runs (default 100) of a palletizer whose path a cart crosses at random, without and with avoidance; --add
        adds the tables of FILE to the cell. EVADE_ONLY: numbers of runs to make and show, as 135,160; EVADE_EXPLAIN:
        how many motions to search for an escape before each hit. evade --robots: the time of a step for every robot of
        the data (../shared/data)
  cross-validate [--data DIR] [--states N] [--only NAME] [--json]
        every robot and cell of DIR (default ../shared/data) beside Pinocchio and Coal: distances and contacts on N random
        states (default 200; 10000 with ELBOWROOM_LONG=1), and the allowed collision matrix beside the SRDF
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
  planning [--problems FILE] [--urdf R] [--srdf S] [--json]
        elbowroom's planner beside VAMP, plainmp and OMPL on problems in MotionBenchMaker's layout: installs them in
        target/planning, runs every seed of each, and checks every path at 10,000 points against the true meshes.
        Default: the Panda problems of ../shared/data. SEEDS: how many (default 5); ONLY: part of a library's name;
        ELBOWROOM: a built program to use instead of building one
  planning --validity [--urdf R] [--srdf S] [--json]
        how long it takes to say that a state is free, among 10, 100 and 1000 obstacles: along edges, and one by one
  planning --anytime [--problems FILE] [--urdf R] [--srdf S] [--json]
        the length of the best path after 1, 10 and 100 ms: `plan --optimize` beside VAMP's AORRTC and FCIT*
        (SEEDS: default 2)
  scaling [--out DIR]
        growth of times and memory with triangles, obstacles, robots, regions, rows and nodes, and the exponent of each; takes
        some five minutes; --out writes the figures of docs/measurements/growth.md

Exit status: 0 all well, 1 a check failed, 2 the call is wrong.
";

/// Parsers that `fuzz` tests, besides the cell file's.
const PARSERS: [&str; 13] =
    ["urdf", "srdf", "scene", "yaml", "stl", "obj", "dae", "gltf", "ply", "off", "3ds", "wrl", "mesh"];

/// Commands of `elbowroom-devtools` that measure or run long: they use a release build.
const MEASURING: [&str; 6] = ["cross-validate", "contacts", "evade", "golden", "paths", "rpq"];

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    call::exit(dispatch(&words), HELP)
}

fn dispatch(words: &[&str]) -> Result<(), Failure> {
    let root = workspace_root()?;
    match words {
        [] | ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            Ok(())
        }
        ["test", options @ ..] => suite::run(&root, &suite::Options::parse(options).map_err(Failure::Usage)?),
        ["quick"] => Ok(quick::run(&root, "HEAD")?),
        ["quick", "--since", commit] => Ok(quick::run(&root, commit)?),
        ["soak", names @ ..] => soak::run(&root, names),
        ["dist"] => Ok(dist::run(&root)?),
        ["wheel"] => Ok(wheel::run(&root, false)?),
        ["wheel", "--manylinux"] => Ok(wheel::run(&root, true)?),
        ["layers"] => Ok(layers::run(&root)?),
        ["layers", "--write"] => Ok(layers::write(&root)?),
        ["inventory"] => Ok(inventory::run(&root)?),
        ["inventory", folder] => Ok(inventory::run(Path::new(folder))?),
        ["faults", options @ ..] => faults::run(&root, &faults::Options::parse(options).map_err(Failure::Usage)?),
        ["documents"] => Ok(documents::run(&root)?),
        // It asks the command for its options, so both programs are compiled.
        ["reference", ..] => Ok(suite::devtools(&root, words)?),
        ["models" | "figures" | "scaling", ..] | ["fuzz", "cells", ..] => devtools(&root, words, &[]),
        [command, ..] if MEASURING.contains(command) => devtools(&root, words, &["--release"]),
        ["fuzz", "parser" | "cell-file", ..] => devtools(&root, words, &["--release"]),
        ["fuzz"] => fuzz(&root, "60"),
        ["fuzz", seconds] => fuzz(&root, seconds),
        ["peers", options @ ..] => Ok(peers::run(&root, &peers::Options::parse(options).map_err(Failure::Usage)?)?),
        ["planning", options @ ..] => {
            Ok(planning::run(&root, &planning::Options::parse(options).map_err(Failure::Usage)?)?)
        }
        _ => Err(Failure::Usage(format!("unknown call `{}`", words.join(" ")))),
    }
}

/// Runs a command of `elbowroom-devtools`. It prints nothing itself: a program may read the standard output.
fn devtools(root: &Path, words: &[&str], profile: &[&str]) -> Result<(), Failure> {
    let run = ["run", "--quiet", "--package", "elbowroom-devtools"];
    let args: Vec<&str> = run.iter().chain(profile).chain(&["--"]).chain(words).copied().collect();
    let covers = suite::own_covers(root);
    match shell::cargo_status(root, &args, suite::covers_of(words, &covers).as_slice())? {
        0 => Ok(()),
        2 => Err(Failure::Usage(format!("`{}` is not understood", words.join(" ")))),
        status => Err(Failure::Check(format!("`{}` ended with exit status {status}", words.join(" ")))),
    }
}

fn fuzz(root: &Path, seconds: &str) -> Result<(), Failure> {
    if seconds.parse::<u64>().is_err() {
        return Err(Failure::Usage(format!("`fuzz {seconds}`: SECONDS is a whole number")));
    }
    let fuzz = |words: &[&str]| devtools(root, &[&["fuzz"], words].concat(), &["--release"]);
    // If real files exist, they make better starting points for damage than the built-in samples.
    let data = xtask::call::data_folder(root, None).display().to_string();
    for parser in PARSERS {
        fuzz(&["parser", parser, seconds, &data])?;
    }
    fuzz(&["cell-file", "examples/figure12/cell.toml", seconds])
}
