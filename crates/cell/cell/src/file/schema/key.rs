//! A key, and a word with the keys that belong to it. The texts are Markdown, for `docs/cell-file.md`.

/// A key of a table of the cell file.
#[derive(Debug, Clone, Copy)]
pub(in crate::file) struct Key {
    pub(in crate::file) name: &'static str,
    /// Type, as in "length per second".
    pub(super) kind: &'static str,
    /// What holds without the key; "required" if the file is refused then.
    pub(super) default: &'static str,
    pub(super) meaning: &'static str,
}

/// A word that a table may have, such as a shape or a kind of step, and the keys that belong to it.
#[derive(Debug)]
pub(in crate::file) struct Variant {
    pub(in crate::file) word: &'static str,
    pub(in crate::file) keys: &'static [Key],
    pub(super) note: &'static str,
}

pub(super) const fn key(name: &'static str, kind: &'static str, default: &'static str, meaning: &'static str) -> Key {
    Key { name, kind, default, meaning }
}

pub(super) const fn variant(word: &'static str, keys: &'static [Key], note: &'static str) -> Variant {
    Variant { word, keys, note }
}

/// The names of the keys of several lists, as `Table::only` takes them.
pub(in crate::file) fn names(lists: &[&[Key]]) -> Vec<&'static str> {
    lists.iter().flat_map(|list| list.iter()).map(|key| key.name).collect()
}
