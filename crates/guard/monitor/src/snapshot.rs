//! Input of a tick.

use elbowroom_spatial::{FrameMotion, Pose};

/// The state of the robot and of its sources of motion at one instant.
///
/// Slices hold one value per independent joint in the chain's order (rad or m).
#[derive(Debug, Clone, Copy)]
pub struct Snapshot<'a> {
    /// Present time, s, by the monitor's clock, which the time stamps use too.
    pub now_s: f64,
    /// Time stamp of the joint values, s.
    pub stamp_s: f64,
    /// Joint positions.
    pub q: &'a [f64],
    /// Joint velocities; empty if they are not known. Then the stopping-distance law derives them from successive
    /// positions, and requests override 0 on the first; the other laws assume that the robot is at rest.
    pub qd: &'a [f64],
    /// Joint accelerations; empty if they are not known.
    pub qdd: &'a [f64],
    /// The override set by the program or the operator, 0..1: v₀ of the laws.
    pub programmed_override: f64,
    /// Joint velocities of the program at override 1. They give the direction of a stopped robot, so that
    /// [`Laws::direction_aware`](crate::Laws) can let it leave, and its stopping distance before it moves.
    pub intent: Option<&'a [f64]>,
    /// One state per source of the configuration.
    pub sources: &'a [SourceState],
}

impl<'a> Snapshot<'a> {
    /// A stationary robot at `q`: full override, no velocities, no sources.
    pub fn stationary(now_s: f64, q: &'a [f64]) -> Self {
        Self { now_s, stamp_s: now_s, q, qd: &[], qdd: &[], programmed_override: 1.0, intent: None, sources: &[] }
    }
}

/// Pose and motion of a source that regions follow: an encoder, a pose sensor or a frame of another robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceState {
    /// Pose of the source's frame in the world.
    pub pose: Pose,
    /// Velocity and acceleration of the source's frame in the world.
    pub motion: FrameMotion,
    /// Time stamp of pose and motion, s, by the monitor's clock.
    pub stamp_s: f64,
}
