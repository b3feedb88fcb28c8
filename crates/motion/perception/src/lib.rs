//! Perception: turns the observations of cameras and point clouds into obstacles with an identity, and these into
//! occupied cells of a robot's joint-space map.
//!
//! An [`ObstacleWatcher`] processes the frames of a camera, a [`CloudWatcher`] point clouds, each with the joint values
//! of all robots at that time. Each returns the changes as an [`ObstacleUpdate`]. A planner on another thread reads the
//! map through a lock-free reader. [`motion_entry`] contains the functions with which a robot enters a new path without
//! a stop.
//!
//! ```
//! use elbowroom_cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, RemainingJoints};
//! use elbowroom_perception::{ObstacleWatcher, PerceptionSettings, WatchedRobot};
//! use elbowroom_robot::example;
//! use elbowroom_spatial::{Pose, Vec3};
//! use elbowroom_vision::render::{RenderConditions, RenderedSolid, Renderer};
//! use elbowroom_vision::{Camera, CameraTrackerSettings, Channels, Frame, Intrinsics, Point2};
//! let (robot, base_in_world) = (example::arm()?, Pose::IDENTITY);
//! let grid = Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 6.0).unwrap()))?;
//! let (wrist, covers) = (RemainingJoints::Swept, CoverMapSettings::default());
//! let builder = CoverMapBuilder::new(&robot, base_in_world, &grid, [0, 1, 2], wrist, covers)?;
//! let camera = Camera::look_at(Intrinsics::pinhole(160, 120, 0.9), Vec3::Z * 4.0, Vec3::ZERO, Vec3::Y)?;
//! let vision = CameraTrackerSettings { learning_frames: 5, ..CameraTrackerSettings::default() };
//! let robots = vec![WatchedRobot { robot, base_in_world }];
//! let mut watcher =
//!     ObstacleWatcher::new(robots, builder, camera.clone().into(), vision, PerceptionSettings::default())?;
//! // Five frames of the empty floor, then a crate within reach.
//! let crate_at = RenderedSolid::cuboid(Point2::new(0.8, 0.2), Vec3::new(0.3, 0.3, 0.6), 0.0, 30);
//! let (mut renderer, mut frame) = (Renderer::new(camera, Channels::Grey, 1), Frame::default());
//! for i in 0..10 {
//!     let solids = if i < 5 { &[][..] } else { std::slice::from_ref(&crate_at) };
//!     renderer.render(solids, &[], &RenderConditions::default(), &mut frame)?;
//!     frame.stamp_s = f64::from(i) * 0.04;
//!     watcher.process_frame(&frame, &[&[-1.5, -1.5, 0.0]])?;
//! }
//! assert!(watcher.prisms().len() == 1 && watcher.map().occupancy().blocked() > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conservative assumptions
//!
//! - The prism that vision reports contains the observed outline, dilated by
//!   [`TrackSettings::uncertainty_m`](elbowroom_vision::TrackSettings::uncertainty_m). This uncertainty
//!   must cover the motion of the obstacle until the next frame has been processed: its speed times (period + latency),
//!   plus the calibration error.
//! - In the map the prism also covers its predicted positions up to [`PerceptionSettings::prediction_s`], at constant
//!   velocity: time for a robot to stop or to move away.
//!
//! Perception does not prevent an obstacle from moving into a stopped robot. This is not a certified safety device.
//!
//! **Invariant.** A frame or cloud that is not accepted never frees a cell: unknown is not free.

mod cloud_watcher;
mod error;
mod map_updater;
pub mod motion_entry;
mod observation;
mod obstacle_update;
mod obstacle_watcher;
mod prism_boxes;
mod robot_map;
mod robot_prisms;
mod settings;
mod times;
mod watched_robots;

pub use cloud_watcher::CloudWatcher;
pub use error::PerceptionError;
pub use obstacle_update::{ObstacleUpdate, Prism};
pub use obstacle_watcher::ObstacleWatcher;
pub use settings::PerceptionSettings;
pub use times::PerceptionTimes;
pub use watched_robots::WatchedRobot;
