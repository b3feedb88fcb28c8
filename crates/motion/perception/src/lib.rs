//! Obstacle perception and replanning: camera frames in, motion out.
//!
//! [`PerceptionPipeline`] turns each frame into obstacles and these into occupied cells of the joint-space map.
//! [`ReplanningExecutor`] moves the arm to a goal through free cells, replans around obstacles while it moves, and
//! slows down or stops where there is no path. Both may run in one thread or in two: the executor reads the map through
//! a lock-free reader, and an [`ObstacleUpdate`] is all that passes between them ([`PerceptionWorker`] runs a pipeline
//! on its own thread).
//!
//! ```
//! use std::f64::consts::FRAC_PI_2;
//! use std::sync::Arc;
//! use elbowroom_perception::{ExecutorState, ReplanningExecutor, ExecutorSettings, PerceptionPipeline, PerceptionSettings, MappedArm};
//! use elbowroom_cspace::{JointConvention, PlanarArm};
//! use elbowroom_planner::KinematicLimits;
//! use elbowroom_robot::example;
//! use elbowroom_spatial::{Pose, Vec3};
//! use elbowroom_vision::{Camera, Channels, Frame, Intrinsics, CameraTrackerSettings};
//! let arm = Arc::new(MappedArm {
//!     robot: example::arm()?,
//!     base_in_world: Pose::IDENTITY,
//!     planar: PlanarArm {
//!         offset_m: 0.0, height_m: 0.35, upper_length_m: 0.45, upper_radius_m: 0.08,
//!         fore_length_m: 0.35, fore_radius_m: 0.06, wrist_radius_m: 0.06,
//!     },
//!     // Upright at zero, the forearm too.
//!     convention: JointConvention { sign: [1.0; 3], offset_rad: [0.0, 0.0, -FRAC_PI_2] },
//!     joints: [0, 1, 2],
//! });
//! let lens = Intrinsics::pinhole(160, 120, 0.6);
//! let camera = Camera::look_at(lens, Vec3::new(2.0, 0.0, 2.0), Vec3::new(2.0, 0.0, 0.0), Vec3::Y)?;
//! let vision = CameraTrackerSettings { learning_frames: 5, ..CameraTrackerSettings::default() };
//! let settings = PerceptionSettings::default();
//! let mut pipeline = PerceptionPipeline::new(Arc::clone(&arm), 0.06, camera.into(), vision, settings)?;
//! let limits = KinematicLimits { velocity: vec![2.0; 3], acceleration: vec![10.0; 3], jerk: vec![100.0; 3] };
//! let mut q = vec![-1.0, 1.2, 0.3];
//! let settings = ExecutorSettings::new(limits);
//! let mut executor = ReplanningExecutor::new(arm, pipeline.map().grid(), pipeline.reader(), None, settings, &q)?;
//! executor.set_goal(&[1.0, 1.2, 0.3])?;
//! let mut frame = Frame::new("camera", 160, 120, Channels::Grey, vec![90; 160 * 120])?;
//! for i in 0..6 {
//!     frame.stamp_s = f64::from(i) * 0.04;
//!     let update = pipeline.process_frame(&frame, &q)?; // five frames of the empty floor are learned
//!     executor.update(&update);
//!     for tick in 1..=10 {
//!         let step = executor.tick(frame.stamp_s + 0.004 * f64::from(tick), 0.004);
//!         assert_eq!(step.state == ExecutorState::Moving, i == 5);
//!         q = step.q;
//!     }
//! }
//! assert!(q[0] > -1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conservative assumptions
//!
//! - The prism that vision reports contains what was seen in the frame, dilated by
//!   [`CameraTrackerSettings::uncertainty_m`](elbowroom_vision::CameraTrackerSettings::uncertainty_m). That must cover the motion of the obstacle
//!   until the next frame has been processed: its speed times (period + latency), plus the calibration error.
//! - In the map it also covers its predicted positions up to [`PerceptionSettings::prediction_s`], at constant
//!   velocity: time for the arm to stop or to move away.
//! - A path is free if all cells that it touches are free; a new path is also checked continuously in the exact scene
//!   with the prisms.
//! - Without an accepted image for [`ExecutorSettings::stale_s`], the arm slows to a stop and reports why.
//!
//! An obstacle that moves into a stopped arm is not prevented from doing so. This is not a certified safety device.
//!
//! **Invariant.** Unless the last accepted image is at most [`ExecutorSettings::stale_s`] old, a tick of the
//! [`ReplanningExecutor`] never speeds the arm up: it always brakes along its path to rest.

mod arc_limit;
mod cloud_watcher;
mod error;
mod exact_path_checker;
mod executor;
mod executor_settings;
mod executor_state;
mod executor_step;
mod free_arc;
mod map_updater;
mod mapped_arm;
pub mod motion_entry;
mod observation;
mod obstacle_update;
mod obstacle_watcher;
mod path_execution;
mod perception_log;
pub mod picture;
mod pipeline;
mod prism_boxes;
mod replan_in_motion;
mod replan_result;
mod robot_map;
mod times;
mod watched_robots;
mod worker;

pub use cloud_watcher::CloudWatcher;
pub use error::PerceptionError;
pub use exact_path_checker::ExactPathChecker;
pub use executor::ReplanningExecutor;
pub use executor_settings::{ExecutorError, ExecutorSettings};
pub use executor_state::{ExecutorState, HoldReason};
pub use executor_step::ExecutorStep;
pub use mapped_arm::MappedArm;
pub use obstacle_update::{ObstacleUpdate, Prism};
pub use obstacle_watcher::ObstacleWatcher;
pub use perception_log::{FrameEntry, GroundTruth, PerceptionLog, ReportImage, TickEntry};
pub use pipeline::{PerceptionPipeline, PerceptionSettings};
pub use replan_result::ReplanResult;
pub use times::{PerceptionTimes, ReplanTimes};
pub use watched_robots::WatchedRobot;
pub use worker::{CapturedImage, PerceptionWorker};
