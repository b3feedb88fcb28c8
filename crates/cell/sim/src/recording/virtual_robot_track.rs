//! Recording of robots that act as one.

use elbowroom_spatial::Pose;
use serde::Serialize;

/// The motion of the work-piece of a virtual robot.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualRobotTrack {
    /// Name of the virtual robot.
    pub name: String,
    /// Names of its robots.
    pub robots: Vec<String>,
    /// One per tick.
    pub samples: Vec<VirtualRobotSample>,
    /// Hand-overs, in order of time.
    pub hand_overs: Vec<HandOverRecord>,
    /// Periods in which the work-piece stood although it should have moved, in order of time.
    pub stops: Vec<WorkPieceStop>,
    /// Share of the desired motion that was carried out, 0 to 1.
    pub carried_share: f64,
    /// Least [`VirtualRobotSample::singular_value`] with which a robot plans to hold the work-piece.
    pub least_singular_value: f64,
    /// The camera that looks at the work-piece, if there is one.
    pub view: Option<ViewTrack>,
}

/// What a camera saw of a work-piece.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewTrack {
    /// Name of the camera.
    pub camera: String,
    /// Share of the surface in view from which on the work-piece counts as hidden.
    pub allowed_share: f64,
}

/// A tick of a virtual robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualRobotSample {
    /// Seconds since the run began, at the start of the tick.
    pub t_s: f64,
    /// The robot that holds the work-piece, an index in [`VirtualRobotTrack::robots`].
    pub holder: usize,
    /// The work-piece in the world at the end of the tick.
    pub part_in_world: Pose,
    /// The pose of the desired path that it should have there.
    pub on_path: Pose,
    /// Share of the desired speed.
    pub rate: f64,
    /// Whether it stands although it should move.
    pub is_stopped: bool,
    /// Least distance between two of the robots, with the work-piece, m; infinite beyond 0.1 m; what may touch does not
    /// count.
    pub gap_m: f64,
    /// Least singular value of the Jacobian of the robot that holds the work-piece, metres divided by the distance of its tool
    /// from its base: 0 in a singularity. Infinite with fewer than six joints.
    pub singular_value: f64,
    /// Share of the surface in view of the camera that the robots hide, 0 to 1; `None` without a camera, or if nothing is in
    /// view.
    pub hidden_share: Option<f64>,
}

/// A hand-over.
#[derive(Debug, Clone, PartialEq)]
pub struct HandOverRecord {
    /// Time at which the receiver took the work-piece, s.
    pub t_s: f64,
    /// The giver, an index in [`VirtualRobotTrack::robots`].
    pub from: usize,
    /// The receiver.
    pub to: usize,
    /// Why it was decided, in words.
    pub reason: String,
}

/// A period in which the work-piece of a virtual robot stood although it should have moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorkPieceStop {
    /// Start, s.
    pub from_s: f64,
    /// Time at which it moved on, or the end of the run, s.
    pub to_s: f64,
    /// Why it stood, in words: the first reason.
    pub reason: String,
}
