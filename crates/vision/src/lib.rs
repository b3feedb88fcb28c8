//! Camera frames and point clouds to 2.5-D obstacles.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod associate;
mod background;
mod calibration;
mod camera;
pub mod cloud;
mod components;
mod decode;
mod detection;
mod error;
mod frame;
mod homography;
mod light;
mod mask;
mod morphology;
mod obstacle;
mod point;
pub mod polygon;
mod raster;
pub mod render;
mod report;
mod settings;
mod shadow;
mod source;
mod template;
mod track;
mod vision;

pub use calibration::Calibration;
pub use camera::{Camera, Intrinsics};
pub use components::{Blob, Labeller};
pub use decode::{RawLayout, decode, read, read_grey16};
pub use error::VisionError;
pub use frame::{Channels, Frame};
pub use homography::FloorHomography;
pub use light::Light;
pub use mask::{ArmPart, PixelMask};
pub use obstacle::{Change, Obstacle, ObstacleId};
pub use point::Point2;
pub use report::{Blindness, Report, Sight, Timings};
pub use settings::{Settings, Shadows};
pub use source::{Files, Source};
pub use template::Template;
pub use vision::Vision;
