//! Random cells of the fuzzer, run under the monitor: every recorded tick.

use std::path::Path;

use elbowroom_sim::{Recording, RunOptions, simulate};

use super::digest::Digest;
use super::hashed_group::HashedGroup;
use super::parallel::in_order;
use super::part::Part;
use super::progress::Progress;
use super::reason_code;
use crate::fuzz_cells::generate::{self, Kind, Places};
use crate::fuzz_cells::spec::CellSpec;
use crate::fuzz_cells::write_cell_files;

/// Kinds of cells; without planned moves, whose paths depend on the time of the search.
pub const KINDS: [Kind; 6] = [Kind::Stop, Kind::Exchange, Kind::Faults, Kind::Moving, Kind::Tools, Kind::Recordings];
/// Seed of the cells: case I of a kind is that of `cargo xtask fuzz cells --kind KIND --seed 17 --case I` without its
/// rare features.
const SEED: u64 = 17;

/// Hashes the runs of this many cells, evenly distributed over the kinds.
pub fn groups(root: &Path, data: Option<&Path>, cells: usize) -> Result<Vec<HashedGroup>, String> {
    let folder = write_cell_files(root)?;
    let places = Places { cells: &folder, root, data };
    let kinds = KINDS.len();
    let progress = Progress::new(Part::Overrides, cells);
    // Kinds take turns, so that any number of cells is distributed evenly.
    let job = |i: usize| run(KINDS[i % kinds], (i / kinds) as u64, &places);
    let hashes = in_order(cells, progress, "cells", job);
    let refused = hashes.iter().filter(|hash| hash.is_none()).count();
    eprintln!("overrides: {refused} of {cells} cells refused");
    let of_kind = |(k, kind): (usize, Kind)| {
        let mut digest = Digest::default();
        let cases = hashes.iter().skip(k).step_by(kinds);
        let count = cases.len();
        cases.for_each(|hash| digest.text(hash.as_deref().unwrap_or("refused")));
        HashedGroup::new(kind.name(), digest, count)
    };
    Ok(KINDS.into_iter().enumerate().map(of_kind).collect())
}

/// Returns the hash of one run; `None` if the cell or a step of its programs is refused.
fn run(kind: Kind, case: u64, places: &Places<'_>) -> Option<String> {
    let spec = generate::cell(kind, &mut kind.plain_random(SEED, case), places);
    let recording = recording(&spec, places)?;
    let mut digest = Digest::default();
    add_recording(&mut digest, &recording);
    Some(digest.hex())
}

fn recording(spec: &CellSpec, places: &Places<'_>) -> Option<Recording> {
    let cell = spec.parse(places.cells).ok()?;
    let options = RunOptions { faults: spec.faults.clone(), ..RunOptions::default() };
    simulate(&cell, &options).ok().map(|outcome| outcome.recording)
}

fn add_recording(digest: &mut Digest, recording: &Recording) {
    digest.number(recording.duration_s);
    for robot in &recording.robots {
        digest.text(&robot.name);
        digest.flag(robot.finished);
        digest.whole(robot.samples.len());
        for sample in &robot.samples {
            digest.number(sample.t_s);
            digest.numbers(sample.q.iter().copied());
            digest.number(sample.speed_override);
            let (kind, index) = reason_code::code(sample.reason);
            digest.whole(kind);
            digest.some_number(index.map(|index| index as f64));
            digest.some_number(sample.region.map(|region| region.0 as f64));
            digest.some_number(sample.distance_m);
        }
    }
}
