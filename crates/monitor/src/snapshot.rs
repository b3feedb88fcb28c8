//! What a tick is given.

use elbowroom_spatial::{Motion, Pose};

/// The state of the robot and of what moves around it, at one instant.
///
/// Slices hold one value per independent joint in the chain's order (rad or m).
#[derive(Debug, Clone, Copy)]
pub struct Snapshot<'a> {
    /// The monitor's clock now, s. Same clock as the stamps.
    pub now_s: f64,
    /// When the joint values were taken, s.
    pub stamp_s: f64,
    /// Joint positions.
    pub q: &'a [f64],
    /// Joint velocities. Empty where they are not known: the stopping-distance law then derives them from one position to the
    /// next, and asks for override 0 on the first; the other laws take the robot to stand.
    pub qd: &'a [f64],
    /// Joint accelerations; empty for none known.
    pub qdd: &'a [f64],
    /// The override that the program or the operator asks for, 0..1: v₀ of the laws.
    pub programmed_override: f64,
    /// Joint velocities that the program asks for at override 1. With it a stopped robot's direction is known, so that
    /// [`Laws::direction_aware`](crate::Laws) can let it leave; and the stopping distance is known before it moves.
    pub intent: Option<&'a [f64]>,
    /// One per source of the configuration.
    pub sources: &'a [Source],
}

impl<'a> Snapshot<'a> {
    /// A robot at `q` of which no more is known, full override, no sources.
    pub fn still(now_s: f64, q: &'a [f64]) -> Self {
        Self { now_s, stamp_s: now_s, q, qd: &[], qdd: &[], programmed_override: 1.0, intent: None, sources: &[] }
    }
}

/// Pose and motion of something that carries regions: encoder, pose sensor, frame of another robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Its frame in the world.
    pub pose: Pose,
    /// Velocity and acceleration of that frame in the world.
    pub motion: Motion,
    /// When they were taken, s.
    pub stamp_s: f64,
}
