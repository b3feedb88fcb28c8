//! The answer to whether a configuration is free.

/// What is known of a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Validity {
    /// Nothing touches: proven.
    Free,
    /// Two solids overlap: proven.
    Hit,
    /// The spheres do not settle it; the exact scene does.
    Uncertain,
}
