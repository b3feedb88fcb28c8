//! Shields: a surface that protects a solid and is opened along a target.

mod error;
mod generate;
mod level_set;
mod line_on_surface;
mod opening;
mod passage;
mod settings;
mod target;

pub use error::ShieldError;
pub use generate::{Shield, generate_shield};
pub use line_on_surface::line_on_surface;
pub use passage::Passage;
pub use settings::ShieldSettings;
pub use target::ShieldTarget;
