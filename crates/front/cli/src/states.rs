//! `--states FILE`: joint states from a file, or from standard input.

use std::path::Path;

use elbowroom::Diagnostic;
use elbowroom::cell::QueryModel;
use elbowroom::query::QueryStates;

/// Reads the states of `path`; `-` is standard input.
pub(crate) fn read(path: &Path, model: &QueryModel) -> Result<QueryStates, Diagnostic> {
    if path == Path::new("-") {
        return QueryStates::read_from(Path::new("standard input"), std::io::stdin().lock(), model);
    }
    QueryStates::read(path, model)
}
