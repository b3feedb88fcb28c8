//! How long an arm could hold the work-piece if it goes on as it moves now, found in small pieces.

use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use crate::desired_path::DesiredPath;
use crate::holding::{Holding, Margins};
use crate::trace::Trace;
use crate::{CooperationSettings, HoldLimit};

/// Number of configurations that are foreseen within the horizon.
const SAMPLES: usize = 32;

/// Time ahead for which both arms must have room beyond a hand-over without waiting, s.
const SPARE_S: f64 = 1.0;

/// Result of a forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HoldTime {
    /// Path time (s) from which the arm could not hold the work-piece any longer; infinite beyond the horizon, and minus
    /// infinity if it cannot hold it at all.
    pub to_s: f64,
    /// Path time (s) from which the arm would hide the work-piece from the camera; infinite beyond the horizon, and without
    /// a camera.
    pub hidden_from_s: f64,
    /// Why it could not hold it.
    pub limit: Option<HoldLimit>,
}

/// The arm that would give the work-piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Giver<'a> {
    pub robot: RobotId,
    /// Its joint values.
    pub q: &'a [f64],
    /// Where it will be.
    pub trace: &'a Trace,
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
    /// Whether the arm hides the work-piece from the camera at the pre-grasp already.
    pub hides_before: bool,
    /// The last result; `None` before the first.
    pub result: Option<HoldTime>,
    /// Of an arm that holds: the foreseen configurations of the last whole forecast, and of the present one.
    pub trace: Trace,
    next_trace: Trace,
    /// The foreseen configuration.
    q: Vec<f64>,
    /// Path time at which this forecast began, s, and the number of configurations so far.
    from_s: f64,
    done: usize,
    /// Path time from which this forecast hides the work-piece, s; infinite if it does not so far.
    hidden_from_s: f64,
    /// Forecasts until the next search for another branch.
    pause: usize,
}

impl Forecast {
    /// An arm of so many joints, of which nothing is known.
    pub fn new(joints: usize) -> Self {
        let (q, pre_grasp) = (vec![0.0; joints], vec![0.0; joints]);
        let [trace, next_trace] = [0, 1].map(|_| Trace::new(joints, SAMPLES + 1));
        Self {
            grasped: None,
            pre_grasp,
            hides_before: false,
            result: None,
            trace,
            next_trace,
            q,
            from_s: 0.0,
            done: 0,
            hidden_from_s: f64::INFINITY,
            pause: 0,
        }
    }

    /// Begins anew.
    pub fn restart(&mut self) {
        self.done = 0;
        self.result = None;
        self.trace.clear();
    }

    /// Time until the arm could not hold the work-piece any longer, which is at `path_s` now, s; 0 if unknown.
    pub fn seconds(&self, path_s: f64) -> f64 {
        self.result.map_or(0.0, |result| (result.to_s - path_s).max(0.0))
    }

