//! `cargo xtask peers`: elbowroom and the other libraries on one workload, on one core, in one run.
//!
//! `xtask/peers/README.md` has the workload's format and the protocol of the runners.

mod agreement;
mod answers;
mod groups;
mod install;
mod measure;
mod report;
mod runner;
mod targets;
mod witness;
mod workload;

use std::path::{Path, PathBuf};

use xtask::shell;

use crate::machine;
use install::Ready;
use report::Line;
use runner::Runner;

/// Options of the command line.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Options {
    data: Option<PathBuf>,
    json: bool,
}

impl Options {
    /// Parses the words after `peers`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(&word) = words.next() {
            match word {
                "--json" => options.json = true,
                "--data" => {
                    let folder = words.next().ok_or("`--data` needs the folder with the workload: `--data DIR`")?;
                    options.data = Some(PathBuf::from(folder));
                }
                _ => return Err(format!("`peers {word}`: the options are `--data DIR` and `--json`")),
            }
        }
        Ok(options)
    }
}

/// Installs, measures, compares and prints; an unexplained answer of elbowroom is an error.
pub fn run(root: &Path, options: &Options) -> Result<(), String> {
    let folder = root.join("target/peers");
    shell::make_folder(&folder)?;
    let workload = workload::prepare(root, &folder, options.data.as_deref())?;
    let peers = install::all(root, &folder);
    let (mut runners, mut missing) = start(&peers, &workload, root)?;
    let groups = groups::of(&runners, &only());
    let (mut lines, mut notes) = (Vec::new(), Vec::new());
    for (done, group) in groups.iter().enumerate() {
        eprintln!("[{}/{}] {} {}", done + 1, groups.len(), group.set, group.query);
        let times = measure::group(group, &mut runners);
        let checked = answers::check(group, &groups, &times, &mut runners, &folder);
        lines.extend(checked.lines);
        notes.extend(checked.notes);
    }
    missing.extend(runners.iter().filter_map(|runner| runner.failure().map(str::to_owned)));
    for line in &lines {
        if options.json {
            println!("{}", line.json());
        }
    }
    let table = report::table(&lines, &peers, &notes, &missing);
    if options.json {
        eprint!("{table}");
    } else {
        print!("{table}");
    }
    verify(&lines)
}

/// Starts the runners: elbowroom must run; other runners that do not start are named and left out.
fn start(peers: &[Ready], workload: &workload::Workload, root: &Path) -> Result<(Vec<Runner>, Vec<String>), String> {
    let core = machine::core();
    let ours = [workload.elbowroom.display().to_string(), "serve".to_owned()];
    let mut runners = vec![Runner::start("elbowroom", &ours, workload, root, core)?];
    let mut missing = Vec::new();
    for peer in peers {
        let started = match &peer.program {
            Ok(program) => {
                let command = vec![program.display().to_string()];
                Runner::start(peer.name, &command, workload, root, core)
            }
            Err(reason) => Err(reason.clone()),
        };
        match started {
            Ok(runner) => runners.push(runner),
            Err(reason) => {
                eprintln!("{} is left out: {reason}", peer.name);
                missing.push(format!("{} is left out: {reason}", peer.name));
            }
        }
    }
    Ok((runners, missing))
}

fn verify(lines: &[Line]) -> Result<(), String> {
    let wrong: usize = lines.iter().filter(|line| line.is_ours()).map(|line| line.disagreements).sum();
    if wrong == 0 { Ok(()) } else { Err(format!("{wrong} answers of elbowroom differ and nothing explains them")) }
}

/// Returns the part of `lib|set|query` that selects lines; other lines are left out.
fn only() -> String {
    std::env::var("ONLY").unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_mistakes_named() {
        let data = Some(PathBuf::from("d"));
        assert_eq!(Options::parse(&["--json", "--data", "d"]).unwrap(), Options { data, json: true });
        assert_eq!(Options::parse(&[]).unwrap(), Options::default());
        assert!(Options::parse(&["--data"]).unwrap_err().contains("--data DIR"));
        assert!(Options::parse(&["--dta"]).unwrap_err().contains("`peers --dta`"));
    }
}
