//! A camera watches, the joint map follows, the arm goes around: frames in, motion out.
//!
//! [`Watch`] turns each frame into obstacles and these into blocked cells of the joint map; [`Guide`] moves the arm to a goal
//! on free cells, goes around what has come between while it moves, slows and stops where there is no way. Both may
//! live in one thread or in two: the guide looks at the map through a reader without locks, and a [`Sighting`] is all that
//! passes between them ([`Sentry`] is a watch on a thread of its own).
//!
//! ```
//! use std::f64::consts::FRAC_PI_2;
//! use std::sync::Arc;
//! use elbowroom_cell::watch::{Doing, Guide, GuideSettings, Watch, WatchSettings, WatchedArm};
//! use elbowroom_cspace::{JointSigns, PlanarArm};
//! use elbowroom_planner::MotionLimits;
//! use elbowroom_scene::example;
//! use elbowroom_spatial::{Pose, Vec3};
//! use elbowroom_vision::{Camera, Channels, Frame, Intrinsics, Settings};
//! let arm = Arc::new(WatchedArm {
//!     robot: example::arm()?,
//!     base_in_world: Pose::IDENTITY,
//!     planar: PlanarArm {
//!         offset_m: 0.0, height_m: 0.35, upper_length_m: 0.45, upper_radius_m: 0.08,
//!         fore_length_m: 0.35, fore_radius_m: 0.06, wrist_radius_m: 0.06,
//!     },
//!     // At zero it stands upright, the forearm too.
//!     signs: JointSigns { sign: [1.0; 3], offset_rad: [0.0, 0.0, -FRAC_PI_2] },
//!     joints: [0, 1, 2],
//! });
//! let lens = Intrinsics::ideal(160, 120, 0.6);
//! let camera = Camera::looking_at(lens, Vec3::new(2.0, 0.0, 2.0), Vec3::new(2.0, 0.0, 0.0), Vec3::Y)?;
//! let seeing = Settings { learning_frames: 5, ..Settings::default() };
//! let mut watch = Watch::new(Arc::clone(&arm), 0.06, camera.into(), seeing, WatchSettings::default())?;
//! let limits = MotionLimits { velocity: vec![2.0; 3], acceleration: vec![10.0; 3], jerk: vec![100.0; 3] };
//! let mut q = vec![-1.0, 1.2, 0.3];
//! let mut guide = Guide::new(arm, watch.map().grid(), watch.reader(), None, GuideSettings::new(limits), &q)?;
//! guide.go_to(&[1.0, 1.2, 0.3])?;
//! let mut frame = Frame::new("camera", 160, 120, Channels::Grey, vec![90; 160 * 120])?;
//! for i in 0..6 {
//!     frame.stamp_s = f64::from(i) * 0.04;
//!     let sighting = watch.see_frame(&frame, &q)?; // five frames of the empty floor are learnt
//!     guide.look(&sighting);
//!     for tick in 1..=10 {
//!         let step = guide.tick(frame.stamp_s + 0.004 * f64::from(tick), 0.004);
//!         assert_eq!(step.doing == Doing::Going, i == 5);
//!         q = step.q;
//!     }
//! }
//! assert!(q[0] > -1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is conservative
//!
//! - The prism that vision tells contains what was seen in the frame, grown by
//!   [`Settings::uncertainty_m`](elbowroom_vision::Settings::uncertainty_m). It must hold what the thing goes from that frame
//!   until the next one has been worked up: its speed times (period + latency), beside the calibration's error.
//! - In the map it also covers where the thing will be until [`WatchSettings::ahead_s`] later if it goes on as it does: time
//!   for the arm to stop or to get out of the way.
//! - A path is free if all cells that it touches are; a new one is checked continuously in the exact scene with the prisms.
//! - Without a picture to be believed for [`GuideSettings::stale_s`], the arm slows to a stop, and says why.
//!
//! What moves into an arm that stands is not kept from doing so. This is not a certified safety device.

mod arm;
mod doing;
mod exact;
mod guide;
mod known;
mod log;
mod motion;
pub mod picture;
mod sentry;
mod settings;
mod sighting;
mod step;
mod switch;
mod times;
mod watcher;

pub use arm::WatchedArm;
pub use doing::{Doing, Reason};
pub use exact::Exact;
pub use guide::Guide;
pub(crate) use log::share_of;
pub use log::{FrameEntry, Picture, TickEntry, Truth, WatchLog};
pub use sentry::{Sentry, Shot};
pub use settings::{GuideError, GuideSettings};
pub use sighting::{Prism, Sighting};
pub use step::{Outlook, Step};
pub use times::{LookTimes, SeeTimes};
pub use watcher::{Watch, WatchError, WatchSettings};
