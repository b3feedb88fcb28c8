//! `cargo xtask wheel`: the Python package as a wheel, installed and tested as a user would.

use std::path::{Path, PathBuf};

use xtask::{python, shell};

/// Builds the wheel. Pinned, as everything that makes a release.
const MATURIN: &str = "maturin==1.16.0";
/// The same with Zig, which links against old versions of the C library.
const MATURIN_AND_ZIG: &str = "maturin[zig]==1.16.0";
/// The oldest Linux for which wheels are made: that with this version of glibc.
const MANYLINUX: &str = "manylinux_2_28";
/// Largest wheel, bytes.
const LARGEST: u64 = 25 * 1024 * 1024;

/// Builds `target/wheels/elbowroom-VERSION-…whl`, for this machine or for old Linux too, and runs the tests with it in a new
/// environment.
pub fn run(root: &Path, manylinux: bool) -> Result<(), String> {
    let target = shell::target_folder(root);
    let maturin = if manylinux { MATURIN_AND_ZIG } else { MATURIN };
    let builder = python::environment(root, &target.join("wheel/build"), &[maturin], &[])?;
    let wheels = target.join("wheels");
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels).map_err(|e| format!("{}: {e}", wheels.display()))?;
    }
    let out = wheels.to_string_lossy().into_owned();
    let mut words = vec!["-m", "maturin", "build", "--release", "--locked", "--out", &out];
    if manylinux {
        words.extend(["--zig", "--compatibility", MANYLINUX]);
    }
    // Zig is a package of the same environment, and is searched for on the search path.
    let folder = builder.parent().unwrap_or(root).display();
    let search_path = format!("{folder}:{}", std::env::var("PATH").unwrap_or_default());
    shell::run(&root.join("python"), &builder.to_string_lossy(), &words, &[("PATH", &search_path)])?;
    let wheel = only_wheel(&wheels)?;
    let bytes = std::fs::metadata(&wheel).map_err(|e| format!("{}: {e}", wheel.display()))?.len();
    println!("{}: {:.1} MB", wheel.display(), bytes as f64 / 1e6);
    if bytes > LARGEST {
        return Err(format!("the wheel has {bytes} bytes, more than {LARGEST}"));
    }
    let file = wheel.to_string_lossy().into_owned();
    let packages = [
        &file,
        python::BASEDPYRIGHT,
        python::PYTEST,
        python::HYPOTHESIS,
        python::PYARROW,
        python::RAY,
        python::SCIPY,
        python::MATPLOTLIB,
        python::PINOCCHIO,
        python::TRIMESH,
        python::YOURDFPY,
        python::RERUN,
        python::SPHINX,
    ];
    let python = python::environment(root, &target.join("wheel/test"), &packages, &[])?;
    let python = python.to_string_lossy().into_owned();
    let tests = root.join("python/tests").to_string_lossy().into_owned();
    // From another folder, so that the installed package is found and not its sources.
    shell::run(&target.join("wheel"), &python, &["-m", "pytest", "-q", "-p", "no:cacheprovider", &tests], &[])
}

fn only_wheel(folder: &Path) -> Result<PathBuf, String> {
    let files = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut wheels = files.flatten().map(|file| file.path()).filter(|p| p.extension().is_some_and(|e| e == "whl"));
    wheels.next().ok_or_else(|| format!("{}: maturin has written no wheel", folder.display()))
}
