//! Loading time of each URDF below a directory: `cargo bench -p elbowroom-formats --bench load_times -- DIR`.
//!
//! Prints milliseconds, best of five, without and with visual meshes. The files are in the cache of the operating system.

use std::path::{Path, PathBuf};
use std::time::Instant;

use elbowroom_formats::robot::{self, LoadOptions};

fn main() {
    let directory = elbowroom_testkit::bench::arguments().next().unwrap_or_else(|| ".".into());
    let mut paths = Vec::new();
    collect(Path::new(&directory), &mut paths);
    paths.sort();
    for path in paths {
        match (best(&path, false), best(&path, true)) {
            (Some(bare), Some(full)) => eprintln!("{bare:8.2} ms {full:8.2} ms  {}", path.display()),
            _ => eprintln!("      not loaded       {}", path.display()),
        }
    }
}

fn collect(directory: &Path, paths: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, paths);
        } else if path.extension().is_some_and(|e| e == "urdf") {
            paths.push(path);
        }
    }
}

fn best(path: &Path, load_visuals: bool) -> Option<f64> {
    let options = LoadOptions { load_visuals, ..LoadOptions::default() };
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        robot::load(path, &options).ok()?;
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    Some(best)
}
