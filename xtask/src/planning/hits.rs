//! Program that asks Coal whether paths hit something, compiled against PyPI's Coal.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{compile, native};

const FLAGS: [&str; 7] = [
    "-std=c++17",
    "-O3",
    "-march=native",
    "-DNDEBUG",
    "-w",
    // The wheel was built without AVX: with wider alignment the layouts of objects would differ.
    "-DEIGEN_MAX_ALIGN_BYTES=16",
    "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16",
];

pub fn program(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let eigen = Path::new("/usr/include/eigen3");
    if !eigen.is_dir() || !native::exists("g++") {
        native::apt(folder, &["g++", "libeigen3-dev"])?;
    }
    let coal = wheel(folder).ok_or("the package coal brought no headers")?;
    let [include, lib] = ["include", "lib"].map(|part| coal.join(part).display().to_string());
    let includes = [format!("-I{include}"), format!("-I{}", eigen.display())];
    let parts = compile::Program {
        compiler: "g++",
        name: "hits",
        source: root.join("xtask/planning/cpp/hits.cpp"),
        included: Vec::new(),
        flags: FLAGS.iter().map(|&flag| flag.to_owned()).chain(includes).collect(),
        links: vec![format!("-L{lib}"), "-lcoal".into(), format!("-Wl,-rpath,{lib}")],
    };
    compile::program(root, folder, &parts)
}

/// Finds the folder of pip's headers and library.
fn wheel(folder: &Path) -> Option<PathBuf> {
    let versions = fs::read_dir(folder.join("venv/lib")).ok()?;
    let mut prefixes = versions.flatten().map(|entry| entry.path().join("site-packages/cmeel.prefix"));
    prefixes.find(|prefix| prefix.join("include/coal/distance.h").is_file())
}
