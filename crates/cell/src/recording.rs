//! What a run leaves behind: read by the report and the CSV writers.

use elbowroom_avoidance::Doing;
use elbowroom_avoidance::fuzzy::Surface;
use elbowroom_monitor::{Guards, Reason};
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Pose, Vec3};

/// One run of a cell.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The cell's name.
    pub cell: String,
    /// Checksum of the configuration that ran (hex SHA-256).
    pub checksum: String,
    /// Period of the control tick, seconds.
    pub tick_s: f64,
    /// Simulated time from the first to the last tick, seconds.
    pub duration_s: f64,
    /// False where the monitor only watched.
    pub monitored: bool,
    /// One per robot, in the order of the cell file.
    pub robots: Vec<RobotTrack>,
    /// One per region, in the order of the cell file.
    pub regions: Vec<RegionTrack>,
    /// One per object that moves, in the order of the cell file.
    pub objects: Vec<ObjectTrack>,
    /// Robots that waited for each other when the run ended.
    pub deadlocks: Vec<Deadlock>,
    /// In order of time.
    pub events: Vec<EventRow>,
    /// How long the monitor's ticks took on this machine.
    pub tick_ns: TickTimes,
}

/// What one robot did.
#[derive(Debug, Clone)]
pub struct RobotTrack {
    /// The robot's name in the cell file.
    pub name: String,
    /// Names of the joints in the order of `q`.
    pub joints: Vec<String>,
    /// One per tick, first to last of the run.
    pub samples: Vec<Sample>,
    /// True where the program came to its end.
    pub finished: bool,
    /// Time (s) in which the robot stood still though its program wanted to move.
    pub stopped_s: f64,
    /// Smallest override commanded, 0..1.
    pub min_override: f64,
    /// First contact of each pair that touched.
    pub collisions: Vec<Collision>,
    /// How it evaded; `None` for a robot that does not.
    pub avoidance: Option<AvoidanceTrack>,
    /// How its run ended.
    pub ending: RobotEnding,
}

/// How a robot's run ended, and at what.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RobotEnding {
    /// In one word.
    pub outcome: Outcome,
    /// Since when (s) it stands where it ended; `None` for one that finished or was still under way.
    pub stopped_at_s: Option<f64>,
    /// The region that kept it, or what it first collided with: an object, or `robot/link`.
    pub by: Option<String>,
    /// The link, tool or load that came closest to the region, or collided first.
    pub part: Option<String>,
    /// The point of that part that was closest to the region, in the world, m.
    pub point: Option<Vec3>,
}

/// How a robot's run ended, in one word.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Outcome {
    /// Its program came to its end.
    #[default]
    Finished,
    /// It stands, or was still under way, before that.
    Stopped,
    /// It waits for an exchange region.
    Held,
    /// It touched something.
    Collided,
    /// It waits for robots that wait for it.
    Deadlock,
}

impl Outcome {
    /// The word in files.
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

/// Robots that wait for each other in a circle, for exchange regions.
#[derive(Debug, Clone, PartialEq)]
pub struct Deadlock {
    /// Since when all of them stand, s.
    pub t_s: f64,
    /// The robots, in the order of the cell file.
    pub robots: Vec<String>,
    /// The regions that they wait for.
    pub regions: Vec<String>,
}

/// What avoidance did to one robot.
#[derive(Debug, Clone, Default)]
pub struct AvoidanceTrack {
    /// One per tick, as the samples are.
    pub samples: Vec<AvoidanceSample>,
    /// Wall-clock time of its steps: sense, correct, check and command.
    pub step_ns: TickTimes,
    /// Ways that were planned where it did not get on, each with the time it took, s; `None` where none was found.
    pub plans: Vec<(f64, Option<f64>)>,
    /// Its rules: one surface per output.
    pub surfaces: Vec<Surface>,
}

/// Avoidance at one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoidanceSample {
    /// What the robot was doing.
    pub doing: Doing,
    /// Least distance to anything near, m; infinite where nothing is.
    pub nearest_m: f64,
    /// Size of the correction that the rules asked for, 0..1.
    pub size: f64,
    /// Off its path by so many seconds of joint motion at full speed.
    pub astray_s: f64,
    /// How fast the path was allowed to go on, 0..1.
    pub rate: f64,
}

/// The robot at one tick.
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
    /// The override commanded for this state, 0..1, the programmed override in it.
    pub speed_override: f64,
    /// Index of the governing region, where one governs.
    pub region: Option<usize>,
    /// Distance (m) from the governing point to its region.
    pub distance_m: Option<f64>,
    /// Why the override is what it is.
    pub reason: Reason,
}

/// Where one moving object was.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectTrack {
    /// The object's name in the cell file.
    pub name: String,
    /// Its frame in the world, one per tick.
    pub poses: Vec<Pose>,
}

/// A pair of solids that touched.
#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    /// When they first touched, s; also between ticks.
    pub t_s: f64,
    /// `robot/link`.
    pub a: String,
    /// `robot/link` or an object's name.
    pub b: String,
}

/// What happened at one region.
#[derive(Debug, Clone)]
pub struct RegionTrack {
    /// The region's name in the cell file.
    pub name: String,
    /// `forbidden`, `monitored` or `exchange`.
    pub kind: &'static str,
    /// `permanent` or `temporary`.
    pub life: &'static str,
    /// Whose distance counts.
    pub guards: Guards,
    /// Thickness of the warning zone, m.
    pub warning_m: f64,
    /// Its solid.
    pub shape: Shape,
    /// Where its shape stood.
    pub poses: RegionPoses,
    /// When it was switched: time (s) and whether it was active from then on. The first entry is at the start.
    pub active: Vec<(f64, bool)>,
    /// Smallest distance (m) of any guarded volume while active.
    pub min_distance_m: Option<f64>,
    /// True where a guarded volume touched or entered it while active (for an exchange region: without holding it).
    pub entered: bool,
    /// Time (s) during which any robot was in its warning zone.
    pub warned_s: f64,
    /// Who was in the warning zone when.
    pub warning_spans: Vec<Span>,
    /// Who was inside when.
    pub inside_spans: Vec<Span>,
}

/// A robot's stay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Index of the robot.
    pub robot: usize,
    /// Begin, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
}

/// Where a region's shape stood in the world.
#[derive(Debug, Clone)]
pub enum RegionPoses {
    /// Always there.
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
    /// The region concerned; empty where none is.
    pub region: String,
    /// What happened: `warn_in`, `stop`, …
    pub event: &'static str,
}

/// Wall-clock time of the monitor's ticks, nanoseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TickTimes {
    /// Median.
    pub p50: u64,
    /// 99th percentile.
    pub p99: u64,
    /// Largest.
    pub max: u64,
    /// How many ticks were timed.
    pub count: usize,
}
