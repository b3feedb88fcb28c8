//! Recording of a run, for the report and the CSV writers.

use elbowroom_analysis::watch::WatchRecord;
use elbowroom_avoidance::fuzzy::Surface;
use elbowroom_avoidance::{AvoiderState, EscapeState};
use elbowroom_cell::CellRegionId;
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::{EventKind, Guards, Life, OverrideReason, Part, RegionKind};
use elbowroom_proximity::Shape;
use elbowroom_robot::RobotId;
use elbowroom_spatial::{Pose, Vec3};
use serde::Serialize;

/// One run of a cell.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The cell's name.
    pub cell: String,
    /// Checksum of the configuration (hex SHA-256).
    pub checksum: String,
    /// Period of the control tick, seconds.
    pub tick_s: f64,
    /// Simulated time from the first to the last tick, seconds.
    pub duration_s: f64,
    /// Why it ended.
    pub end: RunEnd,
    /// False if the override of the monitor was not applied.
    pub monitored: bool,
    /// One per robot, in the order of the cell file.
    pub robots: Vec<RobotTrack>,
    /// One per region, in the order of the cell file.
    pub regions: Vec<RegionTrack>,
    /// One per object that moves or is gripped: the moving ones in the order of the cell file, then the others.
    pub objects: Vec<ObjectTrack>,
    /// One per sensor whose pictures or clouds were taken in.
    pub sensors: Vec<SensorTrack>,
    /// Deadlocks at the end of the run.
    pub deadlocks: Vec<Deadlock>,
    /// In order of time.
    pub events: Vec<EventRow>,
    /// Wall-clock time of the monitor's ticks.
    pub tick_ns: TickTimes,
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunEnd {
    /// All programs were completed.
    #[default]
    Finished,
    /// Nothing moved any more.
    Rest,
    /// The robots stood at override 0 for ten seconds while only endless belts moved.
    Standstill,
    /// The time limit of the cell.
    TimeLimit,
}

/// Recording of one robot.
#[derive(Debug, Clone)]
pub struct RobotTrack {
    /// The robot's name in the cell file.
    pub name: String,
    /// The link that carries the tool centre point.
    pub flange: String,
    /// Names of the joints in the order of `q`.
    pub joints: Vec<String>,
    /// Names of the guarded volumes: links, `tool`, `load`, `tcp`. [`GoverningPoint::part`] is an index in this list.
    pub parts: Vec<String>,
    /// The links of tools that are not mounted, each list from its time (s) on; empty for a robot without such tools.
    pub absent_links: Vec<(f64, Vec<LinkId>)>,
    /// One per tick, first to last of the run.
    pub samples: Vec<Sample>,
    /// When the monitor stopped it although its program was not complete, in order of time.
    pub stops: Vec<Stop>,
    /// True if the program was completed.
    pub finished: bool,
    /// Time (s) in which the robot was stopped although its program was not.
    pub stopped_s: f64,
    /// Smallest override commanded, 0..1.
    pub min_override: f64,
    /// First contact of each pair that touched.
    pub collisions: Vec<Collision>,
    /// Evasion; `None` for a robot without avoidance.
    pub avoidance: Option<AvoidanceTrack>,
    /// What it did about the obstacles that sensors see; `None` for a robot that no sensor guards.
    pub perception: Option<PerceptionTrack>,
    /// How its run ended.
    pub ending: RobotEnding,
}

/// What one robot did about the obstacles that sensors see.
#[derive(Debug, Clone, Default)]
pub struct PerceptionTrack {
    /// Searches for a new path, in order of time.
    pub replans: Vec<PathReplan>,
    /// Times in which it was held, in order.
    pub holds: Vec<Hold>,
    /// It was held at the end of the run: why, and by what.
    pub ends_held: Option<(HoldReason, String)>,
}

/// A search for a new path of a planned move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathReplan {
    /// Simulated time, s.
    pub t_s: f64,
    /// Wall-clock time of the search, s.
    pub search_s: f64,
    /// Whether the robot entered the new path in motion; `None` where none was found.
    pub in_motion: Option<bool>,
}

