//! Summary of a run as one JSON document: the output of `elbowroom run --json`.

use elbowroom_avoidance::AvoiderState;
use elbowroom_query::watch::WatchStatus;
use serde::Serialize;

use crate::operator_summary::OperatorSummary;
use crate::recording::{
    AvoidanceSample, AvoidanceTrack, Evasion, HeldPeriod, HoldReason, ObjectTrack, Outcome, PartKind, PerceptionTrack,
    RecordedRegionKind, Recording, RobotEnding, RunEnd, SensorTrack, Stop, TickTimes,
};
use crate::virtual_robot_summary::VirtualRobotSummary;

/// Figures of a run, in SI units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Name of the cell.
    pub cell: String,
    /// Checksum of its configuration.
    pub checksum: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// `finished`, `rest` (all motion had ended), `standstill` (only endless belts moved) or `time_limit`.
    pub end: RunEnd,
    /// Number of ticks.
    pub ticks: usize,
    /// Wall-clock time of the monitor's ticks, ns.
    pub tick_ns: TickNs,
    /// Per robot.
    pub robots: Vec<RobotSummary>,
    /// Per region.
    pub regions: Vec<RegionSummary>,
    /// Deadlocks at the end of the run.
    pub deadlocks: Vec<DeadlockSummary>,
    /// Per operator; omitted if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub operators: Vec<OperatorSummary>,
    /// Per virtual robot; omitted if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub virtual_robots: Vec<VirtualRobotSummary>,
    /// Per camera with loaded pictures; omitted if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cameras: Vec<SensorSummary>,
    /// Per source of point clouds with loaded clouds; omitted if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clouds: Vec<SensorSummary>,
    /// Final poses of the objects that move or are gripped; omitted if empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub objects: Vec<ObjectSummary>,
}

/// An object at the end of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ObjectSummary {
    /// Its name.
    pub name: String,
    /// Origin of its frame in the world, m.
    pub at_m: [f64; 3],
    /// Roll, pitch and yaw of its frame in the world, rad.
    pub rpy_rad: [f64; 3],
}

impl ObjectSummary {
    fn of(track: &ObjectTrack) -> Option<Self> {
        let pose = track.poses.last()?;
        let (at_m, rpy_rad) = (pose.translation.to_array(), pose.rotation.to_rpy());
        Some(Self { name: track.name.clone(), at_m, rpy_rad })
    }
}

/// Wall-clock time of ticks, ns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TickNs {
    /// Median.
    pub p50: u64,
    /// 99th percentile.
    pub p99: u64,
    /// Largest.
    pub max: u64,
}

impl From<TickTimes> for TickNs {
    fn from(t: TickTimes) -> Self {
        Self { p50: t.p50, p99: t.p99, max: t.max }
    }
}

/// Result of one robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Its name.
    pub name: String,
    /// The link that carries the tool centre point; empty for a mechanism.
    pub flange: String,
    /// True if its program was completed.
    pub finished: bool,
    /// How its run ended.
    #[serde(flatten)]
    pub ending: EndingSummary,
    /// Time stopped by the monitor, s.
    pub stopped_s: f64,
    /// Stops by the monitor, in order of time.
    pub stops: Vec<StopSummary>,
    /// Smallest override, 0..1.
    pub min_override: f64,
    /// First contact of each pair.
    pub collisions: Vec<CollisionSummary>,
    /// Evasion; omitted for a robot without avoidance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub avoidance: Option<AvoidanceSummary>,
    /// Reactions to the obstacles that sensors see; omitted for a robot that no sensor guards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub perception: Option<PerceptionSummary>,
}

/// End of the run of one robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EndingSummary {
    /// `finished`, `stopped`, `held` (waiting for an exchange region), `collided`, `deadlock`, or `mechanism`.
    pub outcome: Outcome,
    /// Time at which it stopped at its final configuration, s; null if it finished or was still moving. For a mechanism the
    /// end of its motion, 0 if it did not move.
    pub stopped_at_s: Option<f64>,
    /// The region or obstacle that stopped it, or what it collided with first; null if unknown.
    pub by: Option<String>,
    /// The link, tool or load that was closest to the region, or collided first.
    pub part: Option<String>,
    /// Kind of that part: `tcp`, `tool`, `load` or `link`.
    pub part_kind: Option<PartKind>,
    /// The point of that part closest to the region, in the world, m.
    pub point_m: Option<[f64; 3]>,
    /// Condition under which it would continue, in words; null if none is known.
    pub release: Option<String>,
}

impl From<&RobotEnding> for EndingSummary {
    fn from(ending: &RobotEnding) -> Self {
        Self {
            outcome: ending.outcome,
            stopped_at_s: ending.stopped_at_s,
            by: ending.by.clone(),
            part: ending.part.clone(),
            part_kind: ending.part_kind,
            point_m: ending.point.map(|p| [p.x, p.y, p.z]),
            release: ending.release.clone(),
        }
    }
}

