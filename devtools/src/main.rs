//! Commands of `cargo xtask` that need the product's own crates: generated files, random cells under an oracle,
//! comparisons with other libraries. `cargo xtask help` lists the commands.
//!
//! **Invariant.** Whatever a monitor answers, the oracle of `fuzz cells` never uses the product's kinematics, distances
//! or laws.
#![allow(clippy::print_stdout, reason = "this program talks to the person who started it")]

mod contacts;
mod crate_pictures;
mod cross_validation;
mod evade;
mod figures;
mod fuzz_cells;
mod fuzz_files;
mod golden;
mod models;
mod path_checks;
mod reference;
mod robots;
mod rpq;
mod scaling;
mod solid;

use std::path::Path;
use std::process::ExitCode;

use xtask::call::{self, Failure, workspace_root};

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    call::exit(dispatch(&words), "`cargo xtask help` lists the commands")
}

fn dispatch(words: &[&str]) -> Result<(), Failure> {
    let root = workspace_root()?;
    match words {
        ["models"] => Ok(models::write(&root)?),
        ["models", "--check"] => Ok(models::check(&root)?),
        ["figures"] => Ok(figures::write(&root)?),
        ["figures", "--check"] => Ok(figures::check(&root)?),
        ["reference"] => Ok(reference::write(&root)?),
        ["reference", "--check"] => Ok(reference::check(&root)?),
        ["fuzz", "cells", "--fixed"] => Ok(fuzz_cells::check(&root)?),
        ["fuzz", "cells", rest @ ..] => {
            fuzz_cells::run(&root, &fuzz_cells::Options::parse(rest).map_err(Failure::Usage)?)
        }
        ["fuzz", "parser", rest @ ..] => fuzz_files::parser(rest),
        ["fuzz", "cell-file", rest @ ..] => fuzz_files::cell_file(rest),
        ["evade", rest @ ..] => evade::run(&root, rest),
        ["cross-validate", rest @ ..] => cross_validation::run(&root, rest),
        ["contacts", rest @ ..] => contacts::run(&root, rest),
        ["paths", rest @ ..] => path_checks::run(&root, rest),
        ["golden", rest @ ..] => golden::run(&root, rest),
        ["rpq", rest @ ..] => rpq::run(&root, rest),
        ["scaling"] => Ok(scaling::run(&root, None)?),
        ["scaling", "--out", folder] => Ok(scaling::run(&root, Some(Path::new(folder)))?),
        _ => Err(Failure::Usage(format!("unknown call `{}`", words.join(" ")))),
    }
}
