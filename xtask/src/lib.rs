//! Parts shared by the developers' programs: [`Failure`], options, other programs, the Python of the references.
#![allow(clippy::print_stdout, reason = "for programs that talk to the person who started them")]

pub mod browser;
pub mod call;
pub mod crates;
pub mod playwright;
pub mod python;
pub mod shell;

pub use call::Failure;
