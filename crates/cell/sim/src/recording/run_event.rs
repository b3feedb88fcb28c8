//! Events of a run.

use elbowroom_avoidance::AvoiderState;
use elbowroom_monitor::EventKind;

use super::guidance_track::GuidanceState;

/// A line of `events.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRow {
    /// Seconds since the run began.
    pub t_s: f64,
    /// The robot concerned.
    pub robot: String,
    /// The region concerned, the fixture, the object gripped or released, or the perceived or evaded obstacle; empty
    /// otherwise.
    pub region: String,
    /// The event.
    pub event: RunEvent,
}

/// An event of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunEvent {
    /// An event of a robot's monitor.
    Monitor(EventKind),
    /// A program switched a region on, or an operator a fixture.
    On,
    /// A program switched a region off, or an operator a fixture.
    Off,
    /// The monitor stopped a robot.
    Stop,
    /// A stopped robot moves again.
    Resume,
    /// A robot gripped an object, which is named in place of the region.
    Grip,
    /// A robot released an object, which is named in place of the region.
    Release,
    /// A robot has a new path around obstacles that sensors see.
    Replan,
    /// A robot brakes or waits because an obstacle, which is named in place of the region, blocks its path.
    Wait,
    /// A robot brakes or waits because a sensor, which is named in place of the region, has sent nothing for too long.
    Stale,
    /// A robot made a tool active, which is named in place of the region.
    Tool,
    /// The avoidance of a robot changed to this state. An evaded obstacle is named in place of the region.
    Avoidance(AvoiderState),
    /// The tool of a guided robot changed to this state. In place of the region, the joint or the part that keeps the arm
    /// from following is named; or a fixture that was not switched, because the tool is too near.
    Guided(GuidanceState),
    /// A robot took over the work-piece of its virtual robot, which is named in place of the region.
    HandOver,
    /// A robot of a virtual robot keeps out of the way.
    Yield,
    /// The work-piece of a virtual robot, which is named in place of the region, stands although it should move.
    Hold,
    /// The robots begin to hide the work-piece of their virtual robot, which is named in place of the region, from its camera.
    Hidden,
}

impl RunEvent {
    /// Its name in `events.csv`: `warn_in`, `stop`, …
    pub fn name(self) -> &'static str {
        match self {
            Self::Monitor(kind) => kind.name(),
            Self::On => "on",
            Self::Off => "off",
            Self::Stop => "stop",
            Self::Resume => "resume",
            Self::Grip => "grip",
            Self::Release => "release",
            Self::Replan => "replan",
            Self::Stale => "stale",
            Self::Tool => "tool",
            Self::Avoidance(AvoiderState::Following) => "on_path",
            Self::Avoidance(AvoiderState::Evading) => "evade",
            Self::Avoidance(AvoiderState::Returning) => "return",
            Self::Avoidance(AvoiderState::Detouring) => "go_around",
            Self::Wait | Self::Avoidance(AvoiderState::Waiting) => "wait",
            Self::Avoidance(AvoiderState::Halted) => "halt",
            Self::Guided(state) => state.name(),
            Self::HandOver => "hand_over",
            Self::Yield => "yield",
            Self::Hold => GuidanceState::Held.name(),
            Self::Hidden => "hidden",
        }
    }
}