    /// Time until the arm could not hold the work-piece any longer, or would hide it from the camera, s; 0 if unknown.
    pub fn seconds_in_view(&self, path_s: f64) -> f64 {
        self.result.map_or(0.0, |result| (result.to_s.min(result.hidden_from_s) - path_s).max(0.0))
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
        (q, giver): (&[f64], Option<Giver<'_>>),
        (settings, margins): (&CooperationSettings, &Margins),
    ) {
        if self.done == 0 {
            self.from_s = path_s;
            let is_possible = match giver {
                None => self.begin_held(holding, path, q),
                Some(giver) => self.begin(holding, &path.at(path_s), (q, giver), margins),
            };
            self.hidden_from_s = f64::INFINITY;
            if !is_possible {
                self.result = Some(self.ends(f64::NEG_INFINITY, Some(HoldLimit::Reach)));
                return;
            }
            self.see(holding, &path.at(path_s), path_s, margins);
            self.done = 1;
            return;
        }
        let step_s = settings.horizon_s / SAMPLES as f64;
        let ahead_s = self.done as f64 * step_s;
        let followed = holding.follow(&path.foreseen(self.from_s + ahead_s), step_s, &mut self.q, margins);
        let both_s = SPARE_S + 2.0 * (settings.settle_s + holding.grasp.length_m() / settings.approach_m_s);
        match followed.and_then(|()| self.meets_giver(holding, path, (giver, ahead_s, both_s), margins)) {
            Ok(()) => {
                let before_s = self.from_s + ahead_s - step_s;
                self.see(holding, &path.foreseen(self.from_s + ahead_s), before_s, margins);
                if self.done < SAMPLES {
                    self.done += 1;
                } else {
                    self.conclude(self.ends(f64::INFINITY, None));
                }
            }
            Err(limit) => self.conclude(self.ends(self.from_s + ahead_s - step_s, Some(limit))),
        }
    }

    fn ends(&self, to_s: f64, limit: Option<HoldLimit>) -> HoldTime {
        HoldTime { to_s, hidden_from_s: self.hidden_from_s, limit }
    }

    /// Notes the first place at which the arm hides the work-piece, and the path time before it (s).
    fn see(&mut self, holding: &mut Holding<'_>, part_in_world: &Pose, before_s: f64, margins: &Margins) {
        if self.hidden_from_s.is_infinite() && holding.hides(part_in_world, &self.q, margins.hidden_share) {
            self.hidden_from_s = before_s;
        }
    }

    /// Whether there is room beside the giver until its hand has left; an arm that holds notes where it will be.
    fn meets_giver(
        &mut self,
        holding: &mut Holding<'_>,
        path: &DesiredPath,
        (giver, ahead_s, both_s): (Option<Giver<'_>>, f64, f64),
        margins: &Margins,
    ) -> Result<(), HoldLimit> {
        let path_s = self.from_s + ahead_s;
        let Some(giver) = giver else {
            self.note(holding, path, path_s);
            return Ok(());
        };
        let Some((q, retreated)) = giver.trace.at(path_s).filter(|_| ahead_s < both_s) else { return Ok(()) };
        let is_clear = [q, retreated].iter().all(|q| holding.clears(&self.q, giver.robot, q, margins.gap_m));
        if is_clear { Ok(()) } else { Err(HoldLimit::OtherArm) }
    }

    /// Notes where an arm that holds will be.
    fn note(&mut self, holding: &mut Holding<'_>, path: &DesiredPath, path_s: f64) {
        self.pre_grasp.copy_from_slice(&self.q);
        // It can, or the forecast ends here.
        let _ = holding.retreat(&path.foreseen(path_s), &mut self.pre_grasp);
        self.next_trace.push(path_s, &self.q, &self.pre_grasp);
    }

    fn conclude(&mut self, result: HoldTime) {
        self.result = Some(result);
        self.done = 0;
        std::mem::swap(&mut self.trace, &mut self.next_trace);
    }

    fn begin_held(&mut self, holding: &mut Holding<'_>, path: &DesiredPath, q: &[f64]) -> bool {
        self.q.copy_from_slice(q);
        self.next_trace.clear();
        self.note(holding, path, self.from_s);
        self.grasped = None;
        true
    }

    /// Finds how the arm would take the work-piece, on the branch of the last time if possible.
    fn begin(
        &mut self,
        holding: &mut Holding<'_>,
        part_in_world: &Pose,
        (q, giver): (&[f64], Giver<'_>),
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
                self.pause = 12;
            }
        }
        let Some(grasped) = &self.grasped else { return false };
        self.q.copy_from_slice(grasped);
        self.pre_grasp.copy_from_slice(grasped);
        if holding.solve(part_in_world, &grasp.at(grasp.length_m()), &mut self.pre_grasp)
            && holding.clears(&self.q, giver.robot, giver.q, 0.5 * margins.gap_m)
        {
            self.hides_before = holding.hides(part_in_world, &self.pre_grasp, margins.hidden_share);
            return true;
        }
        self.grasped = None;
        false
    }
}
