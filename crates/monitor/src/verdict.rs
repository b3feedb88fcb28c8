//! What a volume near a region may do: the laws applied to one pair.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Aabb, Vec3};

use crate::gaps::{Asked, Pair, PairLaw};
use crate::laws::{Stopping, speed_zone, warning_factor};
use crate::placement::{Placement, region_point_motion};
use crate::recovery::leads_out;
use crate::stopping::{Gap, StoppingLaw};
use crate::{Configuration, Kind, Snapshot, Source};

/// How far (s) the direction-aware law looks along the program's intent.
pub(crate) const LOOKAHEAD_S: f64 = 0.01;
/// The stopping law aims this far (m) short of the border, so that rounding never ends inside.
const STOP_SHORT_M: f64 = 5e-4;
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
    /// The override asked for in the last tick: what the robot may still be doing.
    pub(crate) last_override: f64,
    /// The stopping-distance law, where that is on.
    pub(crate) stopping: Option<(&'a Stopping, &'a StoppingLaw)>,
    /// No point of any region is faster, m/s.
    pub(crate) region_speed_m_s: f64,
}

/// Which way a pair goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Course {
    /// Nearer, or not known to be going away.
    Approaching,
    /// The gap grows.
    Leaving,
    /// It is inside, and the program leads out.
    Recovering,
}

impl Judge<'_> {
    fn forbidden(&self, pair: &Pair, so_far: f64) -> Asked {
        let v0 = self.snapshot.programmed_override;
        let warned = v0 * warning_factor(pair.separation.distance, self.config.regions[pair.region].warning_m);
        // What a warning zone or another pair asks for is proven to be slow enough more quickly than the limit is found. Where
        // the override falls at a limited rate it may be above what the zone asks for: then the limit itself counts.
        let most = if self.config.laws.override_rate > 0.0 { v0 } else { warned.min(so_far) };
        let law = self.stopping.map(|(stopping, law)| (stopping, law, self.gap(pair, stopping, law)));
        let limit = |short_m: f64, most: f64| match &law {
            None => most,
            Some((stopping, law, gap)) => gap.map_or(0.0, |gap| law.limit(stopping, &gap.shorter(short_m), most)),
        };
        let held = match limit(STOP_SHORT_M, most) {
            stopping if stopping < most => Asked { speed_override: stopping.min(warned), at_once: stopping },
            _ => Asked::gently(warned, v0),
        };
        if self.soon.is_none() || held.speed_override >= v0.min(so_far) {
            return held;
        }
        match self.course(pair) {
            Course::Approaching => held,
            Course::Leaving => {
                let most = v0.min(so_far);
                let stopping = limit(0.0, most);
                Asked::at_once(if stopping < most { stopping } else { v0 })
            }
            Course::Recovering => Asked::at_once(v0 * self.config.laws.recovery),
        }
    }

    /// The pair as the stopping-distance law sees it; `None` on contact.
    fn gap(&self, pair: &Pair, stopping: &Stopping, law: &StoppingLaw) -> Option<Gap> {
        let s = &pair.separation;
        let left_m = s.lower_bound.min(s.distance);
        if !(left_m > 0.0) {
            return None;
        }
        let (volume, region) = (pair.volume, &self.config.regions[pair.region]);
        // Between convex solids stands a plane: only motion across it counts. Others are approached from any side.
        let convex = |shape: &Shape| !matches!(shape, Shape::Mesh(_));
        if !(convex(&self.config.volumes[volume].shape) && convex(&region.shape)) {
            let approach = law.approach_anywhere(volume);
            return Some(Gap { volume, approach, left_m, region_speed: self.region_speed(pair) });
        }
        let towards = (s.on_b - s.on_a).try_normalize()?;
        let region_speed = self.region_closing_speed(pair, towards);
        if region_speed == 0.0 && law.is_out_of_reach(volume, left_m - STOP_SHORT_M) {
            return Some(Gap { volume, approach: law.approach_anywhere(volume), left_m, region_speed });
        }
        let program_speed = self.closing_speed(pair, self.intent?, towards);
        // What the robot really does only counts where the program is not known.
        let real_speed = if law.program_is_known() { 0.0 } else { self.closing_speed(pair, &self.now.chain, towards) };
        let approach = law.approach(stopping, volume, towards, [program_speed, real_speed]);
        Some(Gap { volume, approach, left_m, region_speed })
    }

    /// How fast (m/s) the region comes nearer against `towards` by its own motion; never negative.
    fn region_closing_speed(&self, pair: &Pair, towards: Vec3) -> f64 {
        let region = &self.config.regions[pair.region];
        let Some(source) = region.follow.and_then(|s| self.snapshot.sources.get(s.0)) else { return 0.0 };
        let turning = source.motion.angular_velocity;
        let (at, in_world) = (pair.separation.on_b, &self.now.region_in_world[pair.region]);
        if matches!(region.shape, Shape::HalfSpace(_)) {
            // Of a plane only what lies across from the volume counts.
            let across = self.now.volume_box[pair.volume].extent().length() + pair.separation.distance;
            let speed = source.motion.velocity_at(at - source.pose.translation).dot(-towards);
            return (speed + turning.length() * across).max(0.0);
        }
        let lever = (-towards).cross(turning);
        let farthest = in_world.transform_point(region.shape.support(in_world.inverse_transform_vector(lever)));
        source.motion.velocity_at(farthest - source.pose.translation).dot(-towards).max(0.0)
    }

    /// No point of the region moves faster, m/s.
    fn region_speed(&self, pair: &Pair) -> f64 {
        let Some(source) = self.config.regions[pair.region].follow.and_then(|s| self.snapshot.sources.get(s.0)) else {
            return 0.0;
        };
        let boxed = &self.now.region_box[pair.region];
        if !boxed.extent().is_finite() {
            let towards = (pair.separation.on_b - pair.separation.on_a).try_normalize();
            return towards.map_or(f64::INFINITY, |towards| self.region_closing_speed(pair, towards));
        }
        let center = source.motion.velocity_at(boxed.center() - source.pose.translation);
        center.length() + source.motion.angular_velocity.length() * 0.5 * boxed.extent().length()
    }

    /// True where the robot ends outside the region if it is told override 0 from this tick on: by the stopping-distance law,
    /// or, where no deceleration is stated, because it is at rest.
    fn can_stop_outside(&self, pair: &Pair) -> bool {
        if pair.separation.distance <= 0.0 {
            return false;
        }
        let Some((stopping, law)) = self.stopping else { return self.is_at_rest(pair) };
        self.gap(pair, stopping, law).is_some_and(|gap| law.stops_outside(stopping, &gap))
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

    /// Leaving: the gap of this pair grows, now and over the next moment, in the direction the program asks for, and does not
    /// shrink by what the robot really does. A gap that shrinks never clears an alarm.
    fn course(&self, pair: &Pair) -> Course {
        let (Some(soon), Some(intent)) = (self.soon, self.intent) else { return Course::Approaching };
        let (v, r) = (pair.volume, pair.region);
        let (volume, region) = (&self.config.volumes[v].shape, &self.config.regions[r].shape);
        let (volume_soon, region_soon) = (&soon.volume_in_world[v], &soon.region_in_world[r]);
        let away = (pair.separation.on_a - pair.separation.on_b).try_normalize();
        let Some(away) = away.filter(|_| pair.separation.distance > 0.0) else {
            let out = leads_out(self, pair, intent, (volume_soon, region_soon));
            return if out { Course::Recovering } else { Course::Approaching };
        };
        let grown = pair.separation.distance + LEAVING_SPEED * LOOKAHEAD_S;
        let leaves = self.moves_along(pair, intent, away)
            && !elbowroom_proximity::within(volume, volume_soon, region, region_soon, grown);
        if leaves { Course::Leaving } else { Course::Approaching }
    }

    /// True where the program wants to leave the region in this direction, and the robot does not really move against it.
    pub(crate) fn moves_along(&self, pair: &Pair, intent: &ChainState, away: Vec3) -> bool {
        let (v, r) = (pair.volume, pair.region);
        let region_velocity =
            region_point_motion(&self.config.regions[r], self.snapshot.sources, pair.separation.on_b).0;
        let intended = self.velocity_of(intent, v, pair.separation.on_a) - region_velocity;
        let real = self.now.point_motion(self.config, v, pair.separation.on_a).0 - region_velocity;
        intended.dot(away) > LEAVING_SPEED && real.dot(away) >= 0.0
    }

    pub(crate) fn velocity_of(&self, state: &ChainState, volume: usize, point: Vec3) -> Vec3 {
        let base = &self.config.base_in_world;
        let link = self.config.volumes[volume].link;
        let origin = base.transform_point(state.link_in_root(link).translation);
        let offset = base.inverse_transform_vector(point - origin);
        base.transform_vector(state.link_motion(link).velocity_at(offset))
    }
}

