//! Edits of the text of a cell file. Unaffected text stays unchanged, comments included.

use std::path::Path;

use elbowroom_formats::Diagnostic;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Parses the text of a file for an edit.
pub(crate) fn document(path: &Path, text: &str) -> Result<DocumentMut, Diagnostic> {
    // The file was already parsed; errors there have lines.
    text.parse().map_err(|e: toml_edit::TomlError| Diagnostic::new(path, None, e.message().to_owned()))
}

/// Sets a key; whitespace and comments around an existing value stay.
pub(crate) fn put(table: &mut dyn TableLike, key: &str, mut value: Value) {
    if let Some(old) = table.get_mut(key).and_then(Item::as_value_mut) {
        *value.decor_mut() = old.decor().clone();
        *old = value;
    } else {
        table.insert(key, Item::Value(value));
    }
}

/// The text with tables after its end, which begin on a line of their own.
pub(crate) fn appended(text: &str, tables: &str) -> String {
    let gap = if tables.starts_with('\n') { "" } else { "\n" };
    let added = format!("\n{gap}{}\n", tables.trim_end_matches('\n'));
    format!("{}{}", text.trim_end_matches(['\r', '\n']), with_line_ends_of(text, &added))
}

/// An edited text with the line ends of Windows, if the original has only these.
pub(crate) fn with_line_ends_of(original: &str, text: &str) -> String {
    let returns = original.matches("\r\n").count();
    let is_of_windows = returns > 0 && returns == original.matches('\n').count();
    if is_of_windows { text.replace("\r\n", "\n").replace('\n', "\r\n") } else { text.to_owned() }
}
