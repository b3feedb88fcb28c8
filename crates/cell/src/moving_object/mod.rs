//! Objects that move by themselves: on a conveyor, or along a path.

mod belt;
mod drive;
mod motion;
mod path;

pub use belt::{Encoder, Travel};
pub use drive::{Drive, MovingObject};
pub use motion::ObjectMotion;
pub use path::{ObjectPath, PathRepeat};
