//! The keys of the cell file: the readers accept these, and the tables of `docs/cell-file.md` are made of them.

mod fixtures;
mod grids;
mod key;
mod model;
mod motion;
mod reference;
mod regions;
mod sensors;
mod settings;

pub(super) use fixtures::*;
pub(super) use grids::*;
pub(super) use key::names;
pub(super) use model::*;
pub(super) use motion::*;
pub use reference::key_reference;
pub(super) use regions::*;
pub(super) use sensors::*;
pub(super) use settings::*;
