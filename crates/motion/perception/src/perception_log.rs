//! Log of a run of the perception pipeline, for the report.

use std::time::Duration;

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use crate::executor_step::ExecutorStep;
use crate::obstacle_update::ObstacleUpdate;
use crate::replan_result::ReplanResult;

/// One frame.
#[derive(Debug, Clone)]
pub struct FrameEntry {
    /// Time stamp of the frame, seconds.
    pub t_s: f64,
    /// The obstacle update and the replan result, or why the frame was rejected.
    pub result: Result<(ObstacleUpdate, ReplanResult), String>,
    /// Wall-clock time from the bytes of the frame to a trajectory.
    pub elapsed: Duration,
    /// Occupied cells of the map afterwards.
    pub blocked: usize,
}

/// One control tick.
#[derive(Debug, Clone)]
pub struct TickEntry {
    /// End of the tick, seconds.
    pub t_s: f64,
    /// State of the executor at that time.
    pub step: ExecutorStep,
    /// True distance between the arm and the nearest obstacle, metres; `None` where it is not known.
    pub distance_m: Option<f64>,
}

/// True poses of an obstacle, known in simulation only.
#[derive(Debug, Clone)]
pub struct GroundTruth {
    /// Its name.
    pub name: String,
    /// Its solid.
    pub shape: Shape,
    /// One pose per tick.
    pub poses: Vec<Pose>,
}

/// An image in the report.
#[derive(Debug, Clone)]
pub struct ReportImage {
    /// Title.
    pub title: String,
    /// Description.
    pub note: String,
    /// PNG data.
    pub png: Vec<u8>,
}

/// A run of the perception pipeline.
#[derive(Debug, Clone, Default)]
pub struct PerceptionLog {
    /// Title of the page.
    pub title: String,
    /// Lines below the title.
    pub facts: Vec<String>,
    /// Control tick, seconds.
    pub tick_s: f64,
    /// In order of time.
    pub ticks: Vec<TickEntry>,
    /// In order of time.
    pub frames: Vec<FrameEntry>,
    /// True motion of the obstacles.
    pub ground_truth: Vec<GroundTruth>,
    /// In the order of the page.
    pub images: Vec<ReportImage>,
}

impl PerceptionLog {
    /// Per stage the sorted times (ms) of all accepted frames; planning stages count only where they took any time.
    pub fn stages_ms(&self) -> Vec<(&'static str, Vec<f64>)> {
        let mut stages: Vec<(&'static str, Vec<f64>)> = Vec::new();
        let mut add = |name, time: Duration| {
            let at = stages.iter().position(|(known, _)| *known == name).unwrap_or_else(|| {
                stages.push((name, Vec::new()));
                stages.len() - 1
            });
            if !time.is_zero() {
                stages[at].1.push(time.as_secs_f64() * 1e3);
            }
        };
        for entry in &self.frames {
            let Ok((update, result)) = &entry.result else { continue };
            if update.is_accepted() {
                update.times.stages().into_iter().for_each(|(name, time)| add(name, time));
                result.times.stages().into_iter().for_each(|(name, time)| add(name, time));
                add("frame to motion", entry.elapsed);
                let planned = result.kind.is_some_and(|kind| kind != elbowroom_planner::ReplanKind::Kept);
                add("… with a new path", if planned { entry.elapsed } else { Duration::ZERO });
            }
        }
        for (_, times) in &mut stages {
            times.sort_by(f64::total_cmp);
        }
        stages
    }

    /// The least true distance, metres, and its time.
    pub fn least_distance(&self) -> Option<(f64, f64)> {
        let known = self.ticks.iter().filter_map(|tick| Some((tick.distance_m?, tick.t_s)));
        known.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
