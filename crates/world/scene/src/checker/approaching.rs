//! Pairs in motion: distance and time to collision, each pair at the level of detail that it needs.

use elbowroom_proximity::ccd::{ConstantTwist, contact_free_fraction};
use elbowroom_proximity::contact::Detail;
use elbowroom_proximity::{Cuboid, Separation, Shape};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use super::core::CheckerCore;
use super::pair_list::{GeometryPair, PairList};
use super::result::{ApproachingPair, less_margin};
use crate::local_shape::LocalShape;
use crate::narrow_phase::PlacedModel;
use crate::{Level, LevelOfDetail, SceneMotion, SceneState};

/// One side of a pair in motion.
struct MovingModel<'s> {
    placed: PlacedModel<'s>,
    motion: FrameMotion,
}

/// Result for a pair at one level of detail; lengths in metres, less the margin.
struct ApproachBound {
    metres: f64,
    lower_bound: f64,
    on: [Vec3; 2],
    detail: Detail,
    /// Proven time, seconds, before which the pair does not meet; at most the horizon.
    earliest_s: f64,
}

/// Requirements of a query for one pair.
struct ApproachLimits<'p> {
    policy: &'p LevelOfDetail,
    /// Horizon of the proof, seconds: the longer of the policy's and the query's horizon.
    horizon_s: f64,
    /// Distance (m, less margin) beyond which the exact distance is not needed.
    reach: f64,
}

impl<'s> CheckerCore<'s> {
    /// Reports every pair within the policy's reach, in the order of the hierarchy.
    pub(super) fn approaching(
        &mut self,
        list: &mut PairList,
        state: &SceneState,
        motion: &SceneMotion,
        policy: &LevelOfDetail,
        horizon_s: f64,
        mut found: impl FnMut(ApproachingPair),
    ) {
        let scene = self.scene;
        // Computes the motion of every model once, though each model is in many pairs.
        let mut moving = std::mem::take(&mut self.moving);
        moving.clear();
        moving.extend(scene.models.iter().enumerate().map(|(i, m)| {
            let motion = motion.of(scene, state, m.id).unwrap_or(FrameMotion::REST);
            (motion, speed_bound(&MovingModel { placed: PlacedModel::new(scene, state, i), motion }))
        }));
        let fastest = moving.iter().fold(0.0, |most: f64, m| if m.1 > most || m.1.is_nan() { m.1 } else { most });
        let within = nan_is_infinite(policy.within_m);
        let reach_at = |speed: f64| within.max(nan_is_infinite(speed * policy.exact_s));
        self.broad_phase(list, state, reach_at(2.0 * fastest), false);
        self.sort_candidates();
        for i in 0..self.candidates.len() {
            let pair = &mut list.pairs[self.candidates[i].index as usize];
            let [(motion_a, speed_a), (motion_b, speed_b)] = [pair.a, pair.b].map(|m| moving[m as usize]);
            let reach = reach_at(speed_a + speed_b);
            let apart = f64::from(state.boxes[pair.a as usize].gap(&state.boxes[pair.b as usize]));
            if apart - pair.margin > reach {
                self.cleared(Level::L2);
                continue;
            }
            let limits = ApproachLimits { policy, horizon_s: horizon_s.max(policy.exact_s), reach };
            let [a, b] = self.sides(pair, state);
            let sides = [MovingModel { placed: a, motion: motion_a }, MovingModel { placed: b, motion: motion_b }];
            let proven = (self.proven_distance(pair, state) - pair.margin).max(0.0);
            if let Some(bound) = self.approach(pair, &sides, proven, &limits) {
                found(approaching_pair(&sides, &bound, horizon_s));
            }
        }
        self.moving = moving;
        self.answered();
    }

