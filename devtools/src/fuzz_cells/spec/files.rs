//! Files that a cell names, beside it.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

/// A text in a file.
#[derive(Debug, Clone)]
pub struct CellFile {
    /// Made from the contents, so that cells do not share it.
    pub name: String,
    pub text: String,
}

impl CellFile {
    pub fn csv(kind: &str, text: String) -> Self {
        let mut hasher = DefaultHasher::new();
        text.hash(&mut hasher);
        Self { name: format!("{kind}-{:016x}.csv", hasher.finish()), text }
    }
}