/// Reactions of one robot to the obstacles that sensors see.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PerceptionSummary {
    /// New paths that it entered in motion.
    pub replans_in_motion: usize,
    /// New paths from rest.
    pub replans_from_rest: usize,
    /// Searches that found no path.
    pub replans_failed: usize,
    /// Wall-clock time of the longest search, s; 0 without searches.
    pub longest_search_s: f64,
    /// Time during which it braked or waited because of an obstacle, s.
    pub waited_s: f64,
    /// Time during which it braked or waited because a sensor had sent nothing for too long, s.
    pub stale_s: f64,
    /// Periods in which it was held.
    pub holds: Vec<HoldSummary>,
}

/// A period in which a robot was held.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HoldSummary {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// `obstacle` or `stale`.
    pub reason: HoldReason,
    /// The obstacle (`sensor#number`) or the sensor.
    pub by: String,
}

impl From<&PerceptionTrack> for PerceptionSummary {
    fn from(track: &PerceptionTrack) -> Self {
        let count = |in_motion| track.replans.iter().filter(|r| r.in_motion == in_motion).count();
        let time =
            |reason| track.holds.iter().filter(|h| h.reason == reason).fold(0.0, |sum, h| sum + h.to_s - h.from_s);
        let hold = |h: &HeldPeriod| HoldSummary { from_s: h.from_s, to_s: h.to_s, reason: h.reason, by: h.by.clone() };
        Self {
            replans_in_motion: count(Some(true)),
            replans_from_rest: count(Some(false)),
            replans_failed: count(None),
            longest_search_s: track.replans.iter().map(|r| r.search_s).fold(0.0, f64::max),
            waited_s: time(HoldReason::Obstacle),
            stale_s: time(HoldReason::Stale),
            holds: track.holds.iter().map(hold).collect(),
        }
    }
}

/// Input and observations of one sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorSummary {
    /// Its name.
    pub name: String,
    /// Number of loaded pictures or clouds.
    pub frames: usize,
    /// Number of these that were learnt as the empty cell.
    pub learned: usize,
    /// Number of these that were evaluated.
    pub accepted: usize,
    /// Number of these that were not usable.
    pub rejected: usize,
    /// All obstacles seen, in the order in which they entered.
    pub obstacles: Vec<SeenObstacle>,
    /// Largest number of cells of the joint-space map that obstacles blocked at once.
    pub most_blocked: u64,
    /// Wall-clock time from the picture in its file to the reaction of the robots, new paths included, ns.
    pub processing_ns: TickNs,
}

/// An obstacle that a sensor saw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeenObstacle {
    /// Its identity.
    pub id: u64,
    /// The template that it matched last; null if it matched none.
    pub kind: Option<String>,
    /// Time of its first observation, s.
    pub first_s: f64,
    /// Time of its last observation, s.
    pub last_s: f64,
    /// Its estimated centre at that time, world x and y, m.
    pub centre_m: [f64; 2],
    /// Its height at that time, m.
    pub height_m: f64,
}

impl From<&SensorTrack> for SensorSummary {
    fn from(track: &SensorTrack) -> Self {
        let count = |status| track.records.iter().filter(|r| r.status == status).count();
        let mut obstacles: Vec<SeenObstacle> = Vec::new();
        for record in track.records.iter().filter(|r| r.status == WatchStatus::Accepted) {
            for o in &record.obstacles {
                let first_s = obstacles.iter().find(|known| known.id == o.id).map_or(record.t_s, |known| known.first_s);
                obstacles.retain(|known| known.id != o.id);
                obstacles.push(SeenObstacle {
                    id: o.id,
                    kind: o.kind.clone(),
                    first_s,
                    last_s: record.t_s,
                    centre_m: o.centre_m,
                    height_m: o.height_m,
                });
            }
        }
        obstacles.sort_by_key(|o| o.id);
        Self {
            name: track.name.clone(),
            frames: track.records.len(),
            learned: count(WatchStatus::Learning),
            accepted: count(WatchStatus::Accepted),
            rejected: count(WatchStatus::Rejected),
            obstacles,
            most_blocked: track.records.iter().map(|r| r.blocked).max().unwrap_or(0),
            processing_ns: track.processing_ns.into(),
        }
    }
}

/// A period in which the monitor stopped a robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StopSummary {
    /// Start, s.
    pub from_s: f64,
    /// Time at which it moved on, or the end of the run, s.
    pub to_s: f64,
    /// The region that governed; null for a stop by invalid input.
    pub by: Option<String>,
    /// The link, tool or load closest to it.
    pub part: Option<String>,
    /// The point of that part closest to the region, in the world, m.
    pub point_m: Option<[f64; 3]>,
    /// Its distance to the region, m.
    pub distance_m: Option<f64>,
}

impl From<&Stop> for StopSummary {
    fn from(s: &Stop) -> Self {
        let point_m = s.point.map(|p| [p.x, p.y, p.z]);
        let (by, part) = (s.by.clone(), s.part.clone());
        Self { from_s: s.from_s, to_s: s.to_s, by, part, point_m, distance_m: s.distance_m }
    }
}