/// A time in which a robot is held: it brakes or stands.
#[derive(Debug, Clone, PartialEq)]
pub struct Hold {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Why.
    pub reason: HoldReason,
    /// The obstacle (`sensor#number`) or the sensor.
    pub by: String,
}

/// Why a robot is held because of what sensors see.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum HoldReason {
    /// An obstacle blocks its path.
    Obstacle,
    /// A sensor has sent nothing that can be used for too long, or nothing yet.
    Stale,
}

/// What one sensor sent and saw.
#[derive(Debug, Clone)]
pub struct SensorTrack {
    /// Its name.
    pub name: String,
    /// `camera` or `cloud`.
    pub kind: &'static str,
    /// Time from a picture or cloud to its use, s.
    pub latency_s: f64,
    /// One per picture or cloud that was taken in.
    pub records: Vec<WatchRecord>,
    /// Wall-clock time from the picture in the file to the reaction of the robots.
    pub processing_ns: TickTimes,
}

/// A time during which the monitor stopped a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Start, s.
    pub from_s: f64,
    /// When it moved on, or the end of the run, s.
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
    /// Since when (s) it is stopped at its final configuration; `None` for one that finished or was still moving.
    pub stopped_at_s: Option<f64>,
    /// The region or obstacle that stopped it, or what it collided with first: an object, or `robot/link`.
    pub by: Option<String>,
    /// The link, tool or load that was closest to the region, or collided first.
    pub part: Option<String>,
    /// What that part is.
    pub part_kind: Option<PartKind>,
    /// The point of that part closest to the region, in the world, m.
    pub point: Option<Vec3>,
    /// What would let a stopped robot continue, in words; `None` where nothing is known to.
    pub release: Option<String>,
}

/// What a part of a robot is.
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
        }
    }
}

/// Robots that wait for each other, for exchange regions.
#[derive(Debug, Clone, PartialEq)]
pub struct Deadlock {
    /// Since when all of them are stopped, s.
    pub t_s: f64,
    /// The robots, in the order of the cell file.
    pub robots: Vec<String>,
    /// The regions they wait for.
    pub regions: Vec<String>,
}

/// Evasion of one robot.
#[derive(Debug, Clone, Default)]
pub struct AvoidanceTrack {
    /// One per tick, as the samples are.
    pub samples: Vec<AvoidanceSample>,
    /// Names of what may be in the way: objects, then `robot/link`.
    pub obstacles: Vec<String>,
    /// Wall-clock time of its steps: sensing, correction, check, command.
    pub step_ns: TickTimes,
    /// Replanning attempts, in order of time.
    pub plans: Vec<ReplanRecord>,
    /// Its rules: one control surface per output.
    pub surfaces: Vec<Surface>,
}

/// One replanning attempt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplanRecord {
    /// Simulated time of the attempt, s.
    pub t_s: f64,
    /// Wall-clock time of the search, s; `None` where no path was found.
    pub search_s: Option<f64>,
}

/// Evasion at one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoidanceSample {
    /// State of the avoider.
    pub state: AvoiderState,
    /// Smallest separation distance to any obstacle, m; infinite where none is near.
    pub nearest_m: f64,
    /// Size of the correction, 0..1.
    pub size: f64,
    /// Path deviation: seconds of joint motion at full speed back to the path.
    pub path_deviation_s: f64,
    /// How fast the path may advance, 0..1.
    pub rate: f64,
    /// The dynamic obstacle that requested the largest correction, an index in [`AvoidanceTrack::obstacles`].
    pub governed_by: Option<usize>,
    /// What the search for escapes did.
    pub escape: EscapeState,
}

/// State of a robot at one tick.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Seconds since the run began.
    pub t_s: f64,
    /// Joint positions, rad or m.
    pub q: Vec<f64>,
    /// Tool centre point in the world, m.
    pub tcp: Vec3,
    /// Speed of the TCP, m/s.
    pub tcp_speed: f64,
    /// Speed the TCP would have at override 1, m/s.
    pub programmed_speed: f64,
    /// The override of this tick, 0..1, the programmed override included.
    pub speed_override: f64,
    /// The governing region, where there is one; an index in [`Recording::regions`] too.
    pub region: Option<CellRegionId>,
    /// Distance (m) from the governing point to its region.
    pub distance_m: Option<f64>,
    /// The point of the robot closest to the governing region.
    pub governing: Option<GoverningPoint>,
    /// Why the override has this value; its region is an index in [`Recording::regions`].
    pub reason: OverrideReason,
}

