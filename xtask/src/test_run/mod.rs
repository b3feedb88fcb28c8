//! Runs the tests of all programs, a worker per core, the longest first.
//!
//! `cargo test` runs one program after another, so that most cores wait at the end of each. Here each worker runs its unit on one
//! thread: tests of different units run at once, tests of one module never do.

mod counts;
mod first_failure;
mod lock;
mod passes;
mod process;
mod processors;
mod programs;
mod times;
mod units;

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use counts::{Counts, counts};
pub use first_failure::{FirstFailure, first_failure, passes};
pub use lock::locked;
use passes::Passes;
use process::{Ended, Limit, run_unit};
use processors::idle_share;
pub use programs::{Program, compile};
use times::Times;
use units::Unit;

/// Limits of a unit; a unit that takes longer hangs.
const LIMIT: Limit = Limit { longest: Duration::from_mins(10), cancelled: None };

/// Number of idle processors above which one unit more runs.
const RESTING: f64 = 0.5;
/// How many units more may run than there are processors.
const GAP_WORKERS: usize = 2;

/// Choice of the units of tests to run.
pub struct Choice<'a> {
    /// Longest time of a program's units to run, s, by the last run.
    pub longest: &'a dyn Fn(&Program) -> f64,
    /// Whether units run too that passed before and could not fail now.
    pub again: bool,
}

/// Compiles the tests that cargo selects by `args`, and runs the chosen ones. Once all is compiled, one of the workers
/// first calls `beside`.
///
/// # Errors
/// If something does not compile, a test fails, or no test ran.
pub fn run(
    root: &Path,
    args: &[&str],
    env: &[(&str, &str)],
    choice: &Choice,
    beside: impl FnOnce() + Send,
) -> Result<(), String> {
    let started = Instant::now();
    let programs = compile(root, args, env)?;
    println!("{} programs, compiled in {:.1} s", programs.len(), started.elapsed().as_secs_f64());
    let (times, passes) = (Times::read(root), Passes::read(root, &programs, env));
    let all = units::units(&programs)?;
    let total = all.len();
    let is_chosen = |unit: &Unit| times.expected(&unit.name) <= (choice.longest)(&programs[unit.program]);
    let (mut chosen, mut unchanged) = (Vec::new(), Counts::default());
    for unit in all.into_iter().filter(is_chosen) {
        match passes.of(&unit).filter(|_| !choice.again) {
            Some(counts) => unchanged += counts,
            None => chosen.push(unit),
        }
    }
    if chosen.len() < total {
        println!("{} of {total} units of tests run; `cargo xtask test --again` runs all", chosen.len());
    }
    let progress = Progress { open: longest_first(chosen, &times), times, passes, ..Progress::default() };
    let Progress { counts, failed, .. } = run_units(&programs, progress, env, beside);
    let before = unchanged.passed;
    let known = if before > 0 { format!(" ({before} before, unchanged since)") } else { String::new() };
    let mut all = counts;
    all += unchanged;
    println!("{} passed{known}, {} failed, {} skipped", all.passed, all.failed, all.ignored);
    if all == Counts::default() {
        return Err("no test ran".into());
    }
    if failed.is_empty() { Ok(()) } else { Err(format!("failed: {}", failed.join(", "))) }
}

/// State that the workers share.
#[derive(Default)]
struct Progress {
    open: VecDeque<Unit>,
    counts: Counts,
    failed: Vec<String>,
    times: Times,
    passes: Passes,
}

fn longest_first(mut units: Vec<Unit>, times: &Times) -> VecDeque<Unit> {
    units.sort_by(|a, b| {
        let longer = times.expected(&b.name).total_cmp(&times.expected(&a.name));
        longer.then_with(|| b.tests.len().cmp(&a.tests.len())).then_with(|| a.name.cmp(&b.name))
    });
    units.into()
}

fn run_units(programs: &[Program], progress: Progress, env: &[(&str, &str)], beside: impl FnOnce() + Send) -> Progress {
    let progress = Mutex::new(progress);
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let run_one = |unit: &Unit| {
        let started = Instant::now();
        let ended = run_unit(&programs[unit.program], unit, env, LIMIT);
        report(&mut locked(&progress), unit, &ended, started.elapsed());
    };
    let work = || {
        loop {
            // A separate statement, so that the lock is released before the unit runs.
            let next = locked(&progress).open.pop_front();
            let Some(unit) = next else { break };
            run_one(&unit);
        }
    };
    // Tests of live processes mostly wait: more workers run units while processors are idle.
    let gap = Mutex::new(());
    let work_in_gaps = || {
        loop {
            // One measures at a time, so that it sees the unit that the other one has started.
            let gap = locked(&gap);
            let Some(idle) = idle_share(Duration::from_millis(150)) else { break };
            if locked(&progress).open.is_empty() {
                break;
            }
            let next = if idle * workers as f64 > RESTING { locked(&progress).open.pop_front() } else { None };
            drop(gap);
            next.iter().for_each(run_one);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..workers {
            scope.spawn(work);
        }
        for _ in 0..GAP_WORKERS {
            scope.spawn(work_in_gaps);
        }
        beside();
        work();
    });
    let progress = progress.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    progress.times.write();
    progress.passes.write();
    progress
}

fn report(progress: &mut Progress, unit: &Unit, ended: &Ended, time: Duration) {
    let counts = if unit.tests.is_empty() {
        Counts { passed: usize::from(ended.ok), failed: usize::from(!ended.ok), ignored: 0 }
    } else {
        // A process that dies prints no result line: all its tests count as failed.
        counts(&ended.output).unwrap_or(Counts { failed: unit.tests.len(), ..Counts::default() })
    };
    progress.counts += counts;
    let ok = ended.ok && counts.failed == 0;
    println!(
        "{} {:>6.1} s  {:>4}  {}",
        if ok { "ok    " } else { "FAILED" },
        time.as_secs_f64(),
        unit.tests.len().max(1),
        unit.name
    );
    // A test without its data or its reference passes, and prints a line.
    let left_out: Vec<&str> = ended.output.lines().filter(|line| line.contains("skipped:")).map(str::trim).collect();
    let all_ran = ok && left_out.is_empty();
    progress.passes.keep(unit, all_ran.then_some(counts));
    if ok {
        progress.times.keep(&unit.name, time);
        for line in left_out {
            println!("        {line}");
        }
    } else {
        println!("{}", ended.output);
        progress.failed.push(unit.name.clone());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_dies_fails_with_all_its_tests() {
        let mut progress = Progress::default();
        let unit = Unit { name: "a/main".into(), program: 0, tests: vec!["x".into(), "y".into()] };
        report(&mut progress, &unit, &Ended { ok: false, is_late: false, output: String::new() }, Duration::ZERO);
        assert_eq!((progress.counts.failed, progress.failed), (2, vec!["a/main".to_owned()]));
    }
}
