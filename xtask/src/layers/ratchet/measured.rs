//! Something that a rule limits, as it is today.

/// A file, a function, a struct or a crate with its size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Measured {
    /// Its name in the list of exceptions.
    pub name: String,
    /// Where it is: `FILE:LINE`.
    pub place: String,
    /// How large it is.
    pub value: usize,
}
