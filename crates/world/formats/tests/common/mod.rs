//! Random files and robots for the tests of this crate.

pub mod corpus;
pub mod solids;
