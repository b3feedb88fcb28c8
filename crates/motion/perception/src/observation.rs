//! Evaluation of one frame, before it changes a map.

use std::time::Duration;

use elbowroom_vision::{CameraTracker, Frame, PixelMask};

use crate::error::PerceptionError;
use crate::obstacle_update::ObstacleUpdate;
use crate::times::PerceptionTimes;

/// Tracks the obstacles of a frame. The update contains its status and times, but no prisms yet.
pub(super) fn observe(
    tracker: &mut CameraTracker,
    frame: &Frame,
    mask: &PixelMask,
    mask_time: Duration,
) -> Result<ObstacleUpdate, PerceptionError> {
    let report = tracker.process(frame, Some(mask))?;
    let t = &report.timings;
    let tracks = t.label + t.project + t.track + t.prisms;
    let background = t.total().saturating_sub(tracks);
    Ok(ObstacleUpdate {
        stamp_s: report.stamp_s,
        status: report.status,
        prisms: Vec::new(),
        entered: Vec::new(),
        left: Vec::new(),
        blocked: 0,
        freed: 0,
        times: PerceptionTimes { mask: mask_time, background, tracks, ..PerceptionTimes::default() },
    })
}
