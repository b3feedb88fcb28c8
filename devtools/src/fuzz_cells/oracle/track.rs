//! Poses of a body at all ticks, and its motion in between: its origin goes straight, and it turns about one axis.

use elbowroom_spatial::{Pose, Vec3};

use super::frame::Frame;

/// More than this per second² (m or rad) is an acceleration; below it is rounding.
const ACCELERATION: f64 = 1e-6;

/// A body that was seen at all ticks.
#[derive(Debug)]
pub struct Track {
    frames: Vec<Frame>,
    tick_s: f64,
}

impl Track {
    pub fn new(poses: &[Pose], tick_s: f64) -> Self {
        Self { frames: poses.iter().map(Frame::of).collect(), tick_s }
    }

    pub fn at(&self, t_s: f64) -> Frame {
        let last = self.frames.len().saturating_sub(1);
        let ticks = (t_s / self.tick_s).max(0.0);
        let k = (ticks.floor() as usize).min(last);
        let Some(next) = self.frames.get(k + 1) else { return self.frames[k] };
        self.frames[k].moved_towards(next, ticks - k as f64)
    }

    /// No point within `radius_m` of its origin goes farther (m) from one time to another within a tick.
    pub fn travel_m(&self, from_s: f64, to_s: f64, radius_m: f64) -> f64 {
        let (from, to) = (self.at(from_s), self.at(to_s));
        let turn = from.turn_to(&to).length();
        // What does not turn may be without end.
        from.at.distance(to.at) + if turn > 0.0 { turn * radius_m } else { 0.0 }
    }
}

/// Whether a body at these ticks turns at a constant rate, and keeps its velocity or turns it as it turns itself: what
/// can be foreseen.
pub fn is_steady(frames: &[Frame], tick_s: f64) -> bool {
    let small = |change: Vec3| change.length() <= ACCELERATION * tick_s * tick_s;
    frames.windows(3).all(|f| {
        let (before, after) = (f[0].turn_to(&f[1]), f[1].turn_to(&f[2]));
        let (step, next) = (f[1].at - f[0].at, f[2].at - f[1].at);
        let turned = before.try_normalize().map_or(step, |axis| Frame::turn(axis, before.length()).vector(step));
        small(after - before) && (small(next - step) || small(next - turned))
    })
}
