//! The one set of features with which the tests are compiled, and the resulting programs.

use std::path::{Path, PathBuf};

use xtask::shell::{self, target_folder};

use crate::artifacts;

/// Compiles the tests.
pub const TESTS: [&str; 2] = ["test", "--no-run"];

/// All tests run with the network in the command. A second set of features would compile much of the workspace twice.
pub const WORKSPACE: [&str; 3] = ["--workspace", "--features", "elbowroom-cli/live"];

/// The compiler of the suite: clippy's, which lints a crate while it compiles it. A crate is read once instead of twice.
///
/// It generates the same code as rustc, but optimizes it only from LLVM on.
#[derive(Debug)]
pub struct Compiler {
    /// Path of `clippy-driver`; `None` if clippy is not installed.
    driver: Option<String>,
}

impl Compiler {
    /// Finds clippy's compiler beside rustc.
    pub fn find(root: &Path) -> Self {
        let sysroot = shell::output(root, "rustc", &["--print", "sysroot"]).unwrap_or_default();
        let driver = Path::new(sysroot.trim()).join("bin/clippy-driver");
        Self { driver: driver.is_file().then(|| driver.to_string_lossy().into_owned()) }
    }

    /// Variables of each call of cargo that builds: lints are warnings, so that the tests run in spite of them.
    pub fn environment(&self) -> Vec<(&'static str, &str)> {
        self.driver.iter().map(|driver| ("RUSTC_WORKSPACE_WRAPPER", driver.as_str())).collect()
    }

    /// The same for calls of cargo that check only; the variables of `cargo clippy -- -D warnings`, so that both share
    /// what they have checked.
    pub fn strict_environment(&self) -> Vec<(&'static str, &str)> {
        let mut environment = self.environment();
        if !environment.is_empty() {
            environment.push(("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__"));
        }
        environment
    }
}

/// Checks the lints of all targets: of what the tests compile, then of what they do not compile.
///
/// # Errors
/// If there is a warning; it has been printed.
pub fn lint(root: &Path, env: &[(&str, &str)]) -> Result<(), String> {
    let compiler = Compiler::find(root);
    let compiled = [env, &compiler.environment()].concat();
    let warnings = artifacts::warnings(root, &[&TESTS[..], &WORKSPACE[..]].concat(), &compiled)?;
    // `--benches` would also check each library as its unit tests see it, once more.
    let benches = ["--bench", "*", "--", "-D", "warnings"];
    shell::cargo(root, &[&["clippy"], &WORKSPACE[..], &benches].concat(), env)?;
    // Without the feature only the façade and the command differ. The benches are named because all crates then have the
    // features that they have above.
    shell::cargo(root, &[&["clippy", "--workspace", "--bin", "elbowroom"], &benches[..]].concat(), env)?;
    if warnings == 0 { Ok(()) } else { Err(format!("{warnings} warnings")) }
}

/// Builds a program of the workspace as the tests use it. With `--tests` its libraries have the features that they have
/// for the tests, so that only the program itself is left to compile.
pub fn program(root: &Path, name: &str) -> Result<PathBuf, String> {
    let build = [&["build", "--quiet", "--tests", "--bins"], &WORKSPACE[..]].concat();
    shell::cargo(root, &build, &Compiler::find(root).environment())?;
    Ok(target_folder(root).join("debug").join(name))
}
