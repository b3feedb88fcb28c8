//! Random robots and obstacles, oracles, and covers that are built once.
#![allow(dead_code, reason = "each test file uses a part")]

pub mod covers;
pub mod occupancy;
pub mod planar_samples;
pub mod real;
pub mod robots;

pub use planar_samples::*;
