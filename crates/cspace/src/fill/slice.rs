//! What one plane needs while it is filled.

use super::lanes::WIDTH;

/// Buffers of one plane, one number per row and border, padded to whole vectors.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    /// Lower and upper ends in cells of θ3, and the middle between them, at the borders of rows.
    pub lo: Vec<f32>,
    pub hi: Vec<f32>,
    pub middle: Vec<f32>,
    /// One bit per row: the upper arm blocks all of it.
    pub full: Vec<u16>,
}

impl Scratch {
    pub fn new(rows: usize) -> Self {
        let padded = (rows + 1).next_multiple_of(WIDTH) + WIDTH;
        let zeros = || vec![0.0; padded];
        Self { lo: zeros(), hi: zeros(), middle: zeros(), full: vec![0; rows.div_ceil(WIDTH)] }
    }
}
