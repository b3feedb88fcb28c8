//! Targets of virtual fixtures that a person draws on objects in the page.

mod request;
mod target_drawing;

pub(crate) use target_drawing::{DrawingRefusal, TargetDrawing};
