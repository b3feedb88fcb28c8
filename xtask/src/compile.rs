//! C++ programs of the measurements, compiled again only if something has changed.

use std::fs;
use std::path::{Path, PathBuf};

use xtask::shell;

use crate::{machine, native};

/// Source and options of a program.
pub struct Program<'a> {
    pub compiler: &'a str,
    pub name: &'a str,
    pub source: PathBuf,
    /// Other sources of the project that it includes.
    pub included: Vec<PathBuf>,
    /// Compiler arguments before the source.
    pub flags: Vec<String>,
    /// Compiler arguments after the source.
    pub links: Vec<String>,
}

/// Compiles into `folder/bin`, unless the same sources were compiled the same way for the same processor.
pub fn program(root: &Path, folder: &Path, parts: &Program) -> Result<PathBuf, String> {
    let program = folder.join("bin").join(parts.name);
    let (input, output) = (parts.source.display().to_string(), program.display().to_string());
    let mut words: Vec<&str> = vec![parts.compiler];
    words.extend(parts.flags.iter().map(String::as_str));
    words.extend([input.as_str(), "-o", output.as_str()]);
    words.extend(parts.links.iter().map(String::as_str));
    let mut stamp = format!("{}\n{}", words.join(" "), machine::instruction_sets());
    for source in std::iter::once(&parts.source).chain(&parts.included) {
        stamp.push('\n');
        stamp += &fs::read_to_string(source).map_err(|e| format!("{}: {e}", source.display()))?;
    }
    let stamp_file = folder.join("bin").join(format!("{}.stamp", parts.name));
    if program.is_file() && fs::read_to_string(&stamp_file).is_ok_and(|old| old == stamp) {
        return Ok(program);
    }
    shell::make_folder(&folder.join("bin"))?;
    native::run(root, &words, &[])?;
    fs::write(&stamp_file, stamp).map_err(|e| format!("{}: {e}", stamp_file.display()))?;
    Ok(program)
}
