//! A run in one JSON document: what `elbowroom run --json` prints.

use serde::Serialize;

use crate::Recording;

/// The figures of a run, in SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The cell's name.
    pub cell: String,
    /// Checksum of its configuration.
    pub checksum: String,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Ticks of the run.
    pub ticks: usize,
    /// Wall-clock time of the monitor's ticks, ns.
    pub tick_ns: TickNs,
    /// Per robot.
    pub robots: Vec<RobotSummary>,
    /// Per region.
    pub regions: Vec<RegionSummary>,
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

/// What one robot did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RobotSummary {
    /// Its name.
    pub name: String,
    /// True where its program came to its end.
    pub finished: bool,
    /// Time it was held, s.
    pub stopped_s: f64,
    /// Smallest override, 0..1.
    pub min_override: f64,
    /// First contact of each pair.
    pub collisions: Vec<CollisionSummary>,
}

/// A contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CollisionSummary {
    /// When, s.
    pub t_s: f64,
    /// `robot/link`.
    pub a: String,
    /// `robot/link` or an object.
    pub b: String,
}

/// What happened at one region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionSummary {
    /// Its name.
    pub name: String,
    /// `forbidden`, `monitored`, `exchange`.
    pub kind: &'static str,
    /// Smallest distance while active, m; null where it never was.
    pub min_distance_m: Option<f64>,
    /// True where a guarded volume touched it (for exchange: without holding it).
    pub entered: bool,
    /// Time that any robot was in its warning zone, s.
    pub warned_s: f64,
}

impl From<&Recording> for Summary {
    fn from(r: &Recording) -> Self {
        let robot = |t: &crate::RobotTrack| RobotSummary {
            name: t.name.clone(),
            finished: t.finished,
            stopped_s: t.stopped_s,
            min_override: t.min_override,
            collisions: t
                .collisions
                .iter()
                .map(|c| CollisionSummary { t_s: c.t_s, a: c.a.clone(), b: c.b.clone() })
                .collect(),
        };
        let region = |t: &crate::RegionTrack| RegionSummary {
            name: t.name.clone(),
            kind: t.kind,
            min_distance_m: t.min_distance_m,
            entered: t.entered,
            warned_s: t.warned_s,
        };
        Self {
            cell: r.cell.clone(),
            checksum: r.checksum.clone(),
            duration_s: r.duration_s,
            ticks: (r.duration_s / r.tick_s).round() as usize + 1,
            tick_ns: TickNs { p50: r.tick_ns.p50, p99: r.tick_ns.p99, max: r.tick_ns.max },
            robots: r.robots.iter().map(robot).collect(),
            regions: r.regions.iter().map(region).collect(),
        }
    }
}
