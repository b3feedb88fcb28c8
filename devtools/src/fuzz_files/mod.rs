//! `cargo xtask fuzz parser` and `cargo xtask fuzz cell-file`: fuzzing of the readers with mutated files.

mod cell_file;
mod parser;
mod words;

use xtask::Failure;

/// Fuzzes one reader of robots, meshes and scenes: the words after `fuzz parser`.
pub fn parser(words: &[&str]) -> Result<(), Failure> {
    parser::run(&parser::Options::parse(words).map_err(Failure::Usage)?)
}

/// Fuzzes the reader and the simulation of cell files: the words after `fuzz cell-file`.
pub fn cell_file(words: &[&str]) -> Result<(), Failure> {
    cell_file::run(&cell_file::Options::parse(words).map_err(Failure::Usage)?)
}
