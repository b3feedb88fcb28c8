//! Recording of a run, for the report and the CSV writers.

mod avoidance_track;
mod guidance_track;
mod perception_track;
mod region_track;
mod robot_ending;
mod run_event;
mod tick_times;
mod virtual_robot_track;

use elbowroom_cell::{CellGrid, CellRegionId};
use elbowroom_kinematics::LinkId;
use elbowroom_monitor::OverrideReason;
use elbowroom_spatial::{Pose, Vec3};
use serde::Serialize;

pub use avoidance_track::{AvoidanceSample, AvoidanceTrack, Evasion, ReplanRecord};
pub use guidance_track::{ForceSample, GuidanceSample, GuidanceState, GuidanceTrack};
pub use perception_track::{HeldPeriod, HoldReason, PathReplan, PerceptionTrack, SensorTrack};
pub use region_track::{RecordedRegionKind, RegionPoses, RegionTrack, Span};
pub use robot_ending::{Deadlock, Outcome, PartKind, RobotEnding, Stop};
pub use run_event::{EventRow, RunEvent};
pub use tick_times::TickTimes;
pub use virtual_robot_track::{HandOverRecord, ViewTrack, VirtualRobotSample, VirtualRobotTrack, WorkPieceStop};

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
    /// Reason for its end.
    pub end: RunEnd,
    /// Whether the override of the monitor was applied.
    pub monitored: bool,
    /// One per robot, in the order of the cell file.
    pub robots: Vec<RobotTrack>,
    /// One per region, in the order of the cell file.
    pub regions: Vec<RegionTrack>,
    /// The grids of all robots, in file order.
    pub grids: Vec<CellGrid>,
    /// One per object that moves or is gripped: the moving ones in the order of the cell file, then the others.
    pub objects: Vec<ObjectTrack>,
    /// One per sensor with loaded pictures or clouds.
    pub sensors: Vec<SensorTrack>,
    /// One per virtual robot, in the order of the cell file.
    pub virtual_robots: Vec<VirtualRobotTrack>,
    /// Deadlocks at the end of the run.
    pub deadlocks: Vec<Deadlock>,
    /// In order of time.
    pub events: Vec<EventRow>,
    /// Wall-clock time of the monitor's ticks.
    pub tick_ns: TickTimes,
}

/// Reason for the end of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunEnd {
    /// All programs were completed.
    #[default]
    Finished,
    /// All motion had ended.
    Rest,
    /// The robots were stopped at override 0 for ten seconds while only endless belts moved.
    Standstill,
    /// The time limit of the cell was reached.
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
    /// Links of tools that are not mounted. Each list applies from its time (s) on; empty for a robot without such
    /// tools.
    pub absent_links: Vec<(f64, Vec<LinkId>)>,
    /// One per tick, first to last of the run.
    pub samples: Vec<Sample>,
    /// Stops by the monitor before the program was complete, in order of time.
    pub stops: Vec<Stop>,
    /// True if the program was completed.
    pub finished: bool,
    /// Time (s) for which the robot was stopped before its program was complete.
    pub stopped_s: f64,
    /// Smallest override commanded, 0..1.
    pub min_override: f64,
    /// First contact of each pair that touched.
    pub collisions: Vec<Collision>,
    /// Evasion; `None` for a robot without avoidance.
    pub avoidance: Option<AvoidanceTrack>,
    /// Guidance by a person; `None` for a robot without operator.
    pub guidance: Option<GuidanceTrack>,
    /// Reactions to the obstacles that sensors see; `None` for a robot that no sensor guards.
    pub perception: Option<PerceptionTrack>,
    /// How its run ended.
    pub ending: RobotEnding,
}

/// State of a robot at one tick.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Seconds since the run began.
    pub t_s: f64,
    /// Joint positions, rad or m.
    pub q: Vec<f64>,
    /// Joint velocities, rad/s or m/s, as its monitor was told without faults.
    pub qd: Vec<f64>,
    /// Joint velocities that the program wants at override 1, rad/s or m/s.
    pub intent: Vec<f64>,
    /// Tool centre point in the world, m.
    pub tcp: Vec3,
    /// Speed of the TCP, m/s.
    pub tcp_speed: f64,
    /// Speed the TCP would have at override 1, m/s.
    pub programmed_speed: f64,
    /// The override of this tick, 0..1, the programmed override included.
    pub speed_override: f64,
    /// The governing region, if any; also an index in [`Recording::regions`].
    pub region: Option<CellRegionId>,
    /// Distance (m) from the governing point to its region.
    pub distance_m: Option<f64>,
    /// The point of the robot closest to the governing region.
    pub governing: Option<GoverningPoint>,
    /// Why the override has this value; its region is an index in [`Recording::regions`].
    pub reason: OverrideReason,
    /// Digital outputs, bit i is channel i.
    pub outputs: u64,
}

/// The point of a robot that is closest to the governing region.
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

impl RobotTrack {
    /// True for a mechanism, which no monitor guards; known at the end of the run.
    pub fn is_mechanism(&self) -> bool {
        self.ending.outcome == Outcome::Mechanism
    }

    /// The part in the governing point of a sample: a link, `tool`, `load` or `tcp`.
    pub fn governing_part(&self, sample: &Sample) -> Option<&str> {
        self.parts.get(sample.governing?.part).map(String::as_str)
    }

    /// The obstacle that the robot evades or waits for at the tick with this index.
    pub fn governing_obstacle(&self, tick: usize) -> Option<&str> {
        let track = self.avoidance.as_ref()?;
        track.obstacles.get(track.samples.get(tick)?.governed_by?).map(String::as_str)
    }
}
