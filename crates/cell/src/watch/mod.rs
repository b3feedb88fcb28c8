//! A camera watches, the joint map follows, the arm goes around: frames in, motion out.
//!
//! [`Watch`] turns each frame into obstacles and these into blocked cells of the joint map; [`Guide`] moves the arm to a goal
//! on free cells, goes around what has come between while it moves, slows and stops where there is no way. Both may
//! live in one thread or in two: the guide looks at the map through a reader without locks, and a [`Sighting`] is all that
//! passes between them ([`Sentry`] is a watch on a thread of its own).
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