impl PairLaw for Judge<'_> {
    fn asks(&self, pair: &Pair, so_far: f64) -> Asked {
        let v0 = self.snapshot.programmed_override;
        let region = &self.config.regions[pair.region];
        match region.kind {
            Kind::Forbidden | Kind::Exchange { .. } => self.forbidden(pair, so_far),
            Kind::Monitored { slow_to: None } => Asked::gently(v0, v0),
            Kind::Monitored { slow_to: Some(slow) } => {
                Asked::gently(speed_zone(pair.separation.distance, region.warning_m, slow, v0), v0)
            }
        }
    }

    fn stops_outside(&self, pair: &Pair) -> bool {
        self.can_stop_outside(pair)
    }

    fn extra_reach(&self, volume: usize) -> f64 {
        let Some((_, law)) = self.stopping else { return 0.0 };
        let (travel, time_s) = law.reach(volume);
        travel + STOP_SHORT_M + self.region_speed_m_s * time_s
    }

    fn only_closest_matters(&self) -> bool {
        self.soon.is_none() && self.intent.is_none()
    }
}

/// No point of a region that follows a source is faster, m/s.
pub(crate) fn fastest_region(now: &Placement, sources: &[Source]) -> f64 {
    let fastest = |(region, source): &(usize, usize)| {
        let Source { pose, motion, .. } = &sources[*source];
        let turning = motion.angular_velocity.length();
        let lever = || farthest(&now.region_box[*region], pose.translation);
        motion.velocity.length() + if turning > 0.0 { turning * lever() } else { 0.0 }
    };
    now.riders.iter().map(fastest).fold(0.0, f64::max)
}

/// Distance of a point from the farthest corner of a box, m.
fn farthest(boxed: &Aabb, from: Vec3) -> f64 {
    (boxed.min - from).abs().max((boxed.max - from).abs()).length()
}
