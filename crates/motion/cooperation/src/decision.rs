//! When the work-piece is handed over, and to whom.

use crate::advance::LEAST_RATE;
use crate::forecast::Giver;
use crate::hand_over::HandOver;
use crate::holding::Margins;
use crate::virtual_robot::usable;
use crate::{HandOverReason, HoldLimit, VirtualRobot};

/// What a hand-over must gain while the work-piece stands, s.
const STOPPED_GAIN_S: f64 = 0.15;
/// Share of the joint speeds that a receiver may need at the desired speed; the work-piece then slows down.
const RECEIVER_SPEED: f64 = 2.0;
/// Time for which the work-piece waits for a receiver where the holder can go on, but not let go any more, s.
const PATIENCE_S: f64 = 2.0;
/// Duration of a step with one piece of the holder's forecast, s.
const STEP_S: f64 = 4e-3;
/// A free arm waits for another grasp only if that is better by this, s.
const BETTER_S: f64 = 0.5;
/// Pieces of the forecasts of the other grasps, per piece of the holder's.
const PIECES: usize = 2;

impl VirtualRobot<'_> {
    /// Goes on with the forecasts: that of the holder, and the others in turn.
    pub(crate) fn foresee(&mut self, dt_s: f64) {
        // A long step has time for more.
        let steps = (dt_s / STEP_S).clamp(1.0, 16.0) as usize;
        (0..steps).for_each(|_| self.foresee_one(self.carried.holder));
        for _ in 0..PIECES * steps {
            let k = self.decision.turn;
            if k != self.carried.holder {
                self.foresee_one(k);
            }
            // The turn ends with a result.
            if k == self.carried.holder || self.forecasts[k].is_at_start() {
                self.decision.turn = (k + 1) % self.holdings.len();
            }
        }
    }

    fn foresee_one(&mut self, k: usize) {
        // While the work-piece stands at a limit, anything that gets it further is welcome.
        let margins = match self.carried.ahead.limit {
            Some(_) if self.carried.rate == 0.0 => Margins::executed(&self.settings, true),
            _ => Margins::foreseen(&self.settings),
        };
        let holder = &self.arms[self.holder()];
        // Lent by the forecast of the holder.
        let of_holder = if k == self.carried.holder { None } else { self.forecasts.get_mut(self.carried.holder) };
        let trace = of_holder.map(|f| std::mem::take(&mut f.trace)).unwrap_or_default();
        let giver = Giver { robot: holder.robot, q: &holder.state.q, trace: &trace };
        let giver = (k != self.carried.holder).then_some(giver);
        // A receiver that is a little slow is better than none.
        let speed_share = if giver.is_some() { margins.speed_share.max(RECEIVER_SPEED) } else { margins.speed_share };
        let (holding, forecast) = (&mut self.holdings[k], &mut self.forecasts[k]);
        let q = &self.arms[holding.member].state.q;
        let margins = Margins { speed_share, ..margins };
        forecast.proceed(holding, &self.carried.path, self.carried.path_s, (q, giver), (&self.settings, &margins));
        if k != self.carried.holder {
            self.forecasts[self.carried.holder].trace = trace;
        }
    }

    /// How long the arm with the grasp of this index could hold, s.
    fn holds_s(&self, k: usize) -> f64 {
        self.forecasts[k].seconds(self.carried.path_s)
    }

    /// How long the arm with the grasp of this index could hold without hiding the work-piece from the camera, s.
    fn in_view_s(&self, k: usize) -> f64 {
        self.forecasts[k].seconds_in_view(self.carried.path_s)
    }

    /// Time until the receiver of this index holds the work-piece, s; infinite if it cannot.
    fn takes_s(&self, k: usize) -> f64 {
        let (holding, forecast) = (&self.holdings[k], &self.forecasts[k]);
        if forecast.grasped.is_none() {
            return f64::INFINITY;
        }
        let (limits, q) = (&self.members[holding.member].limits, &self.arms[holding.member].state.q);
        let joint = |((to, from), l): ((&f64, &f64), &elbowroom_kinematics::JointLimits)| {
            (to - from).abs() / l.velocity
                + (l.velocity / l.acceleration).min(((to - from).abs() / l.acceleration).sqrt())
        };
        let reaching = forecast.pre_grasp.iter().zip(q).zip(limits).map(joint).fold(0.0, f64::max);
        reaching + holding.grasp.length_m() / self.settings.approach_m_s + self.settings.settle_s + 0.3
    }

    /// How long the receiver of this index could hold, less how long it takes; the more, the better. Beyond the horizon
    /// every time is the same.
    ///
    /// Half of the time for which it would hide the work-piece from the camera does not count.
    fn value_s(&self, k: usize) -> f64 {
        let [holds_s, in_view_s] = [self.holds_s(k), self.in_view_s(k)].map(|s| s.min(self.settings.horizon_s));
        0.5 * (holds_s + in_view_s) - self.takes_s(k)
    }

    /// Whether another arm could take the work-piece and hold it for a while; not if that was hoped for too long already.
    pub(crate) fn has_receiver(&self) -> bool {
        let is_usable = |k: usize| {
            self.holdings[k].member != self.holder()
                && self.decision.refused_s[k] == 0.0
                && self.forecasts[k].grasped.is_some()
                && self.holds_s(k) > STOPPED_GAIN_S
        };
        let is_under_way = self.hand_over.as_ref().is_some_and(|h| h.follower().is_some());
        is_under_way || self.decision.no_retreat_s < PATIENCE_S && (0..self.holdings.len()).any(is_usable)
    }

    /// Chooses the grasp for which each free arm waits: where a hand-over would be quickest and last longest. No arm waits
    /// where it hides the work-piece from the camera.
    pub(crate) fn choose_waiting(&mut self) {
        for member in 0..self.members.len() {
            let of_hand_over = self.hand_over.as_ref().map(|h| h.receiver);
            let in_hand_over = of_hand_over.filter(|k| self.holdings[*k].member == member);
            if let Some(k) = in_hand_over {
                self.limbs[member].waits_for = Some(k);
                continue;
            }
            let is_possible = |k: &usize| self.forecasts[*k].grasped.is_some() && !self.forecasts[*k].hides_before;
            let own = |k: &usize| self.holdings[*k].member == member && is_possible(k);
            let by_value = |a: &usize, b: &usize| self.value_s(*a).total_cmp(&self.value_s(*b));
            let best = (0..self.holdings.len()).filter(own).max_by(by_value);
            let present = self.limbs[member].waits_for.filter(is_possible);
            self.limbs[member].waits_for = match (best, present) {
                (Some(best), Some(now)) if self.value_s(best) < self.value_s(now) + BETTER_S => Some(now),
                (best, _) => best,
            };
        }
    }

    /// Begins a hand-over if the holder will fail before a later one could be complete, or would hide the work-piece from the
    /// camera, to an arm that its override lets move.
    pub(crate) fn decide(&mut self, dt_s: f64, overrides: &[f64]) {
        self.decision.since_s += dt_s;
        let waits = self.carried.rate == 0.0 && self.carried.ahead.limit == Some(HoldLimit::Retreat);
        if waits && self.hand_over.as_ref().is_none_or(|h| h.follower().is_none()) {
            self.decision.no_retreat_s += dt_s;
        }
        self.decision.refused_s.iter_mut().for_each(|s| *s = (*s - dt_s).max(0.0));
        let is_early = self.decision.since_s < self.settings.rest_s && self.carried.rate > 0.0;
        if self.hand_over.is_some() || is_early || !self.carried.wants_to_move() {
            return;
        }
        // First to an arm that keeps the work-piece in view; if there is none, to one that can hold it.
        let wanted = [true, false].into_iter().find_map(|in_view| self.receiver(in_view, overrides));
        let Some((receiver, reason)) = wanted else { return };
        let giver = self.carried.holder;
        let (holding, part_in_world) = (&mut self.holdings[giver], self.carried.pose());
        if !holding.can_retreat(&part_in_world, &self.arms[holding.member].state.q) {
            return;
        }
        self.decision.reason = Some(reason);
        let joints = self.members[self.holdings[receiver].member].limits.len();
        self.hand_over = Some(HandOver::new(giver, receiver, &self.holdings, joints));
    }

    /// How long the holder can hold, or keep the work-piece in view too, and what ends that, s.
    fn giver_holds_s(&self, in_view: bool) -> Option<(f64, Option<HoldLimit>)> {
        let giver = self.carried.holder;
        let held = self.forecasts[giver].result?;
        let (holds_s, limit) = match self.carried.ahead.limit {
            Some(limit) => (self.carried.ahead.free_to_s - self.carried.path_s, Some(limit)),
            None => (self.holds_s(giver), held.limit),
        };
        let in_view_s = self.in_view_s(giver);
        Some(if in_view && in_view_s < holds_s { (in_view_s, Some(HoldLimit::Hidden)) } else { (holds_s, limit) })
    }

    /// The arm that should take the work-piece now, and why; `None` if the holder should keep it. With `in_view`, an arm that
    /// hides the work-piece from the camera counts as one that cannot hold it.
    fn receiver(&self, in_view: bool, overrides: &[f64]) -> Option<(usize, HandOverReason)> {
        let giver = self.carried.holder;
        let (giver_holds_s, limit) = self.giver_holds_s(in_view)?;
        let holds_s = |k: usize| if in_view { self.in_view_s(k) } else { self.holds_s(k) };
        // An arm that stands at its limit gives the work-piece to whoever gets any further.
        let gain_s =
            if self.carried.rate == 0.0 { self.settings.gain_s.min(STOPPED_GAIN_S) } else { self.settings.gain_s };
        // Until its hand has moved back, the giver must be able to follow.
        let leaving_s = self.settings.settle_s + self.holdings[giver].grasp.length_m() / self.settings.approach_m_s;
        let is_useful = |k: &usize| {
            let takes_s = self.takes_s(*k);
            // A hand-over hides the work-piece too: the view must gain from it.
            let is_worth_it =
                limit != Some(HoldLimit::Hidden) || holds_s(*k) >= takes_s + leaving_s + self.settings.gain_s;
            self.holdings[*k].member != self.holdings[giver].member
                && usable(overrides[self.holdings[*k].member]) >= LEAST_RATE
                && self.decision.refused_s[*k] == 0.0
                && takes_s.is_finite()
                && giver_holds_s < (1.0 + self.settings.reserve) * takes_s + leaving_s
                && holds_s(*k) >= giver_holds_s + gain_s
                && is_worth_it
        };
        let by_value = |a: &usize, b: &usize| self.value_s(*a).total_cmp(&self.value_s(*b));
        let receiver = (0..self.holdings.len()).filter(is_useful).max_by(by_value)?;
        let (receiver_holds_s, takes_s) = (holds_s(receiver), self.takes_s(receiver));
        Some((receiver, HandOverReason { limit, giver_holds_s, receiver_holds_s, takes_s }))
    }
}
