//! Installation of the other libraries: Coal from PyPI, FCL from Debian, parry from crates.io; all of it in `target/peers`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{compile, native};

const COAL: &str = "3.0.3";
const PARRY: &str = "0.31.1";
const FCL_PACKAGES: [&str; 6] = ["g++", "libfcl-dev", "libeigen3-dev", "libboost-dev", "libccd-dev", "liboctomap-dev"];
const FLAGS: [&str; 7] = [
    "-std=c++17",
    "-O3",
    "-march=native",
    "-DNDEBUG",
    "-w",
    // The wheel and Debian's library were built without AVX: with wider alignment the layouts of objects would differ.
    "-DEIGEN_MAX_ALIGN_BYTES=16",
    "-DEIGEN_MAX_STATIC_ALIGN_BYTES=16",
];

/// A peer that can run, or the reason why it cannot.
pub struct Ready {
    pub name: &'static str,
    /// Version, for the report.
    pub version: String,
    pub program: Result<PathBuf, String>,
}

pub fn all(root: &Path, folder: &Path) -> Vec<Ready> {
    let coal = Ready { name: "coal", version: COAL.into(), program: coal(root, folder) };
    let program = fcl(root, folder);
    let fcl = Ready { name: "fcl", version: fcl_version(), program };
    let parry = Ready { name: "parry", version: PARRY.into(), program: parry(root, folder) };
    vec![coal, fcl, parry]
}

fn coal(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let prefix = match wheel(folder) {
        Some(prefix) => prefix,
        None => install_wheel(folder)?,
    };
    compiler(folder)?;
    let eigen = eigen(folder, &prefix)?;
    let [include, lib] = ["include", "lib"].map(|part| prefix.join(part).display().to_string());
    let flags = [format!("-I{include}"), format!("-I{eigen}")];
    let links = [format!("-L{lib}"), "-lcoal".into(), format!("-Wl,-rpath,{lib}")];
    compile(root, folder, "coal", &flags, &links)
}

/// Finds the folder of pip's headers and library, if installed.
fn wheel(folder: &Path) -> Option<PathBuf> {
    let versions = fs::read_dir(folder.join("venv/lib")).ok()?;
    let mut prefixes = versions.flatten().map(|entry| entry.path().join("site-packages/cmeel.prefix"));
    prefixes.find(|prefix| prefix.join("include/coal/distance.h").is_file())
}

fn install_wheel(folder: &Path) -> Result<PathBuf, String> {
    let venv = ["python3", "-m", "venv", "--clear", "venv"];
    if native::run(folder, &venv, &[]).is_err() {
        native::apt(folder, &["python3", "python3-venv"])?;
        native::run(folder, &venv, &[])?;
    }
    pip(folder, &format!("coal=={COAL}"))?;
    wheel(folder).ok_or_else(|| format!("the package coal {COAL} brought no headers"))
}

fn pip(folder: &Path, package: &str) -> Result<(), String> {
    native::run(folder, &["venv/bin/python", "-m", "pip", "install", "-q", "--disable-pip-version-check", package], &[])
}

fn compiler(folder: &Path) -> Result<(), String> {
    if native::exists("g++") { Ok(()) } else { native::apt(folder, &["g++"]) }
}

/// Finds the folder of Eigen's headers: the system's, else PyPI's.
fn eigen(folder: &Path, prefix: &Path) -> Result<String, String> {
    let system = Path::new("/usr/include/eigen3");
    if !system.is_dir() && native::apt(folder, &["libeigen3-dev"]).is_err() {
        pip(folder, "cmeel-eigen")?;
        return Ok(prefix.join("include/eigen3").display().to_string());
    }
    Ok(system.display().to_string())
}

fn fcl(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let headers = Path::new("/usr/include/fcl");
    if !headers.is_dir() || !native::exists("g++") {
        native::apt(folder, &FCL_PACKAGES)?;
    }
    let ours = folder.join("fcl");
    if !ours.join("fcl/config.h").is_file() {
        copy_headers(headers, &ours.join("fcl"))?;
    }
    let flags = [format!("-I{}", ours.display()), "-I/usr/include/eigen3".into()];
    compile(root, folder, "fcl", &flags, &["-lfcl", "-lccd", "-loctomap", "-loctomath"].map(str::to_owned))
}

/// Copies FCL's headers without `extern template`: templates are then compiled here, for this processor, instead of being
/// taken from Debian's library, which is built for any processor.
fn copy_headers(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |path: &Path, e: std::io::Error| format!("{}: {e}", path.display());
    xtask::shell::make_folder(to)?;
    // The file that marks the copy as complete comes last.
    let mut entries: Vec<PathBuf> =
        fs::read_dir(from).map_err(|e| failed(from, e))?.flatten().map(|entry| entry.path()).collect();
    entries.sort_by_key(|path| path.ends_with("config.h"));
    for path in entries {
        let target = to.join(path.file_name().unwrap_or_default());
        if path.is_dir() {
            copy_headers(&path, &target)?;
        } else {
            let text = fs::read(&path).map_err(|e| failed(&path, e))?;
            let text = without_extern_templates(&String::from_utf8_lossy(&text));
            fs::write(&target, text).map_err(|e| failed(&target, e))?;
        }
    }
    Ok(())
}

fn without_extern_templates(text: &str) -> String {
    let mut parts = text.split("extern template");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| kept + part.split_once(';').map_or("", |(_, rest)| rest))
}

fn fcl_version() -> String {
    let config = fs::read_to_string("/usr/include/fcl/config.h").unwrap_or_default();
    let line = config.lines().find(|line| line.starts_with("#define FCL_VERSION "));
    line.and_then(|line| line.split('"').nth(1)).unwrap_or("?").to_owned()
}

/// Compiles `xtask/peers/cpp/{name}.cpp`.
fn compile(root: &Path, folder: &Path, name: &str, flags: &[String], links: &[String]) -> Result<PathBuf, String> {
    let sources = root.join("xtask/peers/cpp");
    let parts = compile::Program {
        compiler: "g++",
        name,
        source: sources.join(format!("{name}.cpp")),
        included: vec![sources.join("runner.hpp")],
        flags: FLAGS.iter().map(|&flag| flag.to_owned()).chain(flags.iter().cloned()).collect(),
        links: links.to_vec(),
    };
    compile::program(root, folder, &parts)
}

fn parry(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let target = folder.join("parry");
    let (cargo, to) = (native::cargo(), target.display().to_string());
    let manifest = "xtask/peers/parry/Cargo.toml";
    let words = [&cargo, "build", "--quiet", "--release", "--locked", "--manifest-path", manifest, "--target-dir", &to];
    native::run(root, &words, &[("RUSTFLAGS", "-C target-cpu=native")])?;
    Ok(target.join("release/peer-parry"))
}

#[cfg(test)]
mod tests {
    use super::without_extern_templates;

    #[test]
    fn extern_templates_go_and_the_rest_stays() {
        let text = "a;\nextern template\nclass X<int>;\nextern \"C\" {}\nextern template class Y;b";
        assert_eq!(without_extern_templates(text), "a;\n\nextern \"C\" {}\nb");
        assert_eq!(without_extern_templates("nothing"), "nothing");
    }
}
