//! What one plane needs while it is filled.

use super::lanes::WIDTH;

/// Buffers of one plane.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    /// One bit per row: the upper arm blocks all of it.
    pub full: Vec<u16>,
}

impl Scratch {
    pub fn new(rows: usize) -> Self {
        Self { full: vec![0; rows.div_ceil(WIDTH)] }
    }
}
