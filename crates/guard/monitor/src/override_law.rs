//! The override law of a tick: the override that each pair of volume and region requests, with the formulas of
//! `laws.rs`.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Vec3;

use crate::laws::{speed_zone, warning_factor};
use crate::placement::{DynamicRegion, Placement};
use crate::point_motion::max_speed_along;
use crate::recovery::{RecoverySettings, border_speed, leads_out};
use crate::region_approach::{RegionApproach, TurningMotion};
use crate::stopping::{StoppingLaw, StoppingQuery};
use crate::tick_context::{LEAVING_SPEED, LOOKAHEAD_S, TickContext};
use crate::volume_region_pair::{RequestedOverride, VolumeRegionPair};
use crate::{RegionKind, Snapshot, SourceState};

/// Margin (m) for rounding errors before a border.
const ROUNDING_M: f64 = 1e-6;

/// Settings of the override law.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OverrideLawSettings {
    /// Distance (m) before the border at which the stopping-distance law stops, so that rounding never puts the stop
    /// inside.
    pub(crate) stop_margin_m: f64,
    /// Speed (rad/s, m/s) below which a joint is at rest if its deceleration is not stated.
    pub(crate) rest_speed: f64,
    pub(crate) recovery: RecoverySettings,
}

impl Default for OverrideLawSettings {
    fn default() -> Self {
        Self { stop_margin_m: 5e-4, rest_speed: 1e-3, recovery: RecoverySettings::default() }
    }
}

/// The override law of one tick.
pub(crate) struct OverrideLaw<'a> {
    pub(crate) tick: TickContext<'a>,
    /// The stopping-distance law, if it is on.
    pub(crate) stopping_law: Option<&'a StoppingLaw>,
    /// Upper bound of the travel of all points of all regions until the robot is at rest, m.
    pub(crate) max_region_travel_m: f64,
    pub(crate) settings: OverrideLawSettings,
}

/// How the distance of a pair changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Direction {
    /// The distance decreases, or is not known to increase.
    Approaching,
    /// The distance increases.
    Leaving,
    /// The volume is inside a region at rest, and the program leaves the region.
    Recovering,
}

impl<'a> OverrideLaw<'a> {
    pub(crate) fn new(tick: TickContext<'a>, stopping_law: Option<&'a StoppingLaw>) -> Self {
        Self {
            tick,
            stopping_law,
            max_region_travel_m: max_region_travel_m(tick.now, tick.snapshot, stopping_law),
            settings: OverrideLawSettings::default(),
        }
    }

    /// The override that a pair requests. `so_far` is the smallest request of other pairs: a request of at least that
    /// need not be exact.
    pub(crate) fn requested_override(&self, pair: &VolumeRegionPair, so_far: f64) -> RequestedOverride {
        let v0 = self.tick.snapshot.programmed_override;
        let region = &self.tick.config.regions[pair.region.0];
        match region.kind {
            RegionKind::Forbidden | RegionKind::Exchange { .. } => self.forbidden(pair, so_far),
            RegionKind::Monitored { slow_to: None } => RequestedOverride::gradual(v0, v0),
            RegionKind::Monitored { slow_to: Some(slow) } => {
                RequestedOverride::gradual(speed_zone(pair.separation.distance, region.warning_m, slow, v0), v0)
            }
        }
    }

    /// True if the robot, commanded to stop in this tick, comes to rest outside the region: by the stopping-distance law
    /// or, if no deceleration is stated, because it is at rest.
    pub(crate) fn stops_outside(&self, pair: &VolumeRegionPair) -> bool {
        if pair.separation.distance <= 0.0 {
            return false;
        }
        let Some(law) = self.stopping_law else { return self.is_at_rest(pair) };
        self.stopping_query(pair, law).is_some_and(|query| law.stops_outside(&query))
    }

    /// Distance (m) beyond the warning zone within which a region can affect this volume.
    pub(crate) fn extra_reach(&self, volume: usize) -> f64 {
        let Some(law) = self.stopping_law else { return 0.0 };
        law.reach_m(volume) + self.settings.stop_margin_m + self.max_region_travel_m
    }

    /// True if farther pairs never request less than closer ones.
    pub(crate) fn only_closest_matters(&self) -> bool {
        self.tick.predicted.is_none() && self.tick.intent.is_none()
    }

    /// Lower bounds of the requests of all pairs of a region whose distances are at least `lower_m` (m), if volumes come
    /// to rest within `extra_reach_m` (m).
    pub(crate) fn least_request(
        &self,
        kind: RegionKind,
        warning_m: f64,
        lower_m: f64,
        extra_reach_m: f64,
    ) -> RequestedOverride {
        let v0 = self.tick.snapshot.programmed_override;
        match kind {
            RegionKind::Monitored { slow_to: None } => RequestedOverride::gradual(v0, v0),
            RegionKind::Monitored { slow_to: Some(slow) } => {
                RequestedOverride::gradual(speed_zone(lower_m, warning_m, slow, v0), v0)
            }
            RegionKind::Forbidden | RegionKind::Exchange { .. } => {
                let stops = self.stopping_law.is_none() || lower_m > extra_reach_m;
                if lower_m > 0.0 && stops {
                    RequestedOverride::gradual(v0 * warning_factor(lower_m, warning_m), v0)
                } else {
                    RequestedOverride::immediate(0.0)
                }
            }
        }
    }