/// The point of a robot that is closest to the region which governs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoverningPoint {
    /// The guarded volume, an index in [`RobotTrack::parts`].
    pub part: usize,
    /// In the world, m.
    pub point: Vec3,
}

/// Poses of one object that moves or is gripped.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectTrack {
    /// The object's name in the cell file.
    pub name: String,
    /// Its frame in the world, one per tick.
    pub poses: Vec<Pose>,
}

/// First contact of two colliders.
#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    /// Time of the first contact, s; may lie between ticks.
    pub t_s: f64,
    /// `robot/link`.
    pub a: String,
    /// `robot/link` or an object's name.
    pub b: String,
}

/// Recording of one region.
#[derive(Debug, Clone)]
pub struct RegionTrack {
    /// The region's name in the cell file.
    pub name: String,
    /// Its kind.
    pub kind: RecordedRegionKind,
    /// Its life.
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
    /// The robot; an index in [`Recording::robots`] too.
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

/// A line of `events.csv`.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRow {
    /// Seconds since the run began.
    pub t_s: f64,
    /// The robot concerned.
    pub robot: String,
    /// The region concerned, the object gripped or released, or the perceived obstacle; empty if none is.
    pub region: String,
    /// The event.
    pub event: RunEvent,
}

/// An event of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunEvent {
    /// An event of a robot's monitor.
    Monitor(EventKind),
    /// A program switched a region on.
    On,
    /// A program switched a region off.
    Off,
    /// The monitor stopped a robot.
    Stop,
    /// A stopped robot moves again.
    Resume,
    /// A robot gripped an object, which is named in place of the region.
    Grip,
    /// A robot released an object, which is named in place of the region.
    Release,
    /// A robot has another path, around what sensors see.
    Replan,
    /// A robot brakes or stands: an obstacle that a sensor sees, which is named in place of the region, blocks its path.
    Wait,
    /// A robot brakes or stands: a sensor, which is named in place of the region, has sent nothing for too long.
    Stale,
    /// A robot made a tool active, which is named in place of the region.
    Tool,
    /// The avoidance of a robot changed to this state.
    Avoidance(AvoiderState),
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
        }
    }
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

impl RobotTrack {
    /// The part that governs in a sample: a link, `tool`, `load` or `tcp`.
    pub fn governing_part(&self, sample: &Sample) -> Option<&str> {
        self.parts.get(sample.governing?.part).map(String::as_str)
    }

    /// The obstacle that the robot evades, or stands before, at the tick with this index.
    pub fn governing_obstacle(&self, tick: usize) -> Option<&str> {
        let track = self.avoidance.as_ref()?;
        track.obstacles.get(track.samples.get(tick)?.governed_by?).map(String::as_str)
    }
}

impl RegionTrack {
    /// True if a robot entered it and must not.
    pub fn is_violated(&self) -> bool {
        self.entered && matches!(self.kind, RecordedRegionKind::Forbidden | RecordedRegionKind::Exchange)
    }
}

/// Statistics of wall-clock times, nanoseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TickTimes {
    /// Median.
    pub p50: u64,
    /// 99th percentile.
    pub p99: u64,
    /// Largest.
    pub max: u64,
    /// Number of samples.
    pub count: usize,
}

impl TickTimes {
    /// Of the times of all ticks, nanoseconds.
    pub fn of(mut ns: Vec<u64>) -> Self {
        ns.sort_unstable();
        let at = |share: f64| {
            ns.get(((ns.len() as f64 * share) as usize).min(ns.len().saturating_sub(1))).copied().unwrap_or(0)
        };
        Self { p50: at(0.5), p99: at(0.99), max: ns.last().copied().unwrap_or(0), count: ns.len() }
    }
}
