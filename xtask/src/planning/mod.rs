//! `cargo xtask planning`: elbowroom's planner and others on the same problems, on one core, in one run.
//!
//! `xtask/planning/README.md` has the files and programs; the measurement itself is in Python, which other planners
//! need anyway.

mod elbowroom;
mod files;
mod hits;
mod install;
mod options;
mod vamp;

use std::path::Path;

use xtask::shell;

use crate::{machine, native};
use files::Files;
pub use options::Options;

/// Installs, then starts the Python program that measures; a peer that cannot be installed is named and left out.
pub fn run(root: &Path, options: &Options) -> Result<(), String> {
    let files = Files::find(root, options)?;
    let folder = root.join("target/planning");
    shell::make_folder(&folder)?;
    let python = install::python(&folder)?;
    let peers = if options.validity { states(root, &folder, &python) } else { planners(root, &folder, &python) };
    let script = if options.validity { "validity.py" } else { "planning.py" };
    let mut words = on_one_core();
    // -B: no compiled Python beside the sources.
    words.extend([python.display().to_string(), "-B".into()]);
    words.push(root.join("xtask/planning/python").join(script).display().to_string());
    words.extend(files.words(options.validity));
    words.extend(["--folder".into(), folder.display().to_string()]);
    if !options.validity {
        words.extend(["--hits".into(), hits::program(root, &folder)?.display().to_string()]);
    }
    words.extend(options.json.then(|| "--json".to_owned()));
    for (name, program) in peers {
        match program {
            Ok(program) => words.push(format!("{name}={program}")),
            Err(reason) => words.push(format!("{name}!{}", reason.lines().next().unwrap_or_default())),
        }
    }
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    native::show(root, &words)
}

type Peer = (&'static str, Result<String, String>);

/// Returns every planner with the file it needs, or the reason why it cannot run.
fn planners(root: &Path, folder: &Path, python: &Path) -> Vec<Peer> {
    let only = std::env::var("ONLY").unwrap_or_default();
    let mut peers: Vec<Peer> = Vec::new();
    let mut add = |name: &'static str, get: &dyn Fn() -> Result<String, String>| {
        if name.contains(&only) {
            peers.push((name, get()));
        }
    };
    add("elbowroom", &|| elbowroom::program(root));
    add("vamp", &|| vamp::program(root, folder, python, "vamp_plan"));
    add("plainmp", &|| install::plainmp(folder).map(|()| String::new()));
    add("plainmp+vamp_spheres", &|| install::plainmp(folder).and_then(|()| vamp::spheres(folder, python)));
    add("ompl", &|| Ok(String::new()));
    peers
}

/// Returns the peers that can check single states.
fn states(root: &Path, folder: &Path, python: &Path) -> Vec<Peer> {
    vec![("elbowroom", elbowroom::state_times(root)), ("vamp", vamp::program(root, folder, python, "vamp_states"))]
}

fn on_one_core() -> Vec<String> {
    let core = machine::core().filter(|_| native::exists("taskset"));
    core.map_or_else(Vec::new, |core| ["taskset", "-c", &core.to_string()].map(str::to_owned).to_vec())
}
