//! What a volume near a region may do: the laws applied to one pair.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::escape;
use elbowroom_spatial::Vec3;

use crate::gaps::{Pair, PairLaw};
use crate::laws::{braking_factor, deceleration_left, speed_zone, stopping_factor, time_to_close, warning_factor};
use crate::placement::{Placement, region_point_motion};
use crate::{Configuration, Kind, Snapshot};

/// How far (s) the direction-aware law looks along the program's intent.
pub(crate) const LOOKAHEAD_S: f64 = 0.01;
/// The stopping law aims this far (m) short of the border, so that rounding never ends inside.
const STOP_SHORT_M: f64 = 5e-4;
/// Accelerations are taken this much larger than they are now: they may grow while the robot brakes.
const ACCELERATION_MARGIN: f64 = 1.2;
/// Joints slower than this (rad/s, m/s) are at rest where nothing is known of how they brake.
const AT_REST: f64 = 1e-3;
/// A gap must grow by at least this speed (m/s) to count as growing.
const LEAVING_SPEED: f64 = 5e-4;

/// The laws at one instant.
pub(crate) struct Judge<'a> {
    pub(crate) config: &'a Configuration,
    pub(crate) snapshot: &'a Snapshot<'a>,
    pub(crate) now: &'a Placement,
    /// Everything a moment later, where the direction matters.
    pub(crate) soon: Option<&'a Placement>,
    /// The chain at the program's own speed, where that speed is needed.
    pub(crate) intent: Option<&'a ChainState>,
    /// How fast the override can fall, 1/s.
    pub(crate) deceleration: f64,
    /// The override asked for in the last tick: what the robot may still be doing.
    pub(crate) last_override: f64,
}

