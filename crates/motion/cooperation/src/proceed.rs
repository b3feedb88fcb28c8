//! The phases of a hand-over, and who holds the work-piece in each.

use elbowroom_kinematics::LinkId;
use elbowroom_robot::RobotId;
use elbowroom_scene::Selection;

use crate::hand_over::HandOverPhase;
use crate::holding::attachment;
use crate::{HandedOver, VirtualRobot};

/// Largest difference (rad or m) of a joint from the pre-grasp at which the hand begins to move with the work-piece.
const AT_PRE_GRASP: f64 = 2e-3;
/// Largest difference (rad or m) from the exact place at which a hand holds.
const EXACT: f64 = 1e-9;
/// Time after which a receiver that does not get to its pre-grasp gives up, s.
const REACHING_S: f64 = 8.0;
/// Time without progress after which a receiver that approaches gives up, s.
const STUCK_S: f64 = 1.0;
/// Time without progress after which a hand that leaves need not reach its pre-grasp, s.
const LEAVING_S: f64 = 0.2;
/// Distance from the work-piece at which it has left then, m.
const LEFT_M: f64 = 1e-3;

impl VirtualRobot<'_> {
    /// Goes on with the hand-over. Returns it in the step in which the receiver takes the work-piece.
    pub(crate) fn proceed(&mut self, dt_s: f64) -> Option<HandedOver> {
        let hand_over = self.hand_over.as_mut()?;
        hand_over.since_s += dt_s;
        let (phase, since_s, receiver) = (hand_over.phase, hand_over.since_s, hand_over.receiver);
        let length_m = |k: usize| self.holdings[k].grasp.length_m();
        match phase {
            HandOverPhase::Reaching => self.reach(since_s),
            HandOverPhase::Approaching if hand_over.before_m == 0.0 => hand_over.enter(HandOverPhase::Closing),
            HandOverPhase::Approaching if hand_over.stuck_s > STUCK_S => hand_over.enter(HandOverPhase::Withdrawing),
            HandOverPhase::Closing => {
                let is_exact = hand_over.residual.iter().all(|r| r.abs() < EXACT);
                if since_s >= self.settings.settle_s && is_exact {
                    return self.hand_over();
                }
            }
            HandOverPhase::Opening if since_s >= self.settings.settle_s => hand_over.enter(HandOverPhase::Retreating),
            HandOverPhase::Retreating => {
                let giver = hand_over.giver;
                if hand_over.before_m >= length_m(giver) || self.leaves_early(giver) {
                    self.hand_over = None;
                    self.allow_visit(None);
                    self.release(giver);
                }
            }
            HandOverPhase::Withdrawing if hand_over.before_m >= length_m(receiver) || self.leaves_early(receiver) => {
                self.give_up();
            }
            _ => {}
        }
        None
    }

    /// The receiver moves to its pre-grasp; near it, it begins to move with the work-piece.
    fn reach(&mut self, since_s: f64) {
        let Some(hand_over) = &mut self.hand_over else { return };
        let (k, member) = (hand_over.receiver, self.holdings[hand_over.receiver].member);
        let (forecast, arm) = (&self.forecasts[k], &self.arms[member]);
        if forecast.grasped.is_none() || since_s > REACHING_S {
            return self.give_up();
        }
        let drift = &self.limbs[member].drift;
        let there = arm.state.q.iter().zip(&forecast.pre_grasp).all(|(q, wanted)| (q - wanted).abs() < AT_PRE_GRASP);
        let mut relative = arm.state.qd.iter().zip(drift).zip(&self.members[member].limits);
        if !(there && relative.all(|((qd, drift), l)| (qd - drift).abs() < 0.05 * l.velocity)) {
            return;
        }
        let ahead = &mut self.carried.follower_ahead;
        if !hand_over.looks_ahead {
            let holding = &mut self.holdings[k];
            let (mut grasped, tool_in_part) = (forecast.pre_grasp.clone(), holding.grasp.tool_in_part);
            if !holding.solve(&self.carried.path.at(self.carried.path_s), &tool_in_part, &mut grasped) {
                return self.give_up();
            }
            ahead.restart(&grasped, self.carried.path_s);
            hand_over.looks_ahead = true;
            return;
        }
        if ahead.limit.is_some() {
            return self.give_up();
        }
        if ahead.is_ready(&self.carried.path, self.carried.path_s, &self.settings) {
            for ((residual, q), exact) in hand_over.residual.iter_mut().zip(&arm.state.q).zip(&forecast.pre_grasp) {
                *residual = q - exact;
            }
            hand_over.looks_ahead = false;
            hand_over.enter(HandOverPhase::Approaching);
            self.allow_visit(Some(member));
        }
    }

    /// Whether a hand that cannot go back any further to its pre-grasp has left the work-piece; then its arm is free to find
    /// another way.
    fn leaves_early(&mut self, k: usize) -> bool {
        let member = self.holdings[k].member;
        let Some(hand_over) = self.hand_over.as_mut().filter(|h| h.stuck_s > LEAVING_S && h.before_m > 0.0) else {
            return false;
        };
        hand_over.stuck_s = 0.0;
        // Only then does its distance count.
        self.allow_visit(None);
        let (robot, part) = (self.members[member].robot, Selection::Object(self.work_piece));
        let has_left = self.members[member].hand.iter().all(|&link| {
            let hand = Selection::Link { robot, link };
            self.checker.between(hand, part).within(&self.state, LEFT_M).is_none()
        });
        if !has_left {
            self.allow_visit(Some(member));
        }
        has_left
    }

    /// The receiver takes the work-piece.
    fn hand_over(&mut self) -> Option<HandedOver> {
        let hand_over = self.hand_over.as_mut()?;
        let (from, to) = (hand_over.giver, hand_over.receiver);
        hand_over.enter(HandOverPhase::Opening);
        hand_over.residual.clear();
        let (giver, receiver) = (self.holdings[from].member, self.holdings[to].member);
        hand_over.residual.resize(self.members[giver].limits.len(), 0.0);
        let mut held = attachment(&self.members[receiver], &self.holdings[to].grasp.tool_in_part);
        held.visiting_links = self.hand_of(giver);
        // Both robots and the object were accepted before.
        let _ = self.state.detach(self.scene, self.work_piece);
        let _ = self.state.attach_at(self.scene, self.work_piece, held);
        let carried = &mut self.carried;
        carried.holder = to;
        std::mem::swap(&mut carried.ahead, &mut carried.follower_ahead);
        for k in [from, to] {
            self.forecasts[k].restart();
        }
        self.decision.handed_over();
        Some(HandedOver { from: giver, to: receiver, reason: self.decision.reason? })
    }

    /// The receiver does not take the work-piece.
    fn give_up(&mut self) {
        let Some(hand_over) = self.hand_over.take() else { return };
        self.allow_visit(None);
        self.decision.refuse(hand_over.receiver);
    }

    /// The giver is free: the next time it takes the work-piece in its own grasp, not as it held it at the start.
    fn release(&mut self, giver: usize) {
        // It was accepted before.
        let _ = self.holdings[giver].regrasp_exactly(self.work_piece);
        self.forecasts[giver].restart();
    }

    /// Lets the hand of one more arm touch the work-piece, or of none.
    fn allow_visit(&mut self, member: Option<usize>) {
        let visiting_links = member.map_or_else(Vec::new, |m| self.hand_of(m));
        let Some(mut held) = self.state.attachment(self.work_piece).cloned() else { return };
        held.visiting_links = visiting_links;
        // It was accepted before, with other visitors.
        let _ = self.state.detach(self.scene, self.work_piece);
        let _ = self.state.attach_at(self.scene, self.work_piece, held);
    }

    fn hand_of(&self, member: usize) -> Vec<(RobotId, LinkId)> {
        let arm = &self.members[member];
        arm.hand.iter().map(|link| (arm.robot, *link)).collect()
    }
}
