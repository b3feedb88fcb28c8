//! The runner of elbowroom in `cargo xtask peers`: generates the workload and answers its queries.
//!
//! `cargo bench -p elbowroom-proximity --bench peers -- generate DIR`
//!
//! `generate DIR` writes the meshes and poses, `extend DIR EXTRA` the paths and random poses for them,
//! `serve DIR EXTRA` answers `time` and `answers` on standard input. `xtask/peers/README.md` defines the format and
//! the protocol.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "the protocol uses standard output")]

mod arm;
mod cells;
mod files;
mod paths;
mod placing;
mod random;
mod robots;
mod serve;
mod surfaces;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<String> = elbowroom_testkit::bench::arguments().collect();
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["generate", folder] => placing::generate(Path::new(folder)).and_then(|()| arm::generate(Path::new(folder))),
        ["extend", data, extra] => paths::extend(Path::new(data), Path::new(extra)),
        ["serve", data, extra] => serve::serve(Path::new(data), Path::new(extra)),
        _ => Err("usage: peers (generate DIR | extend DIR EXTRA | serve DIR EXTRA)".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}