impl Judge<'_> {
    /// How fast the override can fall without asking more of a joint than it can give, 1/s.
    pub(crate) fn override_deceleration(config: &Configuration, intent: &ChainState) -> f64 {
        let stopping = config.laws.stopping_distance.as_ref();
        stopping.map_or(f64::INFINITY, |s| deceleration_left(&intent.qd, &intent.qdd, &s.joint_deceleration))
    }

    fn forbidden(&self, pair: &Pair) -> f64 {
        let v0 = self.snapshot.programmed_override;
        let region = &self.config.regions[pair.region];
        let d = pair.separation.distance;
        let held = (v0 * warning_factor(d, region.warning_m)).min(self.stopping(pair));
        if self.soon.is_none() || held >= v0 {
            return held.min(v0);
        }
        match self.is_leaving(pair) {
            false => held,
            true if d > 0.0 => v0,
            true => v0 * self.config.laws.recovery,
        }
    }

    /// The override from which a stop still ends before the region.
    fn stopping(&self, pair: &Pair) -> f64 {
        let (Some(stopping), Some(intent)) = (&self.config.laws.stopping_distance, self.intent) else {
            return f64::INFINITY;
        };
        let s = &pair.separation;
        if Self::is_still(intent) {
            return f64::INFINITY;
        }
        let Some(towards) = (s.on_b - s.on_a).try_normalize() else { return 0.0 };
        let region = &self.config.regions[pair.region];
        let (region_velocity, _) = region_point_motion(region, self.snapshot.sources, s.on_b);
        let approach = (-region_velocity.dot(towards)).max(0.0);
        let reaction_s = stopping.reaction_s;
        let left = s.distance - STOP_SHORT_M - approach * (reaction_s + self.braking_s());
        let at_full = self.closing_speed(pair, intent, towards);
        // A path that bends towards the region closes faster and faster.
        let bend = ACCELERATION_MARGIN * boxed_acceleration(self, intent, pair.volume);
        // Until it obeys, the robot goes on as it does now, or as it was last told to.
        let now = self.closing_speed(pair, &self.now.chain, towards).max(at_full * self.last_override);
        let moved_s = self.last_override * reaction_s;
        let left_then = left - now.max(0.0) * reaction_s - 0.5 * bend * moved_s * moved_s;
        let time_s = time_to_close(left, at_full, bend);
        let time_then_s = time_to_close(left_then, at_full, bend);
        stopping_factor(time_s, 1.0, self.deceleration, reaction_s).min(braking_factor(
            time_then_s,
            1.0,
            self.deceleration,
        ))
    }

    /// True where the robot ends outside the region if it is told override 0 from this tick on: by the stopping law, or,
    /// where no deceleration is stated, because it is at rest.
    fn can_stop_outside(&self, pair: &Pair) -> bool {
        if pair.separation.distance <= 0.0 {
            return false;
        }
        match (&self.config.laws.stopping_distance, self.intent) {
            (Some(stopping), Some(intent)) if !Self::is_still(intent) => {
                let (s, region) = (&pair.separation, &self.config.regions[pair.region]);
                let Some(towards) = (s.on_b - s.on_a).try_normalize() else { return false };
                let (region_velocity, _) = region_point_motion(region, self.snapshot.sources, s.on_b);
                let approach = (-region_velocity.dot(towards)).max(0.0);
                let left = s.distance - approach * (stopping.reaction_s + self.braking_s());
                let at_full = self.closing_speed(pair, intent, towards);
                let bend = ACCELERATION_MARGIN * boxed_acceleration(self, intent, pair.volume);
                let rate = self.rate(intent);
                let now = self.closing_speed(pair, &self.now.chain, towards).max(at_full * rate);
                let moved_s = rate * stopping.reaction_s;
                let left_then = left - now.max(0.0) * stopping.reaction_s - 0.5 * bend * moved_s * moved_s;
                let time_s = time_to_close(left_then, at_full, bend);
                left_then > 0.0 && braking_factor(time_s, 1.0, self.deceleration) >= rate
            }
            _ => self.is_at_rest(pair),
        }
    }

    /// How fast the program's time runs: as last told, or faster where the joints still are.
    fn rate(&self, intent: &ChainState) -> f64 {
        let real = self.now.chain.qd.iter().zip(&intent.qd).filter(|(_, v)| **v != 0.0);
        real.map(|(real, full)| (real / full).abs()).fold(self.last_override, |rate, r| rate.max(r.min(1.0)))
    }

    /// True where neither the joints nor the region move, nor are about to.
    fn is_at_rest(&self, pair: &Pair) -> bool {
        let told = |v: &f64| (v * self.last_override).abs() <= AT_REST;
        let region = &self.config.regions[pair.region];
        let (region_velocity, _) = region_point_motion(region, self.snapshot.sources, pair.separation.on_b);
        self.now.chain.qd.iter().all(|v| v.abs() <= AT_REST)
            && self.snapshot.intent.is_none_or(|intent| intent.iter().all(told))
            && region_velocity.length() <= AT_REST
    }

    /// From full override to rest, s.
    fn braking_s(&self) -> f64 {
        if self.deceleration.is_finite() { 1.0 / self.deceleration } else { 0.0 }
    }

    fn is_still(intent: &ChainState) -> bool {
        intent.qd.iter().all(|v| *v == 0.0)
    }

    /// Largest speed (m/s) with which any point of the volume moves along `towards` when the chain moves as in `state`.
    /// A rigid body's velocity field is linear, so a support point of the volume has it.
    fn closing_speed(&self, pair: &Pair, state: &ChainState, towards: Vec3) -> f64 {
        let volume = &self.config.volumes[pair.volume];
        let base = &self.config.base_in_world;
        let motion = state.link_motion(volume.link);
        let link_in_world = *base * state.link_in_root(volume.link);
        let velocity = base.transform_vector(motion.velocity);
        let turning = base.transform_vector(motion.angular_velocity);
        let lever = towards.cross(turning);
        let in_world = &self.now.volume_in_world[pair.volume];
        let farthest = in_world.transform_point(volume.shape.support(in_world.inverse_transform_vector(lever)));
        velocity.dot(towards) - lever.dot(link_in_world.translation - farthest)
    }

    /// True where the gap of this pair grows, now and over the next moment, in the direction the program asks for,
    /// and does not shrink by what the robot really does. A gap that shrinks never clears an alarm.
    fn is_leaving(&self, pair: &Pair) -> bool {
        let (Some(soon), Some(intent)) = (self.soon, self.intent) else { return false };
        let (v, r) = (pair.volume, pair.region);
        let (volume, region) = (&self.config.volumes[v].shape, &self.config.regions[r].shape);
        let (volume_soon, region_soon) = (&soon.volume_in_world[v], &soon.region_in_world[r]);
        let least = LEAVING_SPEED * LOOKAHEAD_S;
        let away = (pair.separation.on_a - pair.separation.on_b).try_normalize();
        let Some(away) = away.filter(|_| pair.separation.distance > 0.0) else {
            let Some(out) = escape(volume, &self.now.volume_in_world[v], region, &self.now.region_in_world[r]) else {
                return false;
            };
            if let Some(out_soon) = escape(volume, volume_soon, region, region_soon) {
                return out_soon.depth + least < out.depth;
            }
            // At the border there is no depth left to shrink; and whoever is out soon may be so behind a thin plate.
            let gap = (least - out.depth).max(0.0);
            return self.moves_along(pair, intent, out.direction)
                && !elbowroom_proximity::within(volume, volume_soon, region, region_soon, gap);
        };
        self.moves_along(pair, intent, away)
            && !elbowroom_proximity::within(volume, volume_soon, region, region_soon, pair.separation.distance + least)
    }

    /// True where the program wants to leave the region in this direction, and the robot does not really move against it.
    fn moves_along(&self, pair: &Pair, intent: &ChainState, away: Vec3) -> bool {
        let (v, r) = (pair.volume, pair.region);
        let region_velocity =
            region_point_motion(&self.config.regions[r], self.snapshot.sources, pair.separation.on_b).0;
        let intended = self.velocity_of(intent, v, pair.separation.on_a) - region_velocity;
        let real = self.now.point_motion(self.config, v, pair.separation.on_a).0 - region_velocity;
        intended.dot(away) > LEAVING_SPEED && real.dot(away) >= 0.0
    }

    fn velocity_of(&self, state: &ChainState, volume: usize, point: Vec3) -> Vec3 {
        let base = &self.config.base_in_world;
        let link = self.config.volumes[volume].link;
        let origin = base.transform_point(state.link_in_root(link).translation);
        let offset = base.inverse_transform_vector(point - origin);
        base.transform_vector(state.link_motion(link).velocity_at(offset))
    }
}