    fn forbidden(&self, pair: &VolumeRegionPair, so_far: f64) -> RequestedOverride {
        let config = self.tick.config;
        let v0 = self.tick.snapshot.programmed_override;
        let warned = v0 * warning_factor(pair.separation.distance, config.regions[pair.region.0].warning_m);
        // With a limited rate of change the override may exceed the request of the zone: then the limit of the
        // stopping-distance law itself is needed.
        let is_limited = config.laws.override_rate > 0.0;
        let (max, so_far) = if is_limited { (v0, v0) } else { (warned, v0.min(so_far)) };
        let law = self.stopping_law.map(|law| (law, self.stopping_query(pair, law)));
        // The limit of the stopping-distance law if it is below `enough`.
        let limit_below = |enough: f64, max: f64, margin_m: &dyn Fn(f64) -> f64| {
            let (law, query) = law.as_ref()?;
            let Some(query) = query else { return Some(0.0).filter(|_| enough > 0.0) };
            law.limit_below(&query.with_margin(margin_m(query.free_m)), enough, max)
        };
        let held = match limit_below(so_far.min(max), max, &|_| self.settings.stop_margin_m) {
            Some(stopping) => RequestedOverride { speed_override: stopping.min(warned), immediate_limit: stopping },
            None => RequestedOverride::gradual(warned, v0),
        };
        if self.tick.predicted.is_none() || held.speed_override >= so_far {
            return held;
        }
        match self.direction(pair) {
            Direction::Approaching => held,
            Direction::Leaving => {
                // A leaving volume keeps only the margin for rounding, however close it is.
                let stopping = limit_below(so_far, v0, &|free_m| ROUNDING_M.min(0.5 * free_m));
                RequestedOverride::immediate(stopping.unwrap_or(v0))
            }
            Direction::Recovering => RequestedOverride::immediate(v0 * config.laws.recovery),
        }
    }

    /// The query of the stopping-distance law for the pair; `None` on contact.
    fn stopping_query(&self, pair: &VolumeRegionPair, law: &StoppingLaw) -> Option<StoppingQuery> {
        let config = self.tick.config;
        let s = &pair.separation;
        let free_m = s.lower_bound.min(s.distance);
        if !(free_m > 0.0) {
            return None;
        }
        let (volume, region) = (pair.volume, &config.regions[pair.region.0]);
        // Two convex solids have a separating plane, and only motion across it counts. Other solids may approach in any
        // direction.
        let is_convex = |shape: &Shape| !matches!(shape, Shape::Mesh(_));
        if !(is_convex(&config.volumes[volume].shape) && is_convex(&region.shape)) {
            let approach = law.approach_any_direction(volume);
            let region = self.region_approach(pair, law, None);
            return Some(StoppingQuery { volume, approach, free_m, region });
        }
        let towards = (s.on_b - s.on_a).try_normalize()?;
        let region = self.region_approach(pair, law, Some(towards));
        if region.is_still() && law.is_out_of_reach(volume, free_m - self.settings.stop_margin_m) {
            return Some(StoppingQuery { volume, approach: law.approach_any_direction(volume), free_m, region });
        }
        let closing_speed = |state| max_speed_along(config, self.tick.now, volume, state, towards);
        let program_speed = closing_speed(self.tick.intent?);
        // The actual motion counts only if the program is not known.
        let real_speed = if law.program_is_known() { 0.0 } else { closing_speed(&self.tick.now.chain) };
        let approach = law.approach(volume, towards, program_speed, real_speed);
        Some(StoppingQuery { volume, approach, free_m, region })
    }

