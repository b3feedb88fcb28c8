//! Python of the measurement and the planners from PyPI, in `target/planning/venv`.

use std::path::{Path, PathBuf};

use crate::native;

const PACKAGES: [&str; 4] = ["numpy==2.4.6", "pin==4.1.0", "coal==3.0.3", "ompl==2.0.1"];
const PROBE: &str = "import numpy, pinocchio, coal, ompl.geometric";
const PLAINMP: &str = "plainmp==0.3.6";
/// Packages for plainmp, which is compiled from its sources.
const PLAINMP_PACKAGES: [&str; 8] = [
    "g++",
    "cmake",
    "ninja-build",
    "libeigen3-dev",
    "libompl-dev",
    "libboost-serialization-dev",
    "libboost-filesystem-dev",
    "libboost-system-dev",
];

/// Installs the interpreter, with OMPL and the packages of the collision check.
pub fn python(folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join("venv/bin/python");
    if succeeds(folder, PROBE) {
        return Ok(python);
    }
    let venv = ["python3", "-m", "venv", "--clear", "venv"];
    if native::run(folder, &venv, &[]).is_err() {
        native::apt(folder, &["python3", "python3-venv"])?;
        native::run(folder, &venv, &[])?;
    }
    pip(folder, &PACKAGES)?;
    if succeeds(folder, PROBE) { Ok(python) } else { Err(format!("{} cannot be imported", PACKAGES.join(", "))) }
}

/// Installs plainmp, compiled by pip.
pub fn plainmp(folder: &Path) -> Result<(), String> {
    if succeeds(folder, "import plainmp.ompl_solver") {
        return Ok(());
    }
    if !Path::new("/usr/include/ompl-1.5").is_dir() || !native::exists("ninja") {
        native::apt(folder, &PLAINMP_PACKAGES)?;
    }
    pip(folder, &[PLAINMP])
}

fn pip(folder: &Path, packages: &[&str]) -> Result<(), String> {
    let install = ["venv/bin/python", "-m", "pip", "install", "-q", "--disable-pip-version-check"];
    let words: Vec<&str> = install.iter().chain(packages).copied().collect();
    native::run(folder, &words, &[("CMAKE_BUILD_PARALLEL_LEVEL", "1")])
}

fn succeeds(folder: &Path, line: &str) -> bool {
    xtask::shell::succeeds(folder, &folder.join("venv/bin/python").to_string_lossy(), &["-c", line])
}
