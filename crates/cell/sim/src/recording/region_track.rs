//! One region in a run.

use elbowroom_monitor::{Guards, Life, RegionKind};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;
use serde::Serialize;

/// Recording of one region.
#[derive(Debug, Clone)]
pub struct RegionTrack {
    /// The region's name in the cell file.
    pub name: String,
    /// Its kind.
    pub kind: RecordedRegionKind,
    /// Whether it is permanent or temporary.
    pub life: Life,
    /// Which parts of the robots it guards.
    pub guards: Guards,
    /// The robots that it applies to.
    pub robots: Vec<RobotId>,
    /// Thickness of the warning zone, m.
    pub warning_m: f64,
    /// Its shape.
    pub shape: Shape,
    /// Its poses.
    pub poses: RegionPoses,
    /// Switching: time (s) and whether it was active from then on. The first entry is at the start.
    pub active: Vec<(f64, bool)>,
    /// Smallest distance (m) of any guarded volume while active.
    pub min_distance_m: Option<f64>,
    /// True if a guarded volume touched or entered it while active (for an exchange region: without holding it).
    pub entered: bool,
    /// Time (s) during which any robot was in its warning zone.
    pub warned_s: f64,
    /// Intervals in the warning zone.
    pub warning_spans: Vec<Span>,
    /// Intervals inside.
    pub inside_spans: Vec<Span>,
}

/// An interval of one robot in a region or its warning zone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// The robot; also an index in [`Recording::robots`](crate::Recording::robots).
    pub robot: RobotId,
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
}

/// Poses of a region's shape in the world.
#[derive(Debug, Clone)]
pub enum RegionPoses {
    /// Constant.
    Fixed(Pose),
    /// One pose per tick.
    Moving(Vec<Pose>),
}

/// Kind of a recorded region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RecordedRegionKind {
    /// Entry is a violation.
    Forbidden,
    /// Raises outputs; entry is permitted.
    Monitored,
    /// Entry without the grant is a violation.
    Exchange,
    /// The true pose of an obstacle, in recordings of perception.
    Obstacle,
}

impl RecordedRegionKind {
    /// `forbidden`, `monitored`, `exchange` or `obstacle`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forbidden => "forbidden",
            Self::Monitored => "monitored",
            Self::Exchange => "exchange",
            Self::Obstacle => "obstacle",
        }
    }
}

impl From<RegionKind> for RecordedRegionKind {
    fn from(kind: RegionKind) -> Self {
        match kind {
            RegionKind::Forbidden => Self::Forbidden,
            RegionKind::Monitored { .. } => Self::Monitored,
            RegionKind::Exchange { .. } => Self::Exchange,
        }
    }
}

impl RegionTrack {
    /// True if a robot entered it although it must not.
    pub fn is_violated(&self) -> bool {
        self.entered && matches!(self.kind, RecordedRegionKind::Forbidden | RecordedRegionKind::Exchange)
    }
}
