//! `cargo xtask dist`: the library for C and C++ as a folder and an archive to copy, with an example that was compiled from them.

use std::collections::BTreeSet;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;
use xtask::{crates, shell};

use crate::native;

/// Package of the library.
const PACKAGE: &str = "elbowroom-capi";
const LIBRARY: &str = "elbowroom_capi";

/// Builds `target/dist/elbowroom-VERSION-TARGET` and its archive.
pub fn run(root: &Path) -> Result<(), String> {
    let version = version(root)?;
    let name = format!("elbowroom-{version}-{}", target(root)?);
    let parent = shell::target_folder(root).join("dist");
    let folder = parent.join(&name);
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    shell::cargo(root, &["build", "--release", "--package", PACKAGE, "--lib"], &[])?;
    let file = format!("{DLL_PREFIX}{LIBRARY}{DLL_SUFFIX}");
    copy(&shell::target_folder(root).join("release").join(&file), &folder.join("lib").join(&file))?;
    let sources = root.join("crates/front/capi");
    for header in ["elbowroom.h", "elbowroom.hpp"] {
        copy(&sources.join("include").join(header), &folder.join("include").join(header))?;
    }
    let example = folder.join("share/elbowroom/examples/two_arms.cpp");
    copy(&sources.join("examples/two_arms.cpp"), &example)?;
    write(&folder.join("lib/pkgconfig/elbowroom.pc"), &pkg_config(&version))?;
    licences(root, &folder.join("share/licenses/elbowroom"))?;
    build_example(&folder, &example)?;
    let model = root.join("examples/models/rx60b/rx60b.urdf").display().to_string();
    let program = folder.join("bin/two_arms").display().to_string();
    let rows = shell::output(root, &program, &[&model, "0.7", "100"])?;
    if rows.lines().count() != 101 {
        return Err(format!("{program} prints {} lines for 100 states\n{rows}", rows.lines().count()));
    }
    native::run(&parent, &["tar", "-czf", &format!("{name}.tar.gz"), &name], &[])?;
    println!("{}\n{}.tar.gz", folder.display(), folder.display());
    Ok(())
}

/// Compiles the example as a user of the folder does: by pkg-config.
fn build_example(folder: &Path, example: &Path) -> Result<(), String> {
    let settings = folder.join("lib/pkgconfig").display().to_string();
    let asked = ["--cflags", "--libs", "elbowroom"];
    let options = shell::output_with(folder, "pkg-config", &asked, &[("PKG_CONFIG_PATH", &settings)])?;
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    shell::make_folder(&folder.join("bin"))?;
    let example = example.display().to_string();
    let mut words = vec![compiler.as_str(), "-std=c++17", "-O2", &example, "-o", "bin/two_arms"];
    words.extend(options.split_whitespace());
    words.extend(["-Wl,-rpath,$ORIGIN/../lib", "-pthread"]);
    native::run(folder, &words, &[])
}

/// The package file; its paths follow from its own place, so that the folder can be moved.
fn pkg_config(version: &str) -> String {
    format!(
        "prefix=${{pcfiledir}}/../..\nincludedir=${{prefix}}/include\nlibdir=${{prefix}}/lib\n\n\
         Name: elbowroom\nDescription: Proximity queries of robots and cells\nVersion: {version}\n\
         Cflags: -I${{includedir}}\nLibs: -L${{libdir}} -l{LIBRARY}\n"
    )
}

fn version(root: &Path) -> Result<String, String> {
    let manifest = crates::manifest(&root.join("Cargo.toml"))?;
    let version = manifest.get("workspace").and_then(|w| w.get("package")?.get("version")?.as_str());
    version.map(str::to_owned).ok_or_else(|| "Cargo.toml: [workspace.package] has no version".to_owned())
}

/// The target that rustc compiles for.
fn target(root: &Path) -> Result<String, String> {
    let text = shell::output(root, "rustc", &["-vV"])?;
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| format!("rustc -vV names no host:\n{text}"))
}

/// Copies our licences, and those of every crate that the library contains.
fn licences(root: &Path, folder: &Path) -> Result<(), String> {
    for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
        copy(&root.join(name), &folder.join(name))?;
    }
    let cargo = native::cargo();
    let tree = ["tree", "-p", PACKAGE, "-e", "normal", "--prefix", "none", "--format", "{p}\t{l}"];
    let tree = shell::output(root, &cargo, &tree)?;
    let metadata = shell::output(root, &cargo, &["metadata", "--format-version", "1"])?;
    let metadata: Value = serde_json::from_str(&metadata).map_err(|e| format!("cargo metadata: {e}"))?;
    let mut list = BTreeSet::new();
    for (package, licence) in tree.lines().filter_map(|line| line.split_once('\t')) {
        let mut words = package.split(' ');
        let (Some(name), Some(version)) = (words.next(), words.next()) else { continue };
        if name.starts_with("elbowroom")
            || !list.insert(format!("{name} {version}: {}\n", licence.trim_end_matches(" (*)")))
        {
            continue;
        }
        if let Some(source) = source_of(&metadata, name, version.trim_start_matches('v')) {
            copy_licences(&source, &folder.join(format!("{name}-{version}")))?;
        }
    }
    write(&folder.join("CRATES.txt"), &list.into_iter().collect::<String>())
}

/// The folder of a package.
fn source_of(metadata: &Value, name: &str, version: &str) -> Option<PathBuf> {
    let packages = metadata["packages"].as_array()?;
    let found = packages.iter().find(|package| package["name"] == name && package["version"] == version)?;
    Path::new(found["manifest_path"].as_str()?).parent().map(Path::to_owned)
}

fn copy_licences(from: &Path, to: &Path) -> Result<(), String> {
    let entries = fs::read_dir(from).map_err(|e| format!("{}: {e}", from.display()))?;
    for path in entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_uppercase();
        if ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"]
            .iter()
            .any(|known| name.starts_with(known))
        {
            copy(&path, &to.join(path.file_name().unwrap_or_default()))?;
        }
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    shell::make_folder(to.parent().unwrap_or(Path::new("")))?;
    fs::copy(from, to).map(|_| ()).map_err(|e| format!("{} to {}: {e}", from.display(), to.display()))
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    shell::make_folder(path.parent().unwrap_or(Path::new("")))?;
    fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_package_file_finds_library_and_headers_where_it_is() {
        let text = pkg_config("1.2.3");
        assert!(text.contains("\nVersion: 1.2.3\n") && text.starts_with("prefix=${pcfiledir}/../..\n"), "{text}");
        assert!(text.contains("\nLibs: -L${libdir} -lelbowroom_capi\n"), "{text}");
        let root = crate::workspace_root().unwrap();
        assert_eq!(version(&root).unwrap(), env!("CARGO_PKG_VERSION"));
        let manifest = crates::manifest(&root.join("crates/front/capi/Cargo.toml")).unwrap();
        assert_eq!(manifest["package"]["name"].as_str(), Some(PACKAGE));
    }
}
