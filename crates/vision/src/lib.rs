//! Camera frames and point clouds to obstacles: upright prisms with an identity, told as they enter, move and leave.
//!
//! | step | what happens | where |
//! | --- | --- | --- |
//! | frame | PNG, PGM, PPM, raw; a folder, a list, a callback | [`Frame`], [`Source`], [`Files`] |
//! | calibration | four points of the floor, or lens and pose | [`FloorHomography`], [`Camera`], [`Calibration`] |
//! | background | running mean and deviation of each pixel, gain and offset of the light | [`Settings`], [`Light`] |
//! | shadows | dimmed floor is floor, where that is asked for | [`Shadows`] |
//! | the arm | its silhouette is neither thing nor floor | [`PixelMask`], [`ArmPart`] |
//! | blobs | connected foreground | [`Labeller`], [`Blob`] |
//! | tracks | identities by place, size and brightness, kept through touching | [`ObstacleId`], [`Change`] |
//! | templates | a known footprint tells the height, else it is unbounded | [`Template`] |
//! | obstacle | convex footprint grown by an uncertainty, from the floor to a height | [`Obstacle`] |
//! | point clouds | PCD, PLY, depth pictures to the same obstacles | [`cloud`] |
//! | synthetic frames | for tests and demonstrations | [`render`] |
//!
//! [`Vision`] does all of it for a camera, [`cloud::CloudVision`] for a sensor of points. Lengths are metres, times
//! seconds, places in the world's frame; pixels are counted from the upper left corner of the picture, whose first
//! pixel has its middle at (0.5, 0.5). Memory is reused: a frame takes none once lists have grown.
//!
//! # Unknown is not free
//!
//! - A frame that cannot be believed ([`Sight::Blind`]) and a cloud in which nothing was measured
//!   ([`cloud::CloudSight::Empty`]) change no obstacle; the caller decides how long that is good enough.
//! - What the arm hides stays where it was, however long. What it hides in part keeps all that was known of it; where it
//!   was moving, it is taken to go on behind the arm with the velocity it had. What enters behind the arm is not seen.
//! - The background never adapts where something stands, so nothing is absorbed by standing still. What stood there
//!   while the background was learnt is background; a place that was never in sight then is an obstacle.
//! - Without a template that fits, an obstacle is [`Settings::unbounded_height_m`] high.
//!
//! # What one camera cannot know
//!
//! - *Parallax.* A thing seen from above covers more floor than it stands on. Its outline taken to the floor contains
//!   its footprint, so it is used as it is until a template tells the height `h`; then, with the eye `H` above the floor,
//!   the footprint is also within the outline scaled by `1 − h / H` about the point below the eye, and the intersection
//!   of the two is used. This holds for things that stand on the floor and do not overhang: of a table's top, or a load
//!   on a hook, the part towards the point below the eye may lie outside of what is told. A point cloud knows better.
//! - *Templates.* At a single place a high, slim thing covers what a lower, longer one would. A template is believed
//!   only where it fits for some frames in a row and has hardly ever failed to; a high thing that stands still from the
//!   start where it looks like a lower one is still mistaken. Give templates only for what really occurs in the cell.
//! - *Camouflage.* What differs from the floor by less than [`Settings::least_difference`] (or than its noise) is not
//!   seen; with [`Settings::shadows`], neither is an even thing on an even floor that is as dark as a shadow. The
//!   gain of the whole picture is estimated anew in each frame, so light that changes for all pixels alike is no thing.
//! - *Touching things* are cut along a line that is a guess; together they cover all of what is seen, and each is as high
//!   as the highest of them.
//!
//! This is not a certified safety device.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod associate;
mod background;
mod calibration;
mod camera;
mod check;
pub mod cloud;
mod components;
mod decode;
mod detection;
mod encode;
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
mod sets;
mod settings;
mod shadow;
mod source;
mod template;
mod track;
mod tracker;
mod vision;

pub use calibration::Calibration;
pub use camera::{Camera, Intrinsics};
pub use components::{Blob, Labeller};
pub use decode::{RawLayout, decode, read, read_grey16};
pub use encode::encode_png;
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
