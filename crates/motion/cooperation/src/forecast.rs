//! How long an arm could hold the work-piece if it goes on as it moves now, found in small pieces.

use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::desired_path::DesiredPath;
use crate::holding::{Holding, Margins};
use crate::{CooperationSettings, HoldLimit};

/// Number of configurations that are foreseen within the horizon.
const SAMPLES: usize = 32;

/// Result of a forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HoldTime {
    /// Path time (s) from which the arm could not hold the work-piece any longer; infinite beyond the horizon, and minus
    /// infinity if it cannot hold it at all.
    pub to_s: f64,
    /// Why.
    pub limit: Option<HoldLimit>,
}

/// The forecast of one arm with one grasp.
///
/// It runs in small pieces, one configuration each, and then begins anew from where the work-piece is by then.
#[derive(Debug)]
pub(crate) struct Forecast {
    /// Configuration with which the arm would take the work-piece; `None` if it cannot.
    pub grasped: Option<Vec<f64>>,
    /// The configuration at the pre-grasp from there.
    pub pre_grasp: Vec<f64>,
    /// The last result; `None` before the first.
    pub result: Option<HoldTime>,
    /// The foreseen configuration.
    q: Vec<f64>,
    /// Path time at which this forecast began, s, and the number of configurations so far.
    from_s: f64,
    done: usize,
    /// Forecasts until the next search for another branch.
    pause: usize,
}

impl Forecast {
    /// An arm of so many joints, of which nothing is known.
    pub fn new(joints: usize) -> Self {
        let (q, pre_grasp) = (vec![0.0; joints], vec![0.0; joints]);
        Self { grasped: None, pre_grasp, result: None, q, from_s: 0.0, done: 0, pause: 0 }
    }

    /// Begins anew.
    pub fn restart(&mut self) {
        self.done = 0;
        self.result = None;
    }

    /// Time until the arm could not hold the work-piece any longer, which is at `path_s` now, s; 0 if unknown.
    pub fn seconds(&self, path_s: f64) -> f64 {
        self.result.map_or(0.0, |result| (result.to_s - path_s).max(0.0))
    }

    /// Whether the next piece is the first of a forecast.
    pub fn is_at_start(&self) -> bool {
        self.done == 0
    }

    /// One piece of the forecast of an arm at `q`, which would take the work-piece from the giver, or holds it.
    pub fn proceed(
        &mut self,
        holding: &mut Holding<'_>,
        path: &DesiredPath,
        path_s: f64,
        (q, giver): (&[f64], Option<(RobotId, &[f64])>),
        (settings, margins): (&CooperationSettings, &Margins),
    ) {
        if self.done == 0 {
            self.from_s = path_s;
            let is_possible = match giver {
                None => self.begin_held(q),
                Some(giver) => self.begin(holding, &path.at(path_s), (q, giver), margins),
            };
            if !is_possible {
                self.result = Some(HoldTime { to_s: f64::NEG_INFINITY, limit: Some(HoldLimit::Reach) });
                return;
            }
            self.done = 1;
            return;
        }
        let step_s = settings.horizon_s / SAMPLES as f64;
        let ahead_s = self.done as f64 * step_s;
        match holding.follow(&path.foreseen(self.from_s + ahead_s), step_s, &mut self.q, margins) {
            Ok(()) if self.done < SAMPLES => self.done += 1,
            Ok(()) => self.conclude(HoldTime { to_s: f64::INFINITY, limit: None }),
            Err(limit) => {
                self.conclude(HoldTime { to_s: self.from_s + ahead_s - step_s, limit: Some(limit) });
            }
        }
    }

    fn conclude(&mut self, result: HoldTime) {
        self.result = Some(result);
        self.done = 0;
    }

    fn begin_held(&mut self, q: &[f64]) -> bool {
        self.q.copy_from_slice(q);
        self.grasped = None;
        true
    }

    /// Finds how the arm would take the work-piece, on the branch of the last time if possible.
    fn begin(
        &mut self,
        holding: &mut Holding<'_>,
        part_in_world: &Pose,
        (q, giver): (&[f64], (RobotId, &[f64])),
        margins: &Margins,
    ) -> bool {
        let grasp = holding.grasp;
        let known = self.grasped.take().filter(|known| {
            self.q.copy_from_slice(known);
            holding.solve(part_in_world, &grasp.tool_in_part, &mut self.q) && holding.is_free(&self.q, margins).is_ok()
        });
        match known {
            Some(mut known) => {
                known.copy_from_slice(&self.q);
                self.grasped = Some(known);
            }
            None if self.pause > 0 => self.pause -= 1,
            None => {
                self.grasped = holding.search(part_in_world, q, margins);
                self.pause = 5;
            }
        }
        let Some(grasped) = &self.grasped else { return false };
        self.q.copy_from_slice(grasped);
        self.pre_grasp.copy_from_slice(grasped);
        if holding.solve(part_in_world, &grasp.at(grasp.length_m()), &mut self.pre_grasp)
            && holding.clears(&self.q, giver.0, giver.1, 0.5 * margins.gap_m)
        {
            return true;
        }
        self.grasped = None;
        false
    }
}
