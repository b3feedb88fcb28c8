//! `elbowroom plan --problems`: sets of planning problems for one robot.

pub(crate) mod args;
mod path_files;
mod selection;
mod table;

use std::path::Path;
use std::time::Duration;

use elbowroom::formats::problem_set;
use elbowroom::formats::robot::{self, LoadOptions};
use elbowroom::query::problems::{
    CoverRrtConnectEngine, ProblemModel, ProblemResult, ProblemSettings, ProblemSummary, run as run_problems,
};
use serde::Serialize;

use crate::output::{ExitStatus, Failure, note, print, print_json, width};
use crate::plan_args::PlanArgs;
use crate::progress::Progress;
use path_files::PathFiles;

/// Loads, plans and prints.
pub(crate) fn run(urdf: &Path, file: &Path, args: &PlanArgs) -> Result<ExitStatus, Failure> {
    let settings = settings(args)?;
    let read = problem_set::read(file)?;
    read.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let problems = selection::select(file, read.problems, &args.problems)?;
    let options = LoadOptions { srdf: args.problems.srdf.clone(), ..LoadOptions::default() };
    let loaded = robot::load(urdf, &options)?;
    loaded.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let groups = loaded.srdf.as_ref().map_or(&[][..], |srdf| &srdf.groups);
    let model = ProblemModel::new(urdf, loaded.robot, groups, file, &problems)?;
    model.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    check_speeds(urdf, &model, args)?;
    let mut files = args.problems.paths.as_deref().map(PathFiles::create).transpose()?;
    let progress = Progress::of(problems.len(), "problems");
    let (mut done, mut unsolved) = (0, 0);
    let mut written = Ok(());
    // To test another planner, replace this engine.
    let mut engine = CoverRrtConnectEngine::default();
    let results = run_problems(&model, &problems, &settings, &mut engine, &mut |result, timed| {
        done += 1;
        unsolved += usize::from(result.valid && !result.found);
        progress.count(done, &format!("{unsolved} not solved"));
        if let (Some(files), Some(timed)) = (&mut files, timed) {
            written = files.write(result, &model.joints, &timed.trajectory);
        }
        written.is_ok()
    })?;
    progress.end();
    written?;
    print_results(args, &results)?;
    let all_solved = results.iter().all(|r| r.found || !r.valid);
    Ok(if all_solved { ExitStatus::Success } else { ExitStatus::NegativeResult })
}

fn settings(args: &PlanArgs) -> Result<ProblemSettings, Failure> {
    if !(args.search.clearance >= 0.0 && args.search.clearance.is_finite()) {
        let what = format!("--clearance is {}\n  write: a finite number of metres, 0 or more", args.search.clearance);
        return Err(Failure::Wrong(what));
    }
    let defaults = ProblemSettings::default();
    Ok(ProblemSettings {
        time_limit: Duration::from_secs_f64(args.search.time_limit),
        clearance_m: args.search.clearance,
        seed: args.search.seed,
        period_s: args.period.unwrap_or(defaults.period_s),
        optimize: args.search.optimize,
    })
}

/// Checks that all joints have a speed: otherwise paths cannot be timed, an error if timed paths are to be written.
fn check_speeds(urdf: &Path, model: &ProblemModel, args: &PlanArgs) -> Result<(), Failure> {
    if model.joints_without_speed.is_empty() {
        return Ok(());
    }
    let what = format!(
        "{}: has no largest speed for {}: paths are not timed\n  write: <limit velocity=\"…\"/> in each of these \
         joints, in radians or, where it slides, metres per second",
        urdf.display(),
        model.joints_without_speed.join(", ")
    );
    if args.problems.paths.is_some() {
        return Err(Failure::Wrong(what));
    }
    note(format_args!("warning: {what}"));
    Ok(())
}

/// The JSON document.
#[derive(Serialize)]
struct Document<'a> {
    problems: &'a [ProblemResult],
    summary: &'a ProblemSummary,
}

fn print_results(args: &PlanArgs, results: &[ProblemResult]) -> Result<(), Failure> {
    let summary = ProblemSummary::of(results);
    if args.json {
        return print_json(&Document { problems: results, summary: &summary });
    }
    print(&table::text(&summary, results, width()))
}
