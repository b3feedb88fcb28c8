//! What a run with virtual robots tells in numbers.

use serde::Serialize;

use crate::recording::{HandOverRecord, ViewTrack, VirtualRobotSample, VirtualRobotTrack, WorkPieceStop};

/// Robots that acted as one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VirtualRobotSummary {
    /// Name of the virtual robot.
    pub name: String,
    /// Share of the desired motion that was carried out, 0 to 1.
    pub carried_share: f64,
    /// Time for which the work-piece stood although it should have moved, s.
    pub stopped_s: f64,
    /// These periods.
    pub stops: Vec<WorkPieceStop>,
    /// Hand-overs, in order of time.
    pub hand_overs: Vec<HandOverSummary>,
    /// Least distance between two of the robots, with the work-piece, m; what may touch does not count; null
    /// if it was always more than 0.1 m.
    pub least_gap_m: Option<f64>,
    /// Largest distance of the work-piece from the desired path, m.
    pub path_deviation_m: f64,
    /// What the camera saw of it; omitted if no camera looks at it.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub view: Option<ViewSummary>,
}

/// What a camera saw of a work-piece.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ViewSummary {
    /// Name of the camera.
    pub seen_by: String,
    /// Time for which the robots hid more of its surface in view than allowed, s.
    pub hidden_s: f64,
    /// Largest share of its surface in view that they hid, 0 to 1; null if it was never in view.
    pub largest_hidden_share: Option<f64>,
    /// Time for which nothing of it was in view, even without the robots, s.
    pub out_of_view_s: f64,
}

/// A hand-over.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HandOverSummary {
    /// Time at which the receiver took the work-piece, s.
    pub t_s: f64,
    /// The giver.
    pub from: String,
    /// The receiver.
    pub to: String,
    /// Why it was decided, in words.
    pub reason: String,
}

impl VirtualRobotSummary {
    /// Summary of a track recorded with this tick (s).
    pub fn new(track: &VirtualRobotTrack, tick_s: f64) -> Self {
        let name = |index: usize| track.robots.get(index).cloned().unwrap_or_default();
        let hand_over = |h: &HandOverRecord| HandOverSummary {
            t_s: h.t_s,
            from: name(h.from),
            to: name(h.to),
            reason: h.reason.clone(),
        };
        let deviation = track
            .samples
            .iter()
            .map(|s| s.part_in_world.translation.distance(s.on_path.translation))
            .fold(0.0, f64::max);
        Self {
            name: track.name.clone(),
            carried_share: track.carried_share,
            stopped_s: track.samples.iter().filter(|s| s.is_stopped).count() as f64 * tick_s,
            stops: track.stops.clone(),
            hand_overs: track.hand_overs.iter().map(hand_over).collect(),
            least_gap_m: track.samples.iter().map(|s| s.gap_m).filter(|gap| gap.is_finite()).reduce(f64::min),
            path_deviation_m: deviation,
            view: track.view.as_ref().map(|view| ViewSummary::new(view, &track.samples, tick_s)),
        }
    }
}

impl ViewSummary {
    fn new(view: &ViewTrack, samples: &[VirtualRobotSample], tick_s: f64) -> Self {
        let ticks = |counts: &dyn Fn(Option<f64>) -> bool| {
            samples.iter().filter(|s| counts(s.hidden_share)).count() as f64 * tick_s
        };
        Self {
            seen_by: view.camera.clone(),
            hidden_s: ticks(&|share| share.is_some_and(|share| share > view.allowed_share)),
            largest_hidden_share: samples.iter().filter_map(|s| s.hidden_share).reduce(f64::max),
            out_of_view_s: ticks(&|share| share.is_none()),
        }
    }
}
