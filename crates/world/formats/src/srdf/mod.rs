//! SRDF: groups, named states, end effectors, virtual joints, and the link pairs that are not tested.

mod model;
mod parser;
mod writer;

pub use model::{DisabledPair, EndEffector, Group, GroupState, Srdf, VirtualJoint};
pub use parser::parse;
