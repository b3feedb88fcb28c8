//! Files that a cell names, beside it.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

/// A file, mostly a table of numbers.
#[derive(Debug, Clone)]
pub struct CellFile {
    /// Made from the contents, so that cells do not share it.
    pub name: String,
    pub text: String,
}

impl CellFile {
    /// Creates a file whose name has the kind, a number made from the text, and the extension.
    pub fn new(kind: &str, extension: &str, text: String) -> Self {
        let mut hasher = DefaultHasher::new();
        text.hash(&mut hasher);
        Self { name: format!("{kind}-{:016x}.{extension}", hasher.finish()), text }
    }

    /// Creates a table whose cells are separated by commas.
    pub fn csv(kind: &str, head: &str, rows: impl IntoIterator<Item = Vec<f64>>) -> Self {
        Self::separated(kind, ',', head, rows)
    }

    /// Creates a table with decimal commas where commas do not separate; `head` has commas in any case.
    pub fn separated(kind: &str, separator: char, head: &str, rows: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let between = separator.to_string();
        let number = |value: &f64| {
            let text = value.to_string();
            if separator == ',' { text } else { text.replace('.', ",") }
        };
        let mut text = head.replace(',', &between) + "\n";
        for row in rows {
            text += &(row.iter().map(number).collect::<Vec<String>>().join(&between) + "\n");
        }
        Self::new(kind, "csv", text)
    }
}
