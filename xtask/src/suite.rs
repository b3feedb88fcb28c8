//! `cargo xtask test`: all checks with their times, and a table at the end.

use std::path::Path;
use std::sync::Mutex;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use xtask::{Failure, shell};

use crate::references::References;
use crate::test_run::{Choice, locked};
use crate::workspace::{self, Compiler, WORKSPACE, program};
use crate::{documents, layers, snippets, test_run};

type Check = fn(&Context) -> Result<(), String>;

/// Result of a step, and its duration.
struct Outcome {
    name: &'static str,
    ok: bool,
    time: Duration,
}

/// Data that every step has.
struct Context<'a> {
    root: &'a Path,
    offline: bool,
    again: bool,
    compiler: Compiler,
    /// References of the tests, while they are being installed.
    references: Mutex<Option<JoinHandle<Result<References, String>>>>,
    /// Steps that run beside the tests, and their results.
    beside: Vec<&'static Step>,
    ended: Mutex<Vec<Outcome>>,
}

struct Step {
    name: &'static str,
    what: &'static str,
    check: Check,
}

/// The steps, cheap ones first, so that quick failures come first. All tests are compiled once, by `tests`, and linted by
/// the same compiler; `clippy` and `docs` check the libraries once more, as no documentation can be built otherwise. Steps after `tests` run beside them, so that no processor is idle while crates are
/// compiled one after another.
static STEPS: [Step; 10] = [
    Step { name: "fmt", what: "cargo fmt --check", check: fmt },
    Step {
        name: "layers",
        what: "who may depend on whom, no circles of files, the planted faults fit the sources",
        check: |c| layers::run(c.root),
    },
    Step {
        name: "documents",
        what: "no long lines, broken links or unknown names in documents",
        check: |c| documents::run(c.root),
    },
    Step {
        name: "tests",
        what: "unit and integration tests, with the references in Python and a browser",
        check: tests,
    },
    Step { name: "clippy", what: "lints of all targets, warnings are errors", check: clippy },
    Step { name: "docs", what: "cargo doc, warnings are errors", check: docs },
    Step { name: "doctests", what: "the examples of the documentation", check: doctests },
    Step {
        name: "generated",
        what: "committed robots, tools, figures and references are what the generators write",
        check: generated,
    },
    Step {
        name: "fuzz",
        what: "random cells under an independent oracle, a fixed choice of them",
        check: |c| devtools(c.root, &["fuzz", "cells", "--fixed"]),
    },
    Step { name: "snippets", what: "commands that the documents promise", check: |c| snippets::run(c.root) },
];

/// Options of `cargo xtask test`.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    only: Vec<String>,
    list: bool,
    offline: bool,
    again: bool,
}

