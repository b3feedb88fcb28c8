//! VAMP's headers from its source package on PyPI, and the project's programs compiled against them.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{compile, native};

const VERSION: &str = "0.6.4";
const DEBIAN: [&str; 3] = ["clang", "libeigen3-dev", "pdqsort-dev"];
/// Flags of VAMP's CMakeLists.txt for a release with Clang, which makes it about 5 % faster than GCC does.
const FLAGS: [&str; 15] = [
    "-std=c++17",
    "-O3",
    "-DNDEBUG",
    "-march=native",
    "-mavx2",
    "-w",
    "-fno-math-errno",
    "-fno-signed-zeros",
    "-fno-trapping-math",
    "-fno-rounding-math",
    "-ffp-contract=fast",
    "-fassociative-math",
    "-fno-honor-infinities",
    "-fno-honor-nans",
    "-fapprox-func",
];

/// Compiles `xtask/planning/cpp/{name}.cpp`.
pub fn program(root: &Path, folder: &Path, python: &Path, name: &str) -> Result<String, String> {
    if !cfg!(target_arch = "x86_64") {
        return Err("vamp: the recipe is for x86-64".into());
    }
    let vamp = sources(folder, python)?;
    if !Path::new("/usr/include/pdqsort.h").is_file() || !native::exists("clang++") {
        native::apt(folder, &DEBIAN)?;
    }
    let ours = root.join("xtask/planning/cpp");
    let nigh = ["nigh/nigh_forward.hpp", "nigh/lp_space.hpp", "nigh/kdtree_batch.hpp"];
    let headers = ["vamp_scene.hpp", "vamp_problems.hpp"].into_iter().chain(nigh);
    let folders = [vamp.join("src/impl"), "/usr/include/eigen3".into(), ours.clone()];
    let includes = folders.iter().map(|folder| format!("-I{}", folder.display()));
    let parts = compile::Program {
        compiler: "clang++",
        name,
        source: ours.join(format!("{name}.cpp")),
        included: headers.map(|header| ours.join(header)).collect(),
        flags: FLAGS.iter().map(|&flag| flag.to_owned()).chain(includes).collect(),
        links: Vec::new(),
    };
    compile::program(root, folder, &parts).map(|program| program.display().to_string())
}

/// Makes the URDF whose collision geometry is VAMP's spheres of the Panda.
pub fn spheres(folder: &Path, python: &Path) -> Result<String, String> {
    let file = sources(folder, python)?.join("resources/panda/panda_spherized.urdf");
    if file.is_file() { Ok(file.display().to_string()) } else { Err(format!("vamp {VERSION} brought no spheres")) }
}

/// Downloads and unpacks the source package.
fn sources(folder: &Path, python: &Path) -> Result<PathBuf, String> {
    let name = format!("vamp_planner-{VERSION}");
    let unpacked = folder.join(&name);
    let done = unpacked.join("complete");
    if done.is_file() {
        return Ok(unpacked);
    }
    let package = format!("vamp-planner=={VERSION}");
    let python = python.display().to_string();
    // Not `:all:`, which would also compile CMake and everything else that pip needs to read the package.
    let download = [&python, "-m", "pip", "download", "-q", "--no-deps", "--no-binary", "vamp-planner", &package];
    native::run(folder, &download, &[("PIP_DISABLE_PIP_VERSION_CHECK", "1")])?;
    let archive = format!("{name}.tar.gz");
    let parts = [format!("{name}/src/impl"), format!("{name}/resources/panda/panda_spherized.urdf")];
    native::run(folder, &["tar", "-xzf", &archive, &parts[0], &parts[1]], &[])?;
    fs::write(&done, "").map_err(|e| format!("{}: {e}", done.display()))?;
    Ok(unpacked)
}
