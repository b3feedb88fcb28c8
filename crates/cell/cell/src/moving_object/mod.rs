//! Objects that move by themselves: on a conveyor, or along a path.

mod drive;
mod encoder;
mod motion;
mod path;

pub use drive::{Drive, MovingObject};
pub use encoder::{Encoder, Travel};
pub use motion::ObjectMotion;
pub use path::{ObjectPath, PathRepeat};
