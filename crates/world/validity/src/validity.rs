//! The result of a check of a configuration.

/// Result of a check of a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Validity {
    /// Proven free: the solids do not touch.
    Free,
    /// Proven in collision: two solids overlap.
    Hit,
    /// The spheres prove neither; the exact scene decides.
    Uncertain,
}
