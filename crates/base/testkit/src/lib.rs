//! What the tests, examples and tools of several crates share. No crate that is shipped links it: it is a dependency of
//! tests only.

pub mod allocation;
pub mod folder;
pub mod hash;
pub mod network;
pub mod random;
