//! `cargo xtask test`: every check, timed, with a table at the end.

use std::path::Path;
use std::time::{Duration, Instant};

use xtask::{Failure, browser, playwright, python, shell};

use crate::{layers, snippets, terms};

type Check = fn(&Context) -> Result<(), String>;

/// How a step ended and how long it took.
struct Outcome {
    name: &'static str,
    ok: bool,
    time: Duration,
}

/// What every step knows.
struct Context<'a> {
    root: &'a Path,
    offline: bool,
}

struct Step {
    name: &'static str,
    what: &'static str,
    check: Check,
}

/// Cheap checks first: what fails fast should fail first.
const STEPS: [Step; 12] = [
    Step { name: "fmt", what: "cargo fmt --check", check: fmt },
    Step { name: "layers", what: "who may depend on whom, and no circles of files", check: |c| layers::run(c.root) },
    Step {
        name: "terms",
        what: "no retired words, no long lines and no broken links in documents",
        check: |c| terms::run(c.root),
    },
    Step {
        name: "models",
        what: "committed robots and tools are what the generator writes",
        check: |c| devtools(c, &["models", "--check"]),
    },
    Step {
        name: "figures",
        what: "committed figures of docs/laws.md are what the laws give",
        check: |c| devtools(c, &["figures", "--check"]),
    },
    Step {
        name: "python",
        what: "target/venv with the references for kinematics and recordings",
        check: install_python,
    },
    Step { name: "clippy", what: "lints of all targets, warnings are errors", check: clippy },
    Step { name: "tests", what: "unit, integration and documentation tests", check: tests },
    Step {
        name: "browser",
        what: "report and view in headless Chromium: controls, distances, console",
        check: open_pages,
    },
    Step {
        name: "fuzz",
        what: "random cells under an independent oracle, a fixed choice of them",
        check: |c| devtools(c, &["fuzz", "cells", "--fixed"]),
    },
    Step { name: "docs", what: "cargo doc, warnings are errors", check: docs },
    Step { name: "snippets", what: "commands that the documents promise", check: |c| snippets::run(c.root) },
];

