//! Python of the tests: independent references (Pinocchio for kinematics, Coal for distances, readers of recordings), and what the
//! tests of the package need.

use std::path::{Path, PathBuf};

use crate::shell;

/// What the tests in Python run with.
pub const PYTEST: &str = "pytest==9.2.0";
/// Pyright with its own Node.js.
pub const BASEDPYRIGHT: &str = "basedpyright==1.40.2";
/// What the tests in Python make random input with.
pub const HYPOTHESIS: &str = "hypothesis==6.170.17";

/// What sweeps write with.
pub const PYARROW: &str = "pyarrow==26.0.1";
/// The cluster of sweeps.
pub const RAY: &str = "ray==2.60.0";
/// Pictures of sweeps.
pub const MATPLOTLIB: &str = "matplotlib==3.11.2";
/// Sequences of states of sweeps.
pub const SCIPY: &str = "scipy==1.17.1";

/// Kinematics and distances to compare with, and models of another package.
pub const PINOCCHIO: &str = "pin==4.1.0";
/// Meshes of another package.
pub const TRIMESH: &str = "trimesh==5.2.0";
/// Models of another package.
pub const YOURDFPY: &str = "yourdfpy==0.0.60";
/// Where scenes and motions can be logged.
pub const RERUN: &str = "rerun-sdk==0.41.0";
/// Builds the documentation site.
pub const SPHINX: &str = "sphinx==9.0.4";

/// Pinned, so that a test compares with the same reference everywhere.
const PACKAGES: [&str; 14] = [
    PINOCCHIO,
    "numpy==2.4.6",
    "mcap==1.6.0",
    "mcap-ros2-support==0.6.0",
    "rosbags==0.11.9",
    PYTEST,
    HYPOTHESIS,
    "mypy==2.4.1",
    PYARROW,
    RAY,
    SCIPY,
    MATPLOTLIB,
    TRIMESH,
    YOURDFPY,
];

/// Checks that the pinned versions are installed.
const PROBE: &str = "import pinocchio, coal, numpy, mcap_ros2.decoder, rosbags.typesys
from importlib.metadata import version
assert pinocchio.__version__ == '4.1.0' and numpy.__version__ == '2.4.6'
assert (version('mcap'), version('mcap-ros2-support'), version('rosbags')) == ('1.6.0', '0.6.0', '0.11.9')
assert (version('pytest'), version('hypothesis'), version('mypy')) == ('9.2.0', '6.170.17', '2.4.1')
assert (version('pyarrow'), version('ray'), version('scipy')) == ('26.0.1', '2.60.0', '1.17.1')
assert version('matplotlib') == '3.11.2'
assert (version('trimesh'), version('yourdfpy')) == ('5.2.0', '0.0.60')";

/// Path of the interpreter inside `target/venv`, whether or not it exists.
pub fn interpreter(root: &Path) -> PathBuf {
    root.join("target/venv/bin/python")
}

/// Returns the interpreter, if it exists with every pinned package.
pub fn ready(root: &Path) -> Option<PathBuf> {
    let python = interpreter(root);
    shell::succeeds(root, &python.to_string_lossy(), &["-c", PROBE]).then_some(python)
}

/// Prepares `target/venv`: does nothing if it is complete, else makes a new environment from PyPI.
///
/// # Errors
/// If Python, `venv` or the packages cannot be installed; the message says what to do.
pub fn install(root: &Path) -> Result<(), String> {
    if ready(root).is_some() {
        println!("target/venv has {}", PACKAGES.join(", "));
        return Ok(());
    }
    environment(root, &root.join("target/venv"), &PACKAGES, &[]).map_err(|e| explain(&e))?;
    ready(root).map(|_| ()).ok_or_else(|| explain("the packages are installed, but cannot be imported"))
}

/// Makes a new virtual environment with packages from PyPI, and returns its interpreter.
///
/// # Errors
/// If Python, `venv` or the packages cannot be installed.
pub fn environment(root: &Path, folder: &Path, packages: &[&str], env: &[(&str, &str)]) -> Result<PathBuf, String> {
    create(root, folder)?;
    let python = folder.join("bin/python");
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    shell::run(root, &python.to_string_lossy(), &[&install[..], packages].concat(), env)?;
    Ok(python)
}

fn create(root: &Path, folder: &Path) -> Result<(), String> {
    let folder = folder.to_string_lossy();
    let make = ["-m", "venv", "--clear", &folder];
    if shell::run(root, "python3", &make, &[]).is_ok() {
        return Ok(());
    }
    println!("python3 cannot make a virtual environment: trying the Debian package python3-venv");
    let install = ["install", "-y", "--no-install-recommends", "python3", "python3-venv"];
    let env = [("DEBIAN_FRONTEND", "noninteractive")];
    let updated = shell::run(root, "apt-get", &["update", "-q"], &env);
    updated.and_then(|()| shell::run(root, "apt-get", &install, &env))?;
    shell::run(root, "python3", &make, &[])
}

fn explain(reason: &str) -> String {
    format!(
        "{reason}\n  The tests of kinematics, shapes, recordings and of the Python package need {} in target/venv. Install python3 (3.11 or \
         later) with venv and give pip a registry, or run `cargo xtask test --offline`, which leaves these tests out and says so.",
        PACKAGES.join(", ")
    )
}