impl PairLaw for Judge<'_> {
    fn asks(&self, pair: &Pair) -> f64 {
        let v0 = self.snapshot.programmed_override;
        let region = &self.config.regions[pair.region];
        match region.kind {
            Kind::Forbidden | Kind::Exchange { .. } => self.forbidden(pair),
            Kind::Monitored { slow_to: None } => v0,
            Kind::Monitored { slow_to: Some(slow) } => speed_zone(pair.separation.distance, region.warning_m, slow, v0),
        }
    }

    fn stops_outside(&self, pair: &Pair) -> bool {
        self.can_stop_outside(pair)
    }

    fn extra_reach(&self, volume: usize) -> f64 {
        let (Some(stopping), Some(intent)) = (&self.config.laws.stopping_distance, self.intent) else { return 0.0 };
        let boxed = &self.now.volume_box[volume];
        let fastest = boxed_speed(self, intent, volume, boxed.center()) + region_speed(self.snapshot);
        let stop_s = stopping.reaction_s + self.braking_s();
        (fastest + 0.5 * ACCELERATION_MARGIN * boxed_acceleration(self, intent, volume) * stop_s) * stop_s
    }

    fn only_closest_matters(&self) -> bool {
        self.soon.is_none() && self.intent.is_none()
    }
}

/// Bound on the speed of every point of a volume at override 1, m/s.
fn boxed_speed(judge: &Judge, intent: &ChainState, volume: usize, center: Vec3) -> f64 {
    let link = judge.config.volumes[volume].link;
    let radius = judge.now.volume_box[volume].extent().length() * 0.5;
    judge.velocity_of(intent, volume, center).length() + intent.link_motion(link).angular_velocity.length() * radius
}

/// Bound on the acceleration of every point of a volume at override 1, m/s².
fn boxed_acceleration(judge: &Judge, intent: &ChainState, volume: usize) -> f64 {
    let link = judge.config.volumes[volume].link;
    let boxed = &judge.now.volume_box[volume];
    let base = &judge.config.base_in_world;
    let motion = intent.link_motion(link);
    let origin = base.transform_point(intent.link_in_root(link).translation);
    let offset = base.inverse_transform_vector(boxed.center() - origin);
    let turning = motion.angular_velocity.length_squared() + motion.angular_acceleration.length();
    motion.acceleration_at(offset).length() + turning * boxed.extent().length() * 0.5
}

/// Speed of the fastest source, m/s; regions are near their sources, so their turning is left to the warning zone.
fn region_speed(snapshot: &Snapshot) -> f64 {
    snapshot.sources.iter().fold(0.0, |v, s| s.motion.velocity.length().max(v))
}