/// Evasion of a robot.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AvoidanceSummary {
    /// Time during which the rules corrected its motion, s.
    pub evading_s: f64,
    /// Time off its path, s.
    pub off_path_s: f64,
    /// Time during which an obstacle stopped it, s.
    pub waiting_s: f64,
    /// Smallest separation distance to any obstacle, m; null if no obstacle was near.
    pub min_distance_m: Option<f64>,
    /// Its evasions: the point of the surface that was steered, and against what.
    pub evasions: Vec<Evasion>,
    /// Number of replanning attempts.
    pub plans: usize,
    /// Number of successful ones.
    pub plans_found: usize,
    /// Wall-clock time of a step: sensing, correction, check, command, ns.
    pub step_ns: TickNs,
}

impl AvoidanceSummary {
    /// Summary of a track recorded with this tick (s).
    pub fn new(track: &AvoidanceTrack, tick_s: f64) -> Self {
        let time = |f: &dyn Fn(&AvoidanceSample) -> bool| track.samples.iter().filter(|s| f(s)).count() as f64 * tick_s;
        let least = track.samples.iter().map(|s| s.nearest_m).fold(f64::INFINITY, f64::min);
        Self {
            evading_s: time(&|s| s.state == AvoiderState::Evading),
            off_path_s: time(&|s| s.path_deviation_s > 0.0),
            waiting_s: time(&|s| s.state == AvoiderState::Waiting),
            min_distance_m: least.is_finite().then_some(least),
            evasions: track.evasions.clone(),
            plans: track.plans.len(),
            plans_found: track.plans.iter().filter(|p| p.search_s.is_some()).count(),
            step_ns: track.step_ns.into(),
        }
    }
}

/// A cycle of robots that wait for each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeadlockSummary {
    /// Time since which all of them are stopped, s.
    pub t_s: f64,
    /// The robots.
    pub robots: Vec<String>,
    /// The exchange regions they wait for.
    pub regions: Vec<String>,
}

/// A contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CollisionSummary {
    /// Time, s.
    pub t_s: f64,
    /// `robot/link`.
    pub a: String,
    /// `robot/link` or an object.
    pub b: String,
}

/// Result for one region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionSummary {
    /// Its name.
    pub name: String,
    /// `forbidden`, `monitored`, `exchange`.
    pub kind: RecordedRegionKind,
    /// Smallest distance while active, m; null if it was never active.
    pub min_distance_m: Option<f64>,
    /// True if a guarded volume touched it (for an exchange region: without holding it).
    pub entered: bool,
    /// Time during which any robot was in its warning zone, s.
    pub warned_s: f64,
}

impl From<&Recording> for RunSummary {
    fn from(r: &Recording) -> Self {
        let robot = |t: &crate::recording::RobotTrack| RobotSummary {
            name: t.name.clone(),
            flange: t.flange.clone(),
            finished: t.finished,
            ending: EndingSummary::from(&t.ending),
            stopped_s: t.stopped_s,
            stops: t.stops.iter().map(StopSummary::from).collect(),
            min_override: t.min_override,
            collisions: t
                .collisions
                .iter()
                .map(|c| CollisionSummary { t_s: c.t_s, a: c.a.clone(), b: c.b.clone() })
                .collect(),
            avoidance: t.avoidance.as_ref().map(|a| AvoidanceSummary::new(a, r.tick_s)),
            perception: t.perception.as_ref().map(PerceptionSummary::from),
        };
        let region = |t: &crate::recording::RegionTrack| RegionSummary {
            name: t.name.clone(),
            kind: t.kind,
            min_distance_m: t.min_distance_m,
            entered: t.entered,
            warned_s: t.warned_s,
        };
        let sensors = |kind| r.sensors.iter().filter(|s| s.kind == kind).map(SensorSummary::from).collect();
        let deadlock = |d: &crate::recording::Deadlock| DeadlockSummary {
            t_s: d.t_s,
            robots: d.robots.clone(),
            regions: d.regions.clone(),
        };
        Self {
            deadlocks: r.deadlocks.iter().map(deadlock).collect(),
            operators: r.robots.iter().filter_map(|robot| OperatorSummary::of(robot, r.tick_s)).collect(),
            virtual_robots: r.virtual_robots.iter().map(|v| VirtualRobotSummary::new(v, r.tick_s)).collect(),
            cell: r.cell.clone(),
            checksum: r.checksum.clone(),
            duration_s: r.duration_s,
            end: r.end,
            ticks: (r.duration_s / r.tick_s).round() as usize + 1,
            tick_ns: r.tick_ns.into(),
            robots: r.robots.iter().map(robot).collect(),
            regions: r.regions.iter().map(region).collect(),
            cameras: sensors("camera"),
            clouds: sensors("cloud"),
            objects: r.objects.iter().filter_map(ObjectSummary::of).collect(),
        }
    }
}
