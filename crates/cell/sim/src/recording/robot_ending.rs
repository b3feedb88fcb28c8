//! Stops of a robot, and how its run ended.

use elbowroom_monitor::Part;
use elbowroom_spatial::Vec3;
use serde::Serialize;

/// A period in which the monitor stopped a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Start, s.
    pub from_s: f64,
    /// Time at which it moved on, or the end of the run, s.
    pub to_s: f64,
    /// The region that governed at the start; `None` for a stop by invalid input.
    pub by: Option<String>,
    /// The link, tool or load that was closest to that region.
    pub part: Option<String>,
    /// The point of that part closest to the region, in the world, m.
    pub point: Option<Vec3>,
    /// Its distance to the region, m.
    pub distance_m: Option<f64>,
}

/// How a robot's run ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RobotEnding {
    /// The outcome.
    pub outcome: Outcome,
    /// Time (s) at which it stopped at its final configuration; `None` for a robot that finished or was still moving.
    pub stopped_at_s: Option<f64>,
    /// The region or obstacle that stopped it, or what it collided with first: an object, or `robot/link`.
    pub by: Option<String>,
    /// The link, tool or load that was closest to the region, or collided first.
    pub part: Option<String>,
    /// Kind of that part.
    pub part_kind: Option<PartKind>,
    /// The point of that part closest to the region, in the world, m.
    pub point: Option<Vec3>,
    /// Condition under which a stopped robot would continue, in words; `None` if none is known.
    pub release: Option<String>,
}

/// Kind of a part of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PartKind {
    /// The tool centre point.
    Tcp,
    /// The tool.
    Tool,
    /// The load, or an object that it has gripped.
    Load,
    /// A link.
    Link,
}

impl From<Part> for PartKind {
    fn from(part: Part) -> Self {
        match part {
            Part::Tcp | Part::TcpOutside => Self::Tcp,
            Part::Tool => Self::Tool,
            Part::Load => Self::Load,
            Part::Arm => Self::Link,
        }
    }
}

/// Outcome of a robot's run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Its program was completed.
    #[default]
    Finished,
    /// It was stopped, or still moving at the end of the run.
    Stopped,
    /// It waits for an exchange region.
    Held,
    /// It collided.
    Collided,
    /// It waits for robots that wait for it.
    Deadlock,
    /// It is a mechanism, which moves by itself: `stopped_at_s` is the end of its motion, 0 if it did not move.
    Mechanism,
}

impl Outcome {
    /// The word in JSON and CSV.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::Held => "held",
            Self::Collided => "collided",
            Self::Deadlock => "deadlock",
            Self::Mechanism => "mechanism",
        }
    }
}

/// A cycle of robots that wait for each other, for exchange regions.
#[derive(Debug, Clone, PartialEq)]
pub struct Deadlock {
    /// Time since which all of them are stopped, s.
    pub t_s: f64,
    /// The robots, in the order of the cell file.
    pub robots: Vec<String>,
    /// The regions they wait for.
    pub regions: Vec<String>,
}
