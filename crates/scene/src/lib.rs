//! Robots and objects together, in one world.

mod object;
mod robot;

pub use object::Object;
pub use robot::{Body, Robot};
