//! Turns camera frames and point clouds into obstacles: upright prisms with an identity, reported when they enter, move
//! and leave.
//!
//! | step | method | types |
//! | --- | --- | --- |
//! | frame | PNG, PGM, PPM, raw bytes; a folder, a list, a callback | [`Frame`], [`FrameSource`], [`ImageFiles`] |
//! | calibration | homography of the floor, or intrinsics and pose | [`FloorHomography`], [`Camera`], [`Calibration`] |
//! | background subtraction | running mean and deviation of each pixel, gain and offset of the illumination | [`CameraTrackerSettings`], [`Illumination`] |
//! | shadow detection | optional: dimmed floor is not foreground | [`ShadowSettings`] |
//! | self-filter | pixels of the arm are neither foreground nor background | [`PixelMask`], [`ArmPart`] |
//! | blobs | connected components of the foreground | [`ConnectedComponents`], [`Blob`] |
//! | tracking | data association by position, area and brightness; merged and occluded objects | [`ObstacleId`], [`ObstacleChange`] |
//! | templates | a known footprint gives the height; otherwise it is unbounded | [`Template`] |
//! | obstacle | convex footprint inflated by an uncertainty, from the floor to a height | [`Obstacle`] |
//! | point clouds | PCD, PLY and depth images, converted to the same obstacles | [`cloud`] |
//! | visibility | how much of an object's surface a camera sees, and how much of that other parts hide | [`Visibility`] |
//! | synthetic images | for tests and demonstrations | [`render`] |
//!
//! [`CameraTracker`] performs all steps for a camera, [`cloud::CloudTracker`] for a sensor of points. Lengths are in
//! metres, times in seconds, positions in the world frame. Pixels are counted from the upper left corner of the image,
//! whose first pixel has its centre at (0.5, 0.5). Memory is reused: once lists have grown, a frame allocates nothing.
//!
//! ```
//! use elbowroom_spatial::Vec3;
//! use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
//! use elbowroom_vision::{Camera, CameraTracker, CameraTrackerSettings, Channels, Frame, Intrinsics, ObstacleChange, Point2};
//! let lens = Intrinsics::pinhole(160, 120, 1.2);
//! let camera = Camera::look_at(lens, Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y)?;
//! let settings = CameraTrackerSettings { learning_frames: 5, ..CameraTrackerSettings::default() };
//! let mut tracker = CameraTracker::new(camera.clone().into(), settings)?;
//! let mut renderer = Renderer::new(camera, Channels::Grey, 7);
//! let crate_on_floor = RenderedSolid::cuboid(Point2::new(0.4, 0.2), Vec3::new(0.4, 0.3, 0.2), 0.0, 240);
//! let mut frame = Frame::default();
//! for i in 0..6 {
//!     let solids = if i < 5 { vec![] } else { vec![crate_on_floor.clone()] }; // five frames of the empty floor
//!     renderer.render(&solids, &[], &RenderConditions::default(), &mut frame)?;
//!     frame.stamp_s = f64::from(i) * 0.04;
//!     tracker.process(&frame, None)?;
//! }
//! let obstacles = &tracker.report().obstacles;
//! assert_eq!(obstacles.len(), 1);
//! assert_eq!(obstacles[0].change, ObstacleChange::Entered);
//! assert!(obstacles[0].aabb().contains(Vec3::new(0.4, 0.2, 0.1)));
//! # Ok::<(), elbowroom_vision::VisionError>(())
//! ```
//!
//! # Unknown is not free
//!
//! - A rejected frame ([`FrameStatus::Rejected`]) or a cloud without valid points ([`cloud::CloudStatus::Empty`]) does
//!   not change any obstacle; the caller decides how long the obstacles can still be used.
//! - An obstacle that the arm occludes is kept for any length of time. If it is partly occluded, its outline only
//!   grows; if it was moving, it is extrapolated behind the arm with its velocity. An object that enters behind the arm
//!   is not detected.
//! - The background does not adapt at obstacles, so a stationary obstacle never becomes background. Everything that is
//!   present while the background is learnt is background; a place that was masked all that time is an obstacle.
//! - An obstacle without a matching template is [`CameraTrackerSettings::unbounded_height_m`] high.
//!
//! # Limits of a single camera
//!
//! - *Parallax.* An object covers more floor in the image than its footprint. Its outline projected to the floor
//!   contains its footprint, and is used unchanged unless a template gives the height `h`. Then, with the camera `H`
//!   above the floor, the footprint is also within the outline scaled by `1 − h / H` about the point below the camera,
//!   and the intersection of the two is used. This holds for objects that stand on the floor and do not overhang: for a
//!   table top, or a load on a hook, the part towards the point below the camera may be outside the reported prism. A
//!   point cloud does not have this limit.
//! - *Templates.* At a single position, a high, narrow object covers the same floor as a lower, longer one. A template
//!   is accepted only if it matches for some frames in a row and has hardly ever failed to match. A high object that is
//!   stationary from the start, at a place where it looks like a lower one, is still mistaken for it. Use templates
//!   only for objects that occur in the cell.
//! - *Camouflage.* An object that differs from the floor by less than [`CameraTrackerSettings::min_difference`] (or by
//!   less than the floor's noise) is not detected. With [`CameraTrackerSettings::shadows`], an evenly coloured object
//!   on an evenly coloured floor that is as dark as a shadow is not detected either. The gain of the whole image is
//!   estimated in each frame, so a change of illumination common to all pixels is not foreground.
//! - *Touching objects* are divided along an estimated line; together they cover all of the foreground, and each is as
//!   high as the highest of them.
//!
//! This is not a certified safety device.
//!
//! **Invariant.** If a frame is rejected or a cloud has no valid point, no obstacle ever changes or disappears.

#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod association;
mod background;
mod background_subtractor;
mod calibration;
mod camera;
mod camera_tracker;
mod channels;
pub mod cloud;
mod connected_components;
mod detection;
mod detector;
mod disjoint_sets;
mod error;
mod frame;
mod frame_check;
mod frame_source;
mod hidden_floor;
mod homography;
mod illumination;
mod illumination_estimator;
mod image_file;
mod mask;
mod morphology;
mod object_tracker;
mod obstacle;
mod point;
pub mod polygon;
mod raster;
pub mod render;
mod report;
mod settings;
mod shadow;
mod stopwatch;
mod template;
mod template_match;
mod track;
mod track_settings;
mod visibility;

pub use calibration::Calibration;
pub use camera::{Camera, Intrinsics};
pub use camera_tracker::CameraTracker;
pub use channels::Channels;
pub use connected_components::{Blob, ConnectedComponents};
pub use error::VisionError;
pub use frame::Frame;
pub use frame_source::{FrameSource, ImageFiles};
pub use hidden_floor::HiddenFloor;
pub use homography::FloorHomography;
pub use illumination::Illumination;
pub use image_file::{RawLayout, decode, decode_grey16, encode_png, read, read_grey16};
pub use mask::{ArmPart, PixelMask};
pub use obstacle::{Obstacle, ObstacleChange, ObstacleId};
pub use point::Point2;
pub use report::{FrameReport, FrameStatus, RejectReason, StageTimings};
pub use settings::{CameraTrackerSettings, ShadowSettings};
pub use stopwatch::Stopwatch;
pub use template::Template;
pub use track_settings::TrackSettings;
pub use visibility::Visibility;
