//! What a watched run leaves behind, for the report.

use std::time::Duration;

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

use super::{Outlook, Sighting, Step};

/// What happened at one frame.
#[derive(Debug, Clone)]
pub struct FrameEntry {
    /// When it was taken, seconds.
    pub t_s: f64,
    /// What it told, or why it could not be used.
    pub told: Result<(Sighting, Outlook), String>,
    /// From its bytes to a motion, measured on the clock of the wall.
    pub took: Duration,
    /// Blocked cells of the map afterwards.
    pub blocked: usize,
}

/// What happened at one control tick.
#[derive(Debug, Clone)]
pub struct TickEntry {
    /// Its end, seconds.
    pub t_s: f64,
    /// Where the arm was then.
    pub step: Step,
    /// From the arm's solids to the nearest thing where it really was, metres; `None` where nobody knows.
    pub distance_m: Option<f64>,
}

/// Where a thing really was, known in simulation only.
#[derive(Debug, Clone)]
pub struct Truth {
    /// Its name.
    pub name: String,
    /// Its solid.
    pub shape: Shape,
    /// One pose per tick.
    pub poses: Vec<Pose>,
}

/// A picture for the page.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Heading.
    pub title: String,
    /// What is to be seen.
    pub note: String,
    /// The file's bytes.
    pub png: Vec<u8>,
}

/// A watched run.
#[derive(Debug, Clone, Default)]
pub struct WatchLog {
    /// Heading of the page.
    pub title: String,
    /// Lines below it.
    pub facts: Vec<String>,
    /// Control tick, seconds.
    pub tick_s: f64,
    /// In order of time.
    pub ticks: Vec<TickEntry>,
    /// In order of time.
    pub frames: Vec<FrameEntry>,
    /// What was really there.
    pub truth: Vec<Truth>,
    /// In the order of the page.
    pub pictures: Vec<Picture>,
}

impl WatchLog {
    /// Names of all stages with the times of each frame that was clear and, for stages of planning, took any time: in
    /// milliseconds, sorted.
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
            let Ok((sighting, outlook)) = &entry.told else { continue };
            if sighting.is_clear() {
                sighting.times.stages().into_iter().for_each(|(name, time)| add(name, time));
                outlook.times.stages().into_iter().for_each(|(name, time)| add(name, time));
                add("frame to motion", entry.took);
                let planned = outlook.how.is_some_and(|how| how != elbowroom_planner::How::Kept);
                add("… with a new path", if planned { entry.took } else { Duration::ZERO });
            }
        }
        for (_, times) in &mut stages {
            times.sort_by(f64::total_cmp);
        }
        stages
    }

    /// The least true distance, metres, and when.
    pub fn least_distance(&self) -> Option<(f64, f64)> {
        let known = self.ticks.iter().filter_map(|tick| Some((tick.distance_m?, tick.t_s)));
        known.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// The value below which a share of sorted values lies; `None` of none.
pub(crate) fn share_of(sorted: &[f64], share: f64) -> Option<f64> {
    sorted.get((sorted.len().saturating_sub(1) as f64 * share).round() as usize).copied()
}
