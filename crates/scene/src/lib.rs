//! Robots and objects together, in one world.

mod object;
pub mod pairs;
mod robot;

pub use object::Object;
pub use pairs::{Checker, Member};
pub use robot::{Body, Robot};