impl Options {
    /// Reads the words after `test`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match *word {
                "--list" => options.list = true,
                "--offline" => options.offline = true,
                "--again" => options.again = true,
                "--only" => options.only.push(step_name(words.next().copied())?),
                other => return Err(format!("`test` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

fn step_name(word: Option<&str>) -> Result<String, String> {
    let names = || STEPS.each_ref().map(|step| step.name).join(", ");
    let word = word.ok_or_else(|| format!("`--only` needs one of {}", names()))?;
    if STEPS.iter().any(|step| step.name == word) {
        return Ok(word.to_owned());
    }
    Err(format!("no step is called `{word}`; there are {}", names()))
}

/// Runs the chosen steps, all of them even if one fails, and prints a summary.
pub fn run(root: &Path, options: &Options) -> Result<(), Failure> {
    if options.list {
        for step in &STEPS {
            println!("{:<9} {}", step.name, step.what);
        }
        return Ok(());
    }
    let is_chosen = |step: &&Step| options.only.is_empty() || options.only.iter().any(|name| name == step.name);
    let mut chosen: Vec<&Step> = STEPS.iter().filter(is_chosen).collect();
    let (mut references, mut beside) = (None, Vec::new());
    if let Some(tests) = chosen.iter().position(|step| step.name == "tests") {
        // Downloads wait for the network, so they run beside the first steps.
        let (folder, offline) = (root.to_path_buf(), options.offline);
        references = Some(std::thread::spawn(move || References::find(&folder, offline)));
        beside = chosen.split_off(tests + 1);
    }
    let (references, ended) = (Mutex::new(references), Mutex::default());
    let (offline, again, compiler) = (options.offline, options.again, Compiler::find(root));
    let context = Context { root, offline, again, compiler, references, beside, ended };
    let started = Instant::now();
    let mut outcomes = quick_steps(&mut chosen, &context);
    outcomes.extend(chosen.into_iter().map(|step| timed(step, &context)));
    // If the tests do not compile, nothing has run beside them.
    run_beside(&context);
    outcomes.append(&mut locked(&context.ended));
    print_table(&outcomes, started.elapsed());
    let failed: Vec<&str> = outcomes.iter().filter(|outcome| !outcome.ok).map(|outcome| outcome.name).collect();
    if failed.is_empty() { Ok(()) } else { Err(Failure::Check(format!("failed: {}", failed.join(", ")))) }
}

/// Runs the chosen steps that come before `tests`, all at once: each takes one processor. What they print is mixed.
fn quick_steps(chosen: &mut Vec<&Step>, context: &Context) -> Vec<Outcome> {
    let is_quick = |step: &&Step| STEPS.iter().take_while(|s| s.name != "tests").any(|s| s.name == step.name);
    let quick = chosen.iter().take_while(|step| is_quick(step)).count();
    let quick: Vec<&Step> = chosen.drain(..quick).collect();
    std::thread::scope(|scope| {
        let running: Vec<_> = quick.iter().map(|step| scope.spawn(|| timed(step, context))).collect();
        running.into_iter().map(|step| step.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect()
    })
}

/// Runs the remaining steps that belong beside the tests, one after another.
fn run_beside(context: &Context) {
    let mut ended = locked(&context.ended);
    while let Some(step) = context.beside.get(ended.len()) {
        let outcome = timed(step, context);
        ended.push(outcome);
    }
}

fn timed(step: &Step, context: &Context) -> Outcome {
    println!("\n== {}: {}", step.name, step.what);
    let started = Instant::now();
    let result = (step.check)(context);
    if let Err(message) = &result {
        println!("{} failed: {message}", step.name);
    }
    Outcome { name: step.name, ok: result.is_ok(), time: started.elapsed() }
}

fn print_table(outcomes: &[Outcome], total: Duration) {
    println!("\nstep       result       time");
    for Outcome { name, ok, time } in outcomes {
        println!("{name:<10} {:<7} {:>7.1} s", if *ok { "ok" } else { "FAILED" }, time.as_secs_f64());
    }
    println!("{:<10} {:<7} {:>7.1} s", "all", "", total.as_secs_f64());
}

fn fmt(context: &Context) -> Result<(), String> {
    shell::cargo(context.root, &["fmt", "--all", "--check"], &[])
}

fn clippy(context: &Context) -> Result<(), String> {
    workspace::lint(context.root, &beside_tests(context))
}

fn tests(context: &Context) -> Result<(), String> {
    let references = locked(&context.references).take().and_then(|found| found.join().ok());
    let references = references.unwrap_or_else(|| Err("the installation of the references panicked".into()));
    announce_data(context.root);
    // A failed installation fails the step, but only after the tests have run.
    let environment = references.iter().flat_map(References::environment);
    let env: Vec<_> = network(context).into_iter().chain(context.compiler.environment()).chain(environment).collect();
    let choice = Choice { longest: &|_| f64::INFINITY, again: context.again };
    test_run::run(context.root, &WORKSPACE, &env, &choice, || run_beside(context))?;
    references.map(|_| ())
}

fn doctests(context: &Context) -> Result<(), String> {
    let args = [&["test", "--quiet", "--doc"], &WORKSPACE[..], &["--", "--test-threads=1"]].concat();
    shell::cargo(context.root, &args, &[beside_tests(context), context.compiler.environment()].concat())
}

/// Reports whether the real data exist: without them tests on real robots pass, so the log must show it.
pub fn announce_data(root: &Path) {
    let folder = xtask::call::data_folder(root, None);
    let line = if folder.is_dir() { "real data:" } else { "tests on real data are skipped: no data at" };
    println!("{line} {}", folder.display());
}

/// Runs commands of `elbowroom-devtools` in the profile and with the features of the tests, which have compiled it already.
/// The command `elbowroom` is compiled with it.
pub fn devtools(root: &Path, words: &[&str]) -> Result<(), String> {
    let program = program(root, "elbowroom-devtools")?;
    let covers = own_covers(root);
    shell::run(root, &program.to_string_lossy(), words, covers_of(words, &covers).as_slice())
}

/// A folder for covers of random robots: they must not fill the cache of the user.
pub fn own_covers(root: &Path) -> String {
    shell::target_folder(root).join("fuzz-covers").display().to_string()
}

/// The environment of a command of `elbowroom-devtools`, with a folder of covers for random robots.
pub fn covers_of<'c>(words: &[&str], folder: &'c str) -> Option<(&'static str, &'c str)> {
    const CACHE: &str = "ELBOWROOM_CACHE";
    let is_random = words.first() == Some(&"fuzz") && std::env::var_os(CACHE).is_none();
    is_random.then_some((CACHE, folder))
}

fn generated(context: &Context) -> Result<(), String> {
    devtools(context.root, &["models", "--check"])?;
    devtools(context.root, &["figures", "--check"])?;
    devtools(context.root, &["reference", "--check"])
}

/// Documents libraries and `elbowroom-devtools`. An example is named because cargo then gives all crates
/// the features that they have for `clippy`; with its compiler and arguments nothing is checked twice.
fn docs(context: &Context) -> Result<(), String> {
    let mut env = [beside_tests(context), context.compiler.strict_environment()].concat();
    // Each crate merges itself into the search index, 3 s each. For pages with a search: remove `target/doc`, run
    // `cargo doc`.
    let _ = std::fs::remove_dir_all(shell::target_folder(context.root).join("doc/search.index"));
    env.push(("RUSTDOCFLAGS", "-D warnings"));
    let targets = ["--lib", "--bin", "elbowroom-devtools", "--example", "1_distance"];
    shell::cargo(context.root, &[&["doc", "--no-deps"], &WORKSPACE[..], &targets].concat(), &env)
}

/// Limits cargo to one job: other processors run tests.
fn beside_tests<'a>(context: &Context) -> Vec<(&'static str, &'a str)> {
    [network(context), vec![("CARGO_BUILD_JOBS", "1")]].concat()
}

fn network<'a>(context: &Context) -> Vec<(&'static str, &'a str)> {
    if context.offline { vec![("CARGO_NET_OFFLINE", "true")] } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--only", "fmt", "--only", "docs", "--offline"]).unwrap();
        assert_eq!(options, Options { only: vec!["fmt".into(), "docs".into()], offline: true, ..Options::default() });
        assert!(Options::parse(&["--again"]).unwrap().again);
        assert!(Options::parse(&["--only"]).unwrap_err().contains("layers"));
        assert!(Options::parse(&["--only", "nothing"]).is_err());
        assert!(Options::parse(&["--fast"]).is_err());
    }
}
