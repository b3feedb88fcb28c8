//! The allowed collision matrix: which pairs are tested, how far apart they must stay, in which order, and why.

mod edit;
mod entry;
mod matrix;
mod out_of_reach;
mod reason;
mod rules;
mod sampling;
mod text;

pub use edit::PairEdit;
pub use entry::{PairEntry, PairNumber, PairState};
pub use matrix::AllowedCollisionMatrix;
pub(crate) use matrix::OBJECTS_WEIGHT;
pub(crate) use out_of_reach::prove_out_of_reach;
pub use reason::Reason;
pub(crate) use rules::by_rules;
