//! SRDF: groups, named states, end effectors, virtual joints, and disabled pairs of links.

mod model;
mod parser;
mod writer;

pub use model::{DisabledPair, EndEffector, Group, GroupState, Srdf, VirtualJoint};
pub use parser::parse;
