//! What the tests, examples and tools of several crates share. No crate that is shipped links it: it is a dependency of
//! tests only.

pub mod bench;
pub mod random;