/// Options of `cargo xtask test`.
#[derive(Debug, Default, PartialEq)]
pub struct Options {
    only: Vec<String>,
    list: bool,
    offline: bool,
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
                "--only" => options.only.push(step_name(words.next().copied())?),
                other => return Err(format!("`test` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

fn step_name(word: Option<&str>) -> Result<String, String> {
    let names = || STEPS.map(|step| step.name).join(", ");
    let word = word.ok_or_else(|| format!("`--only` needs one of {}", names()))?;
    if STEPS.iter().any(|step| step.name == word) {
        return Ok(word.to_owned());
    }
    Err(format!("no step is called `{word}`; there are {}", names()))
}

/// Runs the chosen steps, all of them even where one fails, and sums up.
pub fn run(root: &Path, options: &Options) -> Result<(), Failure> {
    if options.list {
        for step in &STEPS {
            println!("{:<9} {}", step.name, step.what);
        }
        return Ok(());
    }
    let context = Context { root, offline: options.offline };
    let chosen =
        STEPS.iter().filter(|step| options.only.is_empty() || options.only.iter().any(|name| name == step.name));
    let started = Instant::now();
    let outcomes: Vec<Outcome> = chosen.map(|step| timed(step, &context)).collect();
    print_table(&outcomes, started.elapsed());
    let failed: Vec<&str> = outcomes.iter().filter(|outcome| !outcome.ok).map(|outcome| outcome.name).collect();
    if failed.is_empty() { Ok(()) } else { Err(Failure::Check(format!("failed: {}", failed.join(", ")))) }
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

/// The command with the network.
const LIVE: &str = "elbowroom-cli/live";

fn fmt(context: &Context) -> Result<(), String> {
    shell::cargo(context.root, &["fmt", "--all", "--check"], &[])
}

fn install_python(context: &Context) -> Result<(), String> {
    if context.offline {
        println!("--offline: nothing is installed");
        return Ok(());
    }
    python::install(context.root)
}

fn clippy(context: &Context) -> Result<(), String> {
    let args = ["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"];
    shell::cargo(context.root, &args, &network(context))?;
    let live = ["clippy", "--workspace", "--features", LIVE, "--all-targets", "--", "-D", "warnings"];
    shell::cargo(context.root, &live, &network(context))
}

fn tests(context: &Context) -> Result<(), String> {
    let python = python::ready(context.root).map(|path| path.to_string_lossy().into_owned());
    let mut env = network(context);
    match &python {
        Some(path) => env.push(("ELBOWROOM_PYTHON", path)),
        None => println!(
            "target/venv is not ready: the comparisons with Pinocchio and with readers of recordings are skipped"
        ),
    }
    announce_data(context.root);
    shell::cargo(context.root, &["test", "--workspace"], &env)?;
    // The command with the network, as processes. With `--workspace` the dependencies are those that are there already.
    let live = ["test", "--workspace", "--features", LIVE];
    let tests = ["live", "live_control", "live_ros2", "recordings"].into_iter().flat_map(|name| ["--test", name]);
    shell::cargo(context.root, &live.into_iter().chain(tests).collect::<Vec<_>>(), &env)?;
    if python.is_some() || context.offline {
        return Ok(());
    }
    let first = "run the step `python` first (cargo xtask test --only python)";
    Err(format!("all that ran passed, but without the comparisons with Python: {first}, or say --offline"))
}

/// The tests of the pages, which pass without a browser, with one.
fn open_pages(context: &Context) -> Result<(), String> {
    let found = if context.offline { browser::find(context.root) } else { Some(browser::install(context.root)?) };
    let Some(browser) = found else {
        println!("--offline: no Chromium is there, and none is installed: report and view are not opened in a browser");
        return Ok(());
    };
    let driver =
        if context.offline { playwright::ready(context.root) } else { Some(playwright::install(context.root)?) };
    let (path, driver) = (browser.to_string_lossy(), driver.map(|path| path.to_string_lossy().into_owned()));
    let mut env = network(context);
    env.push(("ELBOWROOM_CHROMIUM", &path));
    match &driver {
        Some(python) => env.push(("ELBOWROOM_PLAYWRIGHT", python)),
        None => {
            println!("--offline: Playwright is not there, and is not installed: the view is not opened in a browser");
        }
    }
    shell::cargo(context.root, &["test", "--workspace", "--test", "browser"], &env)
}

/// Tests on real robots pass where their data are missing: the log must show which run it was.
fn announce_data(root: &Path) {
    let folder = xtask::call::data_folder(root, None);
    let line = if folder.is_dir() { "real data:" } else { "tests on real data are skipped: no data at" };
    println!("{line} {}", folder.display());
}

/// A command of `elbowroom-devtools`, in the profile of the tests: what they compiled serves again.
fn devtools(context: &Context, words: &[&str]) -> Result<(), String> {
    let run = ["run", "--quiet", "--package", "elbowroom-devtools", "--"];
    let args: Vec<&str> = run.iter().chain(words).copied().collect();
    shell::cargo(context.root, &args, &network(context))
}

fn docs(context: &Context) -> Result<(), String> {
    let mut env = network(context);
    env.push(("RUSTDOCFLAGS", "-D warnings"));
    shell::cargo(context.root, &["doc", "--workspace", "--no-deps"], &env)
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
        assert_eq!(options, Options { only: vec!["fmt".into(), "docs".into()], list: false, offline: true });
        assert!(Options::parse(&["--only"]).unwrap_err().contains("layers"));
        assert!(Options::parse(&["--only", "nothing"]).is_err());
        assert!(Options::parse(&["--fast"]).is_err());
    }
}
