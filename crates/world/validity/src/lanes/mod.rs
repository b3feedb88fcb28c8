//! SIMD lanes: sixteen configurations at a time in single precision.
//!
//! Multiplications are fused with additions on every instruction set (where the processor cannot, in software), so that an
//! answer never depends on it.
//!
//! No closures in kernels: a closure is compiled for the lowest instruction set unless it is inlined.

// A kernel that is not inlined into the function its instruction set is chosen for is compiled for the lowest one.
#![allow(clippy::inline_always)]

mod row;
mod sin_cos;
#[cfg(test)]
mod sin_cos_tests;

pub use row::{Fused, LANES, PointRow, Row, V3, detected_simd_level, splat};
pub(crate) use sin_cos::sin_cos;
