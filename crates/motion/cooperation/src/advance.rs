//! One step of the motion: the work-piece goes on as far as every arm that carries it can, the others keep away.

use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Selection, SweepHit, SweepMove, SweepOptions};

use crate::hand_over::HandOver;
use crate::virtual_robot::usable;
use crate::{Hold, HoldLimit, VirtualRobot};

/// Shares of a step that are tried until one is possible: of the motion of the work-piece, and of the motion of a hand
/// that approaches or leaves it.
const ATTEMPTS: [(f64, f64); 9] =
    [(1.0, 1.0), (1.0, 0.3), (1.0, 0.0), (0.5, 0.3), (0.25, 0.3), (0.1, 0.1), (0.0, 1.0), (0.0, 0.2), (0.0, 0.04)];
/// Override or rate below which the work-piece stands instead of creeping.
pub(crate) const LEAST_RATE: f64 = 1e-3;
/// Time in which a hand that begins to move with the work-piece comes to its exact place, s.
const ALIGNMENT_S: f64 = 0.05;
/// Share of the joint speeds that the arms that carry the work-piece may use.
const SPEED_SHARE: f64 = 0.999;
/// Most arms of a virtual robot in one sweep.
const MOST_ARMS: usize = 8;

impl VirtualRobot<'_> {
    /// Looks ahead along the path: what the arms that carry the work-piece can do, and who is in the way.
    pub(crate) fn look_ahead(&mut self, dt_s: f64) {
        let has_receiver = self.has_receiver();
        let Self { holdings, carried, settings, hand_over, .. } = self;
        let holder = &mut holdings[carried.holder];
        carried.ahead.extend(holder, &carried.path, carried.path_s, (settings, has_receiver, dt_s));
        let arriving = hand_over.as_ref().filter(|h| h.looks_ahead).map(|h| h.receiver);
        if let Some(follower) = hand_over.as_ref().and_then(HandOver::follower).or(arriving) {
            carried.follower_ahead.extend(
                &mut holdings[follower],
                &carried.path,
                carried.path_s,
                (settings, true, dt_s),
            );
        }
        self.watch_members();
    }

    /// Finds the members that are in the way of the holder where it will be. A free one moves away; one that carries the
    /// work-piece too must first let go or take over.
    fn watch_members(&mut self) {
        let holder = self.holder();
        let robot = self.members[holder].robot;
        self.state_ahead.clone_from(&self.state);
        let mut is_placed = self.state_ahead.set_q(self.scene, robot, &self.carried.ahead.q).is_ok();
        if let Some(follower) = self.hand_over.as_ref().and_then(HandOver::follower) {
            let robot = self.members[self.holdings[follower].member].robot;
            is_placed &= self.state_ahead.set_q(self.scene, robot, &self.carried.follower_ahead.q).is_ok();
        }
        for member in 0..self.members.len() {
            let pair = (Selection::Robot(robot), Selection::Robot(self.members[member].robot));
            self.limbs[member].is_in_the_way = member != holder
                && is_placed
                && self.checker.between(pair.0, pair.1).within(&self.state_ahead, 0.5 * self.settings.gap_m).is_some();
        }
    }

    /// Path time that the work-piece may still use, s.
    fn room_s(&self) -> f64 {
        let carried = &self.carried;
        let mut room_s = carried.ahead.free_to_s - carried.path_s;
        if self.hand_over.as_ref().is_some_and(|h| h.follower().is_some()) {
            room_s = room_s.min(carried.follower_ahead.free_to_s - carried.path_s);
        }
        if self.must_wait() {
            room_s = room_s.min(0.5 * carried.rate * carried.rate * self.settings.ramp_s);
        }
        room_s
    }

    /// Whether the work-piece slows down until another arm is away, or a pose is desired again.
    fn must_wait(&self) -> bool {
        self.carried.is_paused || self.limbs.iter().any(|limb| limb.is_in_the_way)
    }

    /// Share of the desired speed that the joints of the arms that carry the work-piece can go.
    fn joint_rate(&mut self) -> f64 {
        let Self { carried, settings, hand_over, .. } = self;
        let mut rate = carried.ahead.rate(carried.path_s, settings);
        if hand_over.as_ref().is_some_and(|h| h.follower().is_some()) {
            rate = rate.min(carried.follower_ahead.rate(carried.path_s, settings));
        }
        rate
    }

    /// Moves all arms for `dt_s` seconds. Returns what keeps the work-piece from going on as fast as it wants.
    pub(crate) fn advance(&mut self, dt_s: f64, overrides: &[f64]) -> Option<Hold> {
        let carriers = (0..self.members.len()).filter(|m| self.carries(*m));
        let allowed = carriers.map(|m| usable(overrides[m])).fold(1.0, f64::min);
        let fastest = self.joint_rate().min(allowed);
        let wanted = self.carried.next_rate(self.room_s(), fastest, dt_s, &self.settings);
        let is_halted = allowed < LEAST_RATE || self.must_wait();
        let wanted = if wanted < LEAST_RATE && is_halted { 0.0 } else { wanted };
        let mut hold = if allowed < LEAST_RATE { Some(Hold::Override) } else { self.limit_ahead() };
        self.react(dt_s, overrides);
        let has_follower = self.hand_over.as_ref().is_some_and(|h| h.follower().is_some());
        let mut before = None;
        for (of_rate, of_hand) in ATTEMPTS {
            let (rate, hand) = (wanted * of_rate, if has_follower { allowed * of_hand } else { 0.0 });
            // The same motion would fail again.
            if before.replace((rate, hand)) == Some((rate, hand)) {
                continue;
            }
            let tried = self.carry(rate, hand, dt_s).and_then(|before_m| self.sweep().map(|()| before_m));
            match tried {
                Ok(before_m) => {
                    self.commit(rate, before_m, dt_s);
                    self.align(hand, dt_s);
                    return hold;
                }
                Err(why) => hold = Some(why),
            }
        }
        // Not even the hand that approaches or leaves can move.
        self.carry_nothing();
        if self.sweep().is_ok() {
            let before_m = self.hand_over.as_ref().map_or(0.0, |h| h.before_m);
            self.commit(0.0, before_m, dt_s);
        } else {
            self.stand();
            self.hand_over.iter_mut().for_each(|h| h.stuck_s += dt_s);
        }
        hold
    }

    /// What the arms that carry the work-piece come to ahead.
    fn limit_ahead(&self) -> Option<Hold> {
        if self.carried.is_paused {
            return Some(Hold::Paused);
        }
        let in_the_way = self.limbs.iter().position(|limb| limb.is_in_the_way);
        if let Some(member) = in_the_way {
            return Some(Hold::InTheWay(member));
        }
        let of_holder = self.carried.ahead.limit.map(|limit| Hold::Limit(self.holder(), limit));
        let follower = self.hand_over.as_ref().and_then(HandOver::follower).map(|k| self.holdings[k].member);
        of_holder.or_else(|| Some(Hold::Limit(follower?, self.carried.follower_ahead.limit?)))
    }

    /// Joint values of the arms that carry the work-piece, after `dt_s` seconds at a rate; a hand that approaches or leaves
    /// moves with the share `hand` of its speed. Returns the distance of that hand from its grasp then (m).
    pub(crate) fn carry(&mut self, rate: f64, hand: f64, dt_s: f64) -> Result<f64, Hold> {
        let part_in_world = self.carried.path.at(self.carried.path_s + rate * dt_s);
        let holder = self.holder();
        let (limb, arm) = (&mut self.limbs[holder], &self.arms[holder]);
        limb.next.copy_from_slice(&arm.state.q);
        if rate > 0.0 {
            let holding = &mut self.holdings[self.carried.holder];
            let tool_in_part = holding.grasp.tool_in_part;
            if !holding.solve(&part_in_world, &tool_in_part, &mut limb.next) {
                return Err(Hold::Limit(holder, HoldLimit::Reach));
            }
            self.within_speed(holder, dt_s)?;
        }
        let Some((k, hand_over)) = self.hand_over.as_ref().and_then(|h| Some((h.follower()?, h))) else {
            return Ok(0.0);
        };
        let member = self.holdings[k].member;
        let grasp = self.holdings[k].grasp;
        let is_aligned = hand_over.residual.iter().all(|r| r.abs() < 1e-6);
        let speed_m_s = if is_aligned { self.settings.approach_m_s * hand } else { 0.0 };
        let before_m = hand_over.before_next_m(grasp.length_m(), speed_m_s, dt_s);
        let fade = fade(hand, dt_s);
        let limb = &mut self.limbs[member];
        for ((next, q), residual) in limb.next.iter_mut().zip(&self.arms[member].state.q).zip(&hand_over.residual) {
            *next = q - residual;
        }
        if !self.holdings[k].solve(&part_in_world, &grasp.at(before_m), &mut limb.next) {
            return Err(Hold::Limit(member, HoldLimit::Reach));
        }
        limb.next.iter_mut().zip(&hand_over.residual).for_each(|(next, residual)| *next += residual * fade);
        self.within_speed(member, dt_s)?;
        Ok(before_m)
    }

    /// The arms that carry the work-piece stand.
    fn carry_nothing(&mut self) {
        for member in 0..self.members.len() {
            if self.carries(member) {
                self.limbs[member].next.copy_from_slice(&self.arms[member].state.q);
            }
        }
    }

    fn within_speed(&self, member: usize, dt_s: f64) -> Result<(), Hold> {
        let (next, q) = (&self.limbs[member].next, &self.arms[member].state.q);
        let limits = &self.members[member].limits;
        let is_too_fast = |((to, from), l): ((&f64, &f64), &elbowroom_kinematics::JointLimits)| {
            (to - from).abs() > SPEED_SHARE * l.velocity * dt_s
        };
        let joint = next.iter().zip(q).zip(limits).position(is_too_fast);
        joint.map_or(Ok(()), |joint| Err(Hold::Limit(member, HoldLimit::JointSpeed(joint))))
    }

    /// Proves the step free. Free arms that would touch something stand instead.
    fn sweep(&mut self) -> Result<(), Hold> {
        loop {
            let Some(hit) = self.first_hit()? else { return Ok(()) };
            let free = [hit.a, hit.b].into_iter().find_map(|id| self.free_and_moving(id));
            let Some(member) = free else { return Err(Hold::Contact(hit.a, hit.b)) };
            let limb = &mut self.limbs[member];
            limb.next.copy_from_slice(&self.arms[member].state.q);
            limb.free.gives_way();
        }
    }

    /// The first contact of an arm that moves.
    fn first_hit(&mut self) -> Result<Option<SweepHit>, Hold> {
        let idle = SweepMove::Robot { robot: RobotId(0), to: &[] };
        let mut moves = [idle; MOST_ARMS];
        let mut count = 0;
        for (limb, arm) in self.limbs.iter().zip(&self.arms) {
            if limb.next == arm.state.q {
                continue;
            }
            let Some(slot) = moves.get_mut(count) else { return Err(Hold::Unproven) };
            *slot = SweepMove::Robot { robot: arm.robot, to: &limb.next };
            count += 1;
        }
        let options = SweepOptions { tolerance_m: 1e-5, moving_only: true, ..SweepOptions::default() };
        self.checker.sweep(&self.state, &moves[..count], &options).map_err(|_| Hold::Unproven)
    }

    /// The free arm that moves this geometry in this step.
    fn free_and_moving(&self, id: GeometryId) -> Option<usize> {
        let GeometryId::Link { robot, .. } = id else { return None };
        let member = self.members.iter().position(|m| m.robot == robot)?;
        let moves = self.limbs[member].next != self.arms[member].state.q;
        (moves && !self.carries(member)).then_some(member)
    }

    /// The hand that approaches or leaves has come nearer to its exact place.
    fn align(&mut self, hand: f64, dt_s: f64) {
        let Some(hand_over) = self.hand_over.as_mut().filter(|h| h.follower().is_some()) else { return };
        let fade = fade(hand, dt_s);
        hand_over.residual.iter_mut().for_each(|r| *r *= fade);
    }

    /// Executes the step.
    fn commit(&mut self, rate: f64, before_m: f64, dt_s: f64) {
        for (limb, arm) in self.limbs.iter().zip(&mut self.arms) {
            for ((qd, to), from) in arm.state.qd.iter_mut().zip(&limb.next).zip(&arm.state.q) {
                *qd = (to - from) / dt_s;
            }
            arm.state.q.copy_from_slice(&limb.next);
            self.scene.robots()[arm.robot.0].robot.chain.forward_motion(&mut arm.state);
            // The sweep has accepted these values.
            let _ = self.state.set_q(self.scene, arm.robot, &limb.next);
        }
        self.carried.path_s += rate * dt_s;
        self.carried.rate = rate;
        let Some(hand_over) = &mut self.hand_over else { return };
        let is_still = rate == 0.0 && hand_over.before_m == before_m;
        if hand_over.follower().is_some() {
            hand_over.before_m = before_m;
        }
        hand_over.stuck_s = if is_still { hand_over.stuck_s + dt_s } else { 0.0 };
    }
}

/// Share of its distance from the exact place that a hand still has after `dt_s` seconds at a share of its speed.
fn fade(hand: f64, dt_s: f64) -> f64 {
    (-dt_s * hand / ALIGNMENT_S).exp()
}
