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
    let (script, peers) = if options.validity {
        ("validity.py", states(root, &folder, &python))
    } else if options.anytime {
        ("anytime.py", anytime_planners(root, &folder, &python))
    } else {
        ("planning.py", planners(root, &folder, &python))
    };
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

/// Makes the file that a planner needs, or says why it cannot run.
type Get<'a> = &'a dyn Fn() -> Result<String, String>;

/// Returns every planner that the variable `ONLY` names, with its file.
fn chosen(every: &[(&'static str, Get)]) -> Vec<Peer> {
    let only = std::env::var("ONLY").unwrap_or_default();
    every.iter().filter(|(name, _)| name.contains(&only)).map(|(name, get)| (*name, get())).collect()
}

fn planners(root: &Path, folder: &Path, python: &Path) -> Vec<Peer> {
    chosen(&[
        ("elbowroom", &|| elbowroom::program(root)),
        ("vamp", &|| vamp::program(root, folder, python, "vamp_plan")),
        ("plainmp", &|| install::plainmp(folder).map(|()| String::new())),
        ("plainmp+vamp_spheres", &|| install::plainmp(folder).and_then(|()| vamp::spheres(folder, python))),
        ("ompl", &|| Ok(String::new())),
    ])
}

/// Returns the planners that shorten their paths.
fn anytime_planners(root: &Path, folder: &Path, python: &Path) -> Vec<Peer> {
    let vamp = || vamp::program(root, folder, python, "vamp_anytime");
    chosen(&[("elbowroom", &|| elbowroom::program(root)), ("vamp_aorrtc", &vamp), ("vamp_fcit", &vamp)])
}

/// Returns the peers that can check single states.
fn states(root: &Path, folder: &Path, python: &Path) -> Vec<Peer> {
    vec![("elbowroom", elbowroom::state_times(root)), ("vamp", vamp::program(root, folder, python, "vamp_states"))]
}

fn on_one_core() -> Vec<String> {
    let core = machine::core().filter(|_| native::exists("taskset"));
    core.map_or_else(Vec::new, |core| ["taskset", "-c", &core.to_string()].map(str::to_owned).to_vec())
}
