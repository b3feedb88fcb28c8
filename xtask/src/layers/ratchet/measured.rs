//! Item that a rule limits, with its present size.

/// A file, a function, a struct or a crate with its size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Measured {
    /// Its name in the list of exceptions.
    pub name: String,
    /// Its place: `FILE:LINE`.
    pub place: String,
    /// Its size.
    pub value: usize,
}
