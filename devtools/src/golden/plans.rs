//! Paths of the data's planning problems.

use std::path::Path;

use elbowroom_formats::problem_set::PlanningProblem;
use elbowroom_query::problems::{ProblemModel, ProblemSettings, run};

use super::bounded_engine::BoundedEngine;
use super::digest::Digest;
use super::hashed_group::HashedGroup;
use super::parallel::in_order;
use super::part::Part;
use super::problem_files::{self, ProblemFile};
use super::progress::Progress;

/// Hashes the paths of all problems, planned with this many seeds each, from 0.
pub fn groups(data: &Path, seeds: usize) -> Result<Vec<HashedGroup>, String> {
    let mut groups = Vec::new();
    for file in problem_files::find(data)? {
        groups.extend(of_file(file, seeds)?);
    }
    Ok(groups)
}

/// Returns a group for each set of a file.
fn of_file(file: ProblemFile, seeds: usize) -> Result<Vec<HashedGroup>, String> {
    let ProblemFile { name, file, urdf, robot, problems } = file;
    let model = ProblemModel::new(&urdf, robot, &[], &file, &problems).map_err(|e| e.to_string())?;
    let sets: Vec<&[PlanningProblem]> = problems.chunk_by(|a, b| a.set == b.set).collect();
    // The covers are the same for all problems of most files.
    let mut engine = BoundedEngine::default();
    if let Some(first) = problems.first() {
        let scene = model.problem_scene(first).map_err(|e| e.to_string())?;
        engine.prepare(&scene, ProblemSettings::default().clearance_m)?;
    }
    let progress = Progress::new(Part::Plans, sets.len() * seeds);
    let job = |i: usize| hash(&model, sets[i / seeds], (i % seeds) as u64, engine.clone());
    let hashes = in_order(sets.len() * seeds, progress, &name, job);
    let hashes = hashes.into_iter().collect::<Result<Vec<SetHash>, String>>()?;
    let found: usize = hashes.iter().map(|hash| hash.found).sum();
    eprintln!("plans: {found} paths for {} problems of {name}, {}", problems.len(), urdf.display());
    let of_set = |(set, hashes): (&&[PlanningProblem], &[SetHash])| {
        let mut digest = Digest::default();
        for hash in hashes {
            digest.text(&hash.hex);
        }
        HashedGroup::new(&format!("{name}/{}", set[0].set), digest, set.len() * seeds)
    };
    Ok(sets.iter().zip(hashes.chunks(seeds)).map(of_set).collect())
}

/// Solutions of a set with one seed.
struct SetHash {
    hex: String,
    /// Number of problems with a path.
    found: usize,
}

fn hash(
    model: &ProblemModel,
    problems: &[PlanningProblem],
    seed: u64,
    mut engine: BoundedEngine,
) -> Result<SetHash, String> {
    let settings = ProblemSettings { seed, ..ProblemSettings::default() };
    let mut results = Digest::default();
    let ran = run(model, problems, &settings, &mut engine, &mut |result, timed| {
        results.text(&result.id);
        results.flag(result.valid);
        results.flag(result.found);
        results.flag(timed.is_some());
        if let Some(timed) = timed {
            let rows = timed.trajectory.rows();
            results.number(timed.trajectory.duration_s());
            results.whole(rows.len());
            results.numbers(rows.iter().flat_map(|row| &row.q).copied());
        }
        true
    });
    let found = ran.map_err(|e| e.to_string())?.iter().filter(|result| result.found).count();
    let mut digest = Digest::default();
    digest.text(&engine.digest.hex());
    digest.text(&results.hex());
    Ok(SetHash { hex: digest.hex(), found })
}
