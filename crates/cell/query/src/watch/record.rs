//! Result of one picture, as JSON.

use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_perception::{ObstacleUpdate, PerceptionError, Prism};
use elbowroom_vision::{FrameStatus, HiddenFloor, RejectReason};
use serde::Serialize;

use super::joint_track::NoJointValues;
use super::sensor::Sensor;

/// Whether the obstacles of a picture can be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WatchStatus {
    /// The empty cell is being learnt; obstacles are not known yet.
    Learning,
    /// It was evaluated.
    Accepted,
    /// It was not evaluated. Obstacles and map stay as after the last accepted one: unknown is not free.
    Rejected,
}

/// An obstacle that the camera sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchedObstacle {
    /// Its identity, which does not change while it is seen.
    pub id: u64,
    /// The template that it matches; null if it matches none.
    pub kind: Option<String>,
    /// Corners of its footprint, with the uncertainty, world x and y, m.
    pub outline_m: Vec<[f64; 2]>,
    /// Height of its lower end in the world, m.
    pub bottom_m: f64,
    /// Height of its upper end above its lower one, m.
    pub height_m: f64,
    /// Its estimated centre, world x and y, m.
    pub centre_m: [f64; 2],
    /// Velocity of the centre, m/s.
    pub velocity_m_s: [f64; 2],
    /// False if it was hidden in this picture and is kept at its last position.
    pub seen: bool,
}

/// Floor that was hidden in all pictures of the empty cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HiddenFloorRecord {
    /// Smallest world x and y, m.
    pub from_m: [f64; 2],
    /// Largest world x and y, m.
    pub to_m: [f64; 2],
    /// Its area, m².
    pub area_m2: f64,
}

impl HiddenFloorRecord {
    fn of(hidden: &HiddenFloor) -> Self {
        let HiddenFloor { min_m, max_m, area_m2 } = *hidden;
        Self { from_m: [min_m.x, min_m.y], to_m: [max_m.x, max_m.y], area_m2 }
    }
}

impl std::fmt::Display for HiddenFloorRecord {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([x0, y0], [x1, y1]) = (self.from_m, self.to_m);
        write!(
            f,
            "{:.2} m² of the floor, within x {x0:.2} to {x1:.2} m and y {y0:.2} to {y1:.2} m, were hidden by robots in all \
             pictures of the empty cell: unknown, they count as an obstacle wherever they can be seen later",
            self.area_m2
        )
    }
}

/// Hint on how to show hidden floor.
pub(crate) const SHOW_THE_FLOOR: &str =
    "robots that move while the empty cell is learnt, or an `area` without the floor that they always hide";

/// Why a picture or cloud cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub(super) enum NoUpdate {
    /// Its file cannot be read.
    #[error(transparent)]
    File(#[from] Diagnostic),
    /// The positions of the robots are not known.
    #[error(transparent)]
    JointValues(#[from] NoJointValues),
    /// It is not a picture or cloud of this sensor.
    #[error(transparent)]
    Perception(#[from] PerceptionError),
}

/// Result of one picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchRecord {
    /// Time at which it was taken, s.
    pub t_s: f64,
    /// The name of its file.
    pub frame: String,
    /// Whether it was evaluated.
    pub status: WatchStatus,
    /// Reason if it was rejected; null otherwise.
    pub reason: Option<String>,
    /// In the last picture of the empty cell: floor that no picture showed, which counts as an obstacle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hidden_floor: Option<HiddenFloorRecord>,
    /// All obstacles.
    pub obstacles: Vec<WatchedObstacle>,
    /// Obstacles that entered.
    pub entered: Vec<u64>,
    /// Obstacles that left.
    pub left: Vec<u64>,
    /// Cells of the map that obstacles block.
    pub blocked: u64,
    /// Time from the picture in memory to the published map, µs.
    pub time_us: u64,
}

impl WatchRecord {
    pub(super) fn of(path: &Path, t_s: f64, result: Result<ObstacleUpdate, NoUpdate>, sensor: &Sensor) -> Self {
        let frame = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let blocked = sensor.map().occupancy().blocked() as u64;
        match result {
            Ok(update) => {
                let (status, reason) = status(&update.status);
                let has_learnt = update.status == FrameStatus::Learning { frames_left: 0 };
                let hidden = sensor.hidden_floor().filter(|_| has_learnt);
                Self {
                    t_s,
                    frame,
                    status,
                    reason,
                    hidden_floor: hidden.as_ref().map(HiddenFloorRecord::of),
                    obstacles: update.prisms.iter().map(WatchedObstacle::of).collect(),
                    entered: update.entered.iter().map(|id| id.0).collect(),
                    left: update.left.iter().map(|id| id.0).collect(),
                    blocked,
                    time_us: u64::try_from(update.times.total().as_micros()).unwrap_or(u64::MAX),
                }
            }
            Err(why) => Self {
                t_s,
                frame,
                status: WatchStatus::Rejected,
                reason: Some(why.to_string()),
                hidden_floor: None,
                obstacles: sensor.prisms().iter().map(WatchedObstacle::of).collect(),
                entered: Vec::new(),
                left: Vec::new(),
                blocked,
                time_us: 0,
            },
        }
    }
}

impl WatchedObstacle {
    fn of(prism: &Prism) -> Self {
        Self {
            id: prism.id.0,
            kind: prism.kind.clone(),
            outline_m: prism.footprint_m.iter().map(|p| [p.x, p.y]).collect(),
            bottom_m: prism.z_from_m,
            height_m: prism.z_to_m - prism.z_from_m,
            centre_m: [prism.centre_m.x, prism.centre_m.y],
            velocity_m_s: [prism.velocity_mps.x, prism.velocity_mps.y],
            seen: !prism.is_unobserved,
        }
    }
}

fn status(status: &FrameStatus) -> (WatchStatus, Option<String>) {
    match status {
        FrameStatus::Learning { .. } => (WatchStatus::Learning, None),
        FrameStatus::Accepted => (WatchStatus::Accepted, None),
        FrameStatus::Rejected(reason) => (WatchStatus::Rejected, Some(why(reason))),
    }
}

fn why(reason: &RejectReason) -> String {
    match reason {
        RejectReason::Illumination(_) => {
            "the picture is much darker or brighter than while the empty cell was learnt".into()
        }
        RejectReason::Unrecognized { inlier_ratio } => format!(
            "only {:.0} % of the floor look as while the empty cell was learnt: a lamp, a covered lens, or a moved camera",
            100.0 * inlier_ratio
        ),
        RejectReason::TooMuchForeground { foreground_ratio } => {
            format!("{:.0} % of the picture differ from the empty cell", 100.0 * foreground_ratio)
        }
        RejectReason::FewPoints { points, dropped } => {
            format!("only {points} of {} points are valid", points + dropped)
        }
    }
}
