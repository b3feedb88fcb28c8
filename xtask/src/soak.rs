//! `cargo xtask soak`: runs of minutes to hours, which are not part of the checks of a change.

use std::path::Path;
use std::time::Instant;

use xtask::{Failure, shell};

/// A long run.
struct Run {
    name: &'static str,
    what: &'static str,
    /// Arguments of `cargo`.
    words: &'static [&'static str],
    env: &'static [(&'static str, &'static str)],
}

const LONG: (&str, &str) = ("ELBOWROOM_LONG", "1");

/// The runs; `docs/measurements/soak.md` has their results.
const RUNS: [Run; 18] = [
    Run {
        name: "geometry",
        what: "random pairs of shapes and meshes, motions and sweeps beside their oracles, up to a million each",
        words: &["test", "--release", "-p", "elbowroom-proximity", "-p", "elbowroom-scene"],
        env: &[LONG],
    },
    Run {
        name: "topology",
        what: "the edges of a mesh of a million triangles, in well under a second",
        words: &[
            "test",
            "--release",
            "-p",
            "elbowroom-proximity",
            "--lib",
            "--",
            "--ignored",
            "million",
            "--nocapture",
        ],
        env: &[],
    },
    Run {
        name: "chains",
        what: "100,000 random chains through every form of Denavit-Hartenberg parameters, every robot as VRML",
        words: &["test", "--release", "-p", "elbowroom-kinematics", "-p", "elbowroom-formats"],
        env: &[LONG],
    },
    Run {
        name: "maps",
        what: "joint-space maps of real robots, cell by cell",
        words: &["test", "--release", "-p", "elbowroom-cspace", "--test", "main", "--", "--ignored", "--nocapture"],
        env: &[],
    },
    Run {
        name: "floors",
        what: "100,800 pictures of floors with little contrast under a lamp that changes, a crate in every tenth",
        words: &["test", "--release", "-p", "elbowroom-vision", "--test", "main", "plain_floors::"],
        env: &[LONG],
    },
    Run {
        name: "schedules",
        what: "100,000 random schedules of faults between controllers that exchange regions",
        words: &[
            "test",
            "--release",
            "-p",
            "elbowroom-interlock",
            "--test",
            "main",
            "fault_schedules::",
            "--",
            "--nocapture",
        ],
        env: &[("ELBOWROOM_SCHEDULES", "100000")],
    },
    Run {
        name: "service",
        what: "100,000 random schedules of a whole service in simulated time: faults, requests, changes of regions",
        words: &["test", "--release", "-p", "elbowroom-live", "--lib", "simulated_service::", "--", "--nocapture"],
        env: &[("ELBOWROOM_SCHEDULES", "100000")],
    },
    Run {
        name: "model",
        what: "the states of the interlocks' protocols, up to half an hour per cell, and 10 million random steps",
        words: &[
            "test",
            "--release",
            "-p",
            "elbowroom-interlock",
            "--lib",
            "--",
            "model::",
            "check::",
            "--nocapture",
            "--test-threads=1",
        ],
        env: &[
            ("ELBOWROOM_MODEL_STATES", "4000000000"),
            ("ELBOWROOM_MODEL_SECONDS", "1800"),
            ("ELBOWROOM_MODEL_PROJECTED", "1000000"),
            ("ELBOWROOM_MODEL_STEPS", "10000000"),
        ],
    },
    Run {
        name: "messages",
        what: "ten million hostile messages to a node",
        words: &["test", "--release", "-p", "elbowroom-live", "--test", "main", "node::"],
        env: &[("ELBOWROOM_MESSAGES", "10000000")],
    },
    Run {
        name: "processes",
        what: "eight nodes and an arbiter as processes that are killed, paused and cut off, for half an hour",
        words: &[
            "bench",
            "-p",
            "elbowroom-live",
            "--bench",
            "interlock_faults",
            "--",
            "--robots",
            "8",
            "--seconds",
            "1800",
        ],
        env: &[],
    },
    Run {
        name: "measured",
        what: "robots beside a measured encoder and object whose messages are late, lost and out of order, for half an hour",
        words: &["bench", "-p", "elbowroom-live", "--bench", "measured_sources", "--", "--seconds", "1800"],
        env: &[],
    },
    Run {
        name: "cells",
        what: "10,000 random cells of each kind under an independent oracle",
        words: &["xtask", "fuzz", "cells", "--count", "10000"],
        env: &[],
    },
    Run {
        name: "files",
        what: "mutated files at every parser, five minutes each",
        words: &["xtask", "fuzz", "300"],
        env: &[],
    },
    Run {
        name: "avoidance",
        what: "a palletizer whose path a cart crosses, a thousand times without and with avoidance",
        words: &["xtask", "evade", "1000"],
        env: &[],
    },
    Run {
        name: "robots",
        what: "every robot of the data beside Pinocchio and Coal, 10,000 states each",
        words: &["xtask", "cross-validate"],
        env: &[LONG],
    },
    Run {
        name: "contacts",
        what: "the collision point of every robot of the data beside Coal, 2,500 states each",
        words: &["xtask", "contacts"],
        env: &[LONG],
    },
    Run {
        name: "c-api",
        what: "100,000 states of two arms through the C interface beside the command, also with sanitizers",
        words: &["test", "--release", "-p", "elbowroom-cli", "--test", "main", "c_api::", "--", "--nocapture"],
        env: &[LONG],
    },
    Run {
        name: "paths",
        what: "planned paths and timed motions at 10,000 points each, beside Coal",
        words: &["xtask", "paths"],
        env: &[],
    },
];

/// Runs the named ones, or lists all.
pub fn run(root: &Path, names: &[&str]) -> Result<(), Failure> {
    if names.is_empty() {
        for run in &RUNS {
            println!("{:<10} {}", run.name, run.what);
        }
        return Ok(());
    }
    let chosen = names.iter().map(|name| named(name)).collect::<Result<Vec<&Run>, String>>().map_err(Failure::Usage)?;
    let mut failed = Vec::new();
    for run in chosen {
        println!("\n== {}: {}", run.name, run.what);
        let started = Instant::now();
        let result = shell::cargo(root, run.words, run.env);
        println!(
            "{}: {} after {:.0} s",
            run.name,
            if result.is_ok() { "passed" } else { "FAILED" },
            started.elapsed().as_secs_f64()
        );
        if result.is_err() {
            failed.push(run.name);
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(Failure::Check(format!("failed: {}", failed.join(", ")))) }
}

fn named(name: &str) -> Result<&'static Run, String> {
    let names = || RUNS.iter().map(|run| run.name).collect::<Vec<_>>().join(", ");
    RUNS.iter()
        .find(|run| run.name == name)
        .ok_or_else(|| format!("no long run is called `{name}`; there are {}", names()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_is_found_by_its_name() {
        assert_eq!(named("cells").unwrap().words[1], "fuzz");
        assert!(named("everything").err().unwrap().contains("geometry"));
    }
}
