//! The JSON text as entries in the order of the file, with unique keys.

use std::collections::HashSet;
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde_json::error::Category;

use crate::Diagnostic;

/// The layout, for messages.
pub(super) const LAYOUT: &str = "{\"SET\": {\"ID\": {\"scene\": {…}, \"request\": {…}}}}";

/// The entries of a JSON object. A repeated key is an error, because its first entry would be lost.
#[derive(Debug)]
pub(super) struct Entries<T>(pub(super) Vec<(String, T)>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(EntriesVisitor(PhantomData))
    }
}

struct EntriesVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for EntriesVisitor<T> {
    type Value = Entries<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of sets of problems")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut known = HashSet::new();
        let mut entries = Vec::new();
        while let Some(key) = map.next_key::<String>()? {
            if !known.insert(key.clone()) {
                return Err(A::Error::custom(format_args!("the key `{key}` occurs twice")));
            }
            entries.push((key, map.next_value()?));
        }
        Ok(Entries(entries))
    }
}

/// Parses the text.
///
/// # Errors
/// [`Diagnostic`] with the line, if the text is not JSON or has another layout.
pub(super) fn parse<'de, T: Deserialize<'de>>(text: &'de str, file: &Path) -> Result<T, Diagnostic> {
    serde_json::from_str(text).map_err(|e| {
        let line = (e.line() > 0).then_some(e.line());
        let (what, hint) = match e.classify() {
            Category::Data => (format!("is no set of planning problems: {e}"), LAYOUT),
            Category::Eof => (format!("is truncated: {e}"), "the complete file: copy or download it again"),
            Category::Syntax | Category::Io => {
                (format!("is not JSON: {e}"), "JSON, in which all numbers are finite (it has no NaN and no Infinity)")
            }
        };
        Diagnostic::new(file, line, what).hint(hint)
    })
}
