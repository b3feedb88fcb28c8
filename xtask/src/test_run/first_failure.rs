//! First failing test: the short units run first, and a failure stops the rest.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::lock::locked;
use super::process::{Ended, Limit, run_unit};
use super::programs::Program;
use super::times::Times;
use super::units::{Unit, units};

/// A failure, and the unit to run again to see it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FirstFailure {
    /// The program's name.
    program: String,
    /// The unit, with the failing test only if that is known.
    unit: Unit,
    /// Whether the unit was stopped because it took too long.
    pub hangs: bool,
}

impl FirstFailure {
    fn new(program: &Program, unit: &Unit, ended: &Ended) -> Self {
        let test = (!ended.is_late && !unit.tests.is_empty()).then(|| failing_test(&ended.output)).flatten();
        let tests = test.map_or_else(|| unit.tests.clone(), |test| vec![test]);
        Self { program: program.name.clone(), unit: Unit { tests, ..unit.clone() }, hangs: ended.is_late }
    }

    /// Name of the failing test with its program, or of the unit if its process did not report the test.
    pub fn name(&self) -> String {
        match &self.unit.tests[..] {
            [test] => format!("{} {test}", self.program),
            _ => self.unit.name.clone(),
        }
    }
}

/// Runs the tests of `programs`, a worker per core, until one fails. `root` has the times of earlier runs.
///
/// # Errors
/// If a program does not list its tests.
pub fn first_failure(
    root: &Path,
    programs: &[Program],
    env: &[(&str, &str)],
    longest: Duration,
) -> Result<Option<FirstFailure>, String> {
    let mut open = units(programs)?;
    let times = Times::read(root);
    open.sort_by(|a, b| times.expected(&a.name).total_cmp(&times.expected(&b.name)).then_with(|| a.name.cmp(&b.name)));
    let open = Mutex::new(VecDeque::from(open));
    let cancelled = AtomicBool::new(false);
    let found = Mutex::new(None);
    let next = || locked(&open).pop_front().filter(|_| !cancelled.load(Ordering::Relaxed));
    let workers = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(unit) = next() {
                    let program = &programs[unit.program];
                    let ended = run_unit(program, &unit, env, Limit { longest, cancelled: Some(&cancelled) });
                    // Only the unit that fails first has not been stopped by another one.
                    if !ended.ok && !cancelled.swap(true, Ordering::Relaxed) {
                        *locked(&found) = Some(FirstFailure::new(program, &unit, &ended));
                    }
                }
            });
        }
    });
    Ok(found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// Whether the failed test passes in these programs, which were compiled again.
pub fn passes(programs: &[Program], failure: &FirstFailure, env: &[(&str, &str)], longest: Duration) -> bool {
    let cancelled = AtomicBool::new(false);
    let limit = Limit { longest, cancelled: Some(&cancelled) };
    let program = programs.iter().find(|program| program.name == failure.program);
    program.is_some_and(|program| run_unit(program, &failure.unit, env, limit).ok)
}

/// Finds the first test that the harness reports as failed: in its line, or in the list at the end if the test itself
/// printed into that line.
fn failing_test(output: &str) -> Option<String> {
    let in_line = |line: &str| {
        let name = line.strip_prefix("test ")?.strip_suffix("FAILED")?.trim_end().strip_suffix("...")?.trim_end();
        Some(name.trim_end_matches(" - should panic").to_owned())
    };
    let listed = || {
        let (_, list) = output.rsplit_once("\nfailures:\n")?;
        list.lines().find_map(|line| line.strip_prefix("    ")).map(str::to_owned)
    };
    output.lines().find_map(in_line).or_else(listed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_failing_test_is_read_from_the_harness() {
        let lines = "running 3 tests\ntest a::one ... ok\ntest a::two ... FAILED\ntest a::three ... FAILED\n";
        assert_eq!(failing_test(lines), Some("a::two".into()));
        let panic = "test a::four - should panic ... FAILED\n";
        assert_eq!(failing_test(panic), Some("a::four".into()));
        let disturbed = "test a::five ... printed\nFAILED\n\nfailures:\n\n---- a::five stdout ----\nx\n\nfailures:\n    a::five\n\ntest result: FAILED.";
        assert_eq!(failing_test(disturbed), Some("a::five".into()));
        assert_eq!(failing_test("thread 'main' has overflowed its stack"), None);
    }

    #[test]
    fn a_failure_is_called_after_its_test_or_its_unit() {
        let program = Program {
            name: "robot/main".into(),
            executable: "/t/robot".into(),
            started: Vec::new(),
            folder: "/w".into(),
            has_harness: true,
        };
        let unit = Unit { name: "robot/main/map".into(), program: 0, tests: vec!["map::a".into(), "map::b".into()] };
        let ended = |is_late, output: &str| Ended { ok: false, is_late, output: output.into() };
        let named = FirstFailure::new(&program, &unit, &ended(false, "test map::b ... FAILED\n"));
        assert_eq!((named.name(), named.hangs), ("robot/main map::b".into(), false));
        let hanging = FirstFailure::new(&program, &unit, &ended(true, ""));
        assert_eq!((hanging.name(), hanging.hangs), ("robot/main/map".into(), true));
    }
}