    /// The approach of the region by its own motion: against `towards`, or in any direction.
    fn region_approach(&self, pair: &VolumeRegionPair, law: &StoppingLaw, towards: Option<Vec3>) -> RegionApproach {
        let region = &self.tick.config.regions[pair.region.0];
        let Some(source) = region.source_state(self.tick.snapshot.sources) else { return RegionApproach::default() };
        let older_s = older_s(self.tick.snapshot, source);
        let origin = source.pose.translation;
        let bounds = &self.tick.now.region_box[pair.region.0];
        if bounds.extent().is_finite() {
            let motion = TurningMotion::new(&source.motion, bounds.max_distance(origin));
            let approach = match towards {
                Some(towards) => motion.approach(self.closing_speed(pair, source, towards)),
                None => motion.approach_any_direction(),
            };
            return approach.older_by(older_s);
        }
        // Only the points of a half-space that come to where the volume may be count.
        let volume = &self.tick.now.volume_box[pair.volume];
        let drift = source.motion.velocity.length() * (law.rest_after_s() + older_s);
        let motion = TurningMotion::new(&source.motion, volume.max_distance(origin) + law.reach_m(pair.volume) + drift);
        let towards = towards.or_else(|| (pair.separation.on_b - pair.separation.on_a).try_normalize());
        let fastest = |towards| motion.swinging_speed() - source.motion.velocity.dot(towards);
        let approach = towards.map(|towards| motion.approach(fastest(towards)));
        approach.unwrap_or_else(|| motion.approach_any_direction()).older_by(older_s)
    }

    /// Largest speed (m/s) of the points of a bounded region against `towards`.
    fn closing_speed(&self, pair: &VolumeRegionPair, source: &SourceState, towards: Vec3) -> f64 {
        let region = &self.tick.config.regions[pair.region.0];
        let in_world = &self.tick.now.region_in_world[pair.region.0];
        let lever = (-towards).cross(source.motion.angular_velocity);
        let farthest = in_world.transform_point(region.shape.support(in_world.inverse_transform_vector(lever)));
        source.motion.velocity_at(farthest - source.pose.translation).dot(-towards)
    }

    /// True if joints and region are at rest, and no commanded override will move the joints.
    fn is_at_rest(&self, pair: &VolumeRegionPair) -> bool {
        let rest_speed = self.settings.rest_speed;
        let commanded = |v: &f64| (v * self.tick.last_override).abs() <= rest_speed;
        self.tick.now.chain.qd.iter().all(|v| v.abs() <= rest_speed)
            && self.tick.snapshot.intent.is_none_or(|intent| intent.iter().all(commanded))
            && self.tick.region_point_velocity(pair.region, pair.separation.on_b).length() <= rest_speed
    }

    /// The direction of the pair. It is `Leaving` if the distance increases now and over the lookahead time, along the
    /// program's motion, and the actual motion does not decrease it. A decreasing distance never clears an alarm.
    fn direction(&self, pair: &VolumeRegionPair) -> Direction {
        let tick = &self.tick;
        let (Some(predicted), Some(intent)) = (tick.predicted, tick.intent) else { return Direction::Approaching };
        let (v, r) = (pair.volume, pair.region.0);
        let away = (pair.separation.on_a - pair.separation.on_b).try_normalize();
        let Some(away) = away.filter(|_| pair.separation.distance > 0.0) else {
            // Where a moving region will be when the robot is at rest is not known well enough for motion inside it.
            let recovers = border_speed(tick, pair) <= self.settings.recovery.region_rest_speed
                && leads_out(tick, &self.settings.recovery, pair, intent, predicted);
            return if recovers { Direction::Recovering } else { Direction::Approaching };
        };
        let grown = pair.separation.distance + LEAVING_SPEED * LOOKAHEAD_S;
        let (volume, region) = (&tick.config.volumes[v].shape, &tick.config.regions[r].shape);
        let (volume_predicted, region_predicted) = (&predicted.volume_in_world[v], &predicted.region_in_world[r]);
        let leaves = tick.leaves_along(pair, intent, away)
            && !elbowroom_proximity::within(volume, volume_predicted, region, region_predicted, grown);
        if leaves { Direction::Leaving } else { Direction::Approaching }
    }
}

/// Upper bound of the travel (m) of all points of all dynamic regions, from their readings until the robot is at
/// rest; 0 without the stopping-distance law.
fn max_region_travel_m(now: &Placement, snapshot: &Snapshot<'_>, law: Option<&StoppingLaw>) -> f64 {
    let Some(law) = law else { return 0.0 };
    let travel_m = |dynamic: &DynamicRegion| {
        let source = &snapshot.sources[dynamic.source.0];
        dynamic_region_speed(now, source, dynamic) * (law.rest_after_s() + older_s(snapshot, source))
    };
    now.dynamic_regions.iter().map(travel_m).fold(0.0, f64::max)
}

/// Time (s) by which the reading of a source is older than the reading of the robot; 0 if it is newer.
fn older_s(snapshot: &Snapshot<'_>, source: &SourceState) -> f64 {
    (snapshot.stamp_s - source.stamp_s).max(0.0)
}

/// Upper bound of the speed of all points of a region, m/s.
fn dynamic_region_speed(now: &Placement, source: &SourceState, dynamic: &DynamicRegion) -> f64 {
    let SourceState { pose, motion, .. } = source;
    let angular_speed = motion.angular_velocity.length();
    let lever = || now.region_box[dynamic.region.0].max_distance(pose.translation);
    motion.velocity.length() + if angular_speed > 0.0 { angular_speed * lever() } else { 0.0 }
}