    /// Refines a pair from the boxes around its models down to the level of detail that suffices, or the exact geometry.
    fn approach(
        &mut self,
        pair: &mut GeometryPair,
        sides: &[MovingModel<'s>; 2],
        proven: f64,
        limits: &ApproachLimits,
    ) -> Option<ApproachBound> {
        let (policy, limit) = (limits.policy, limits.reach + pair.margin);
        let [a, b] = [&sides[0].placed, &sides[1].placed];
        let lower = (self.narrow.obb_distance(a, b) - pair.margin).max(proven);
        let bound = ApproachBound::new(sides, pair.margin, lower, facing_points(a, b), Detail::Boxes(0), limits);
        if self.out_of_range(&bound, Level::L2, limits) {
            return None;
        }
        let mut next = policy.depth(lower, closing_speed_estimate(sides));
        if policy.progressive && suffices(&bound, policy) {
            self.used(Level::L2);
            return Some(bound);
        }
        if next == Detail::Boxes(0) {
            next = Detail::Boxes(1);
        }
        // If a level does not suffice, the next one follows.
        while let Detail::Boxes(depth @ 1..=2) = next {
            let Some((lower, on)) = self.narrow.box_tree_bound(a, b, depth, limit) else { break };
            let lower = (lower - pair.margin).max(proven);
            let bound = ApproachBound::new(sides, pair.margin, lower, on, next, limits);
            if self.out_of_range(&bound, Level::L3, limits) {
                return None;
            }
            if suffices(&bound, policy) {
                self.used(Level::L3);
                return Some(bound);
            }
            next = Detail::Boxes(depth + 1);
        }
        self.used(Level::L3);
        let Some(s) = self.narrow.separation(a, b, Level::L3, limit, &mut pair.warm_start) else {
            self.narrow.stats.pairs_cleared.add(Level::L3, 1);
            return None;
        };
        let (metres, lower) = less_margin(&s, pair.margin);
        let on = [s.on_a, s.on_b];
        let bound = ApproachBound::new(sides, pair.margin, lower.max(proven), on, Detail::Exact, limits);
        let out = self.out_of_range(&bound, Level::L3, limits);
        (!out).then_some(ApproachBound { metres: metres.max(proven), ..bound })
    }

    /// True if a pair is proven to be beyond `within_m` and not to meet within `exact_s`.
    fn out_of_range(&mut self, bound: &ApproachBound, level: Level, limits: &ApproachLimits) -> bool {
        let policy = limits.policy;
        let out = bound.lower_bound > nan_is_infinite(policy.within_m) && bound.earliest_s >= policy.exact_s;
        if out {
            self.cleared(level);
        }
        out
    }
}

impl ApproachBound {
    /// From a proven lower bound on the distance.
    fn new(
        sides: &[MovingModel; 2],
        margin: f64,
        lower: f64,
        on: [Vec3; 2],
        detail: Detail,
        limits: &ApproachLimits,
    ) -> Self {
        let earliest_s = earliest_contact(sides, lower, on, margin, limits.horizon_s);
        let lower_bound = lower.max(0.0);
        Self { metres: lower_bound, lower_bound, on, detail, earliest_s }
    }
}

/// True if the policy allows the pair to stay at this level of detail.
fn suffices(bound: &ApproachBound, policy: &LevelOfDetail) -> bool {
    bound.lower_bound > policy.exact_m && bound.earliest_s >= policy.exact_s
}

fn approaching_pair([a, b]: &[MovingModel; 2], bound: &ApproachBound, horizon_s: f64) -> ApproachingPair {
    let [on_a, on_b] = bound.on;
    let velocity = |m: &MovingModel, p: Vec3| m.motion.velocity_at(p - m.placed.in_world.translation);
    let toward = (on_b - on_a).try_normalize().unwrap_or(Vec3::ZERO);
    let closing_m_s = (velocity(a, on_a) - velocity(b, on_b)).dot(toward);
    let estimate_s = match bound.metres {
        metres if !(metres > 0.0) => 0.0,
        metres if closing_m_s > 0.0 => metres / closing_m_s,
        _ => f64::INFINITY,
    };
    ApproachingPair {
        a: a.placed.model.id,
        b: b.placed.model.id,
        lower_bound: bound.lower_bound,
        metres: bound.metres,
        on_a,
        on_b,
        closing_m_s,
        estimate_s,
        earliest_s: bound.earliest_s.min(horizon_s.max(0.0)),
        detail: bound.detail,
    }
}

/// Limit in metres, at least 0; NaN means no limit.
fn nan_is_infinite(metres: f64) -> f64 {
    if metres.is_nan() { f64::INFINITY } else { metres.max(0.0) }
}

/// Points of the boxes around the two models that are near each other.
fn facing_points(a: &PlacedModel, b: &PlacedModel) -> [Vec3; 2] {
    let Some((x, y)) = a.obb().zip(b.obb()) else { return [a.in_world.translation, b.in_world.translation] };
    let nearest = |o: &elbowroom_spatial::Obb, p: Vec3| {
        let q = o.pose.inverse_transform_point(p);
        o.pose.transform_point(q.max(-o.half_extents).min(o.half_extents))
    };
    let on_b = nearest(&y, nearest(&x, y.pose.translation));
    [nearest(&x, on_b), on_b]
}

/// Upper bound (m/s) on the speed of every point while the velocity and angular velocity of the frame stay constant.
fn speed_bound(m: &MovingModel) -> f64 {
    let rotation = m.motion.angular_velocity.length();
    match m.placed.obb() {
        Some(obb) => {
            let arm = obb.pose.translation.distance(m.placed.in_world.translation);
            m.motion.velocity.length() + rotation * (arm + obb.half_extents.length())
        }
        None if rotation == 0.0 => m.motion.velocity.length(),
        None => f64::INFINITY,
    }
}

/// Estimate of the present approach speed of two models, m/s. [`earliest_contact`] holds the proof.
fn closing_speed_estimate([a, b]: &[MovingModel; 2]) -> f64 {
    let seen_from = |x: &MovingModel, y: &MovingModel| {
        let at = x.placed.obb().map_or(x.placed.in_world.translation, |o| o.pose.translation);
        let velocity = |m: &MovingModel| m.motion.velocity_at(at - m.placed.in_world.translation);
        let reach = x.placed.obb().map_or(f64::INFINITY, |o| o.half_extents.length());
        let rotation = (x.motion.angular_velocity - y.motion.angular_velocity).length();
        (velocity(x) - velocity(y)).length() + if rotation > 0.0 { rotation * reach } else { 0.0 }
    };
    seen_from(a, b).min(seen_from(b, a))
}

/// Proven time (s) in which two models do not meet, computed with the boxes around them; at most the horizon.
fn earliest_contact([a, b]: &[MovingModel; 2], lower: f64, on: [Vec3; 2], margin: f64, horizon_s: f64) -> f64 {
    if !(lower > 0.0 && horizon_s > 0.0) {
        return 0.0;
    }
    // The margin enlarges one of the models, a bounded one.
    let first = a.placed.obb().is_some();
    let (margin_a, margin_b) = if first { (margin, 0.0) } else { (0.0, margin) };
    let Some((shape_a, path_a)) = moving_enclosure(a, margin_a, horizon_s) else { return 0.0 };
    let Some((shape_b, path_b)) = moving_enclosure(b, margin_b, horizon_s) else { return 0.0 };
    let near = Separation { distance: lower, lower_bound: lower, on_a: on[0], on_b: on[1] };
    horizon_s * contact_free_fraction(&near, &shape_a, &path_a, &shape_b, &path_b)
}

/// The box around a model, or its only shape if it is unbounded, and its motion at constant velocities.
fn moving_enclosure(m: &MovingModel, margin: f64, seconds: f64) -> Option<(Shape, ConstantTwist)> {
    let (shape, start): (Shape, Pose) = match (m.placed.obb(), &m.placed.model.exact[..]) {
        (Some(obb), _) => (Shape::Cuboid(Cuboid { half_extents: obb.half_extents + Vec3::splat(margin) }), obb.pose),
        (None, [LocalShape { shape, in_geometry, .. }]) if margin == 0.0 => {
            (shape.clone(), m.placed.in_world * *in_geometry)
        }
        _ => return None,
    };
    let path = ConstantTwist::from_motion(m.placed.in_world, &m.motion, seconds);
    Some((shape, ConstantTwist { start, ..path }))
}
