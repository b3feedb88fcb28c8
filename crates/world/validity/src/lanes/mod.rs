//! SIMD lanes: sixteen configurations at a time in single precision.
//!
//! Multiplications are fused with additions on every instruction set (in software if the processor cannot), so an answer
//! never depends on the instruction set.
//!
//! Do not use closures in kernels: a closure that is not inlined is compiled for the lowest instruction set.

// A kernel is compiled for the lowest instruction set unless it is inlined into the function that selects the instruction
// set.
#![allow(clippy::inline_always)]

mod row;
mod sin_cos;
#[cfg(test)]
mod sin_cos_tests;

/// The types of vectors, for crates with kernels of their own.
pub use fearless_simd as simd;
pub use row::{Fused, LANES, PointRow, Row, V3, detected_simd_level, splat};
pub(crate) use sin_cos::sin_cos;
