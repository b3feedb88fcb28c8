//! Thread between the source and the pages: measures distances and makes frames.

mod distances;
mod jog;
mod run;

pub(crate) use jog::JogCell;
pub(crate) use run::{Model, SentFrame, run};
