//! The `elbowroom` command: parse, call, print.
//!
//! Exit status: 0 success; 1 negative result (a collision, a forbidden region entered, no path); 2 invalid input or call.
//!
//! **Invariant.** Unless its reader closes the output early, a negative result or an invalid input or call never ends
//! with status 0.

mod arg_values;
mod args;
mod carry;
mod check;
mod control;
mod convert;
mod example;
mod fixture;
mod inspect;
mod live;
mod map;
mod map_path;
mod model_args;
mod output;
mod output_file;
mod plan;
mod plan_args;
mod plan_goal;
mod plan_problems;
mod plan_report;
mod plan_request;
mod plan_several;
mod progress;
mod query;
mod query_times;
mod region;
mod region_keys;
mod rules;
mod run;
mod simulation;
mod states;
mod sweep;
mod taught_fence;
mod taught_part;
mod taught_region;
mod taught_shape;
mod teach;
mod watch;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

use args::{Cli, Command};
use output::{ExitStatus, Failure};

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match cli.command {
        None => example::figure_12(),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::Query(args)) => query::query(&args),
        Some(Command::Inspect(args)) => inspect::inspect(&args),
        Some(Command::Convert(args)) => convert::convert(&args),
        Some(Command::Map(args)) => map::map(&args),
        Some(Command::Plan(args)) => plan::plan(&args),
        Some(Command::Fixture(args)) => fixture::fixture(&args),
        Some(Command::Sweep(args)) => sweep::sweep(&args),
        Some(Command::Rules(args)) => rules::rules(&args),
        Some(Command::Teach(args)) => teach::teach(&args),
        Some(Command::WatchCamera(args)) => watch::watch(&args),
        Some(Command::Region(command)) => region::region(&command),
        Some(Command::Example(args)) => example::copy(&args),
        Some(Command::Live(args)) => live::live(&args),
        Some(Command::Control(command)) => control::control(&command),
        Some(Command::View(args)) => live::view(&args),
        Some(Command::Replay(args)) => live::replay(&args),
        Some(Command::Completions { shell }) => completions(shell),
    };
    match result {
        // A reader that closes the pipe early is not a failure: `elbowroom … | head`.
        Ok(ExitStatus::Success) | Err(Failure::Closed) => ExitCode::SUCCESS,
        Ok(ExitStatus::NegativeResult) => ExitCode::from(1),
        Err(Failure::Wrong(message)) => {
            output::note(format_args!("elbowroom: {message}"));
            ExitCode::from(2)
        }
    }
}

fn completions(shell: clap_complete::Shell) -> Result<ExitStatus, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "elbowroom", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(ExitStatus::Success)
}
