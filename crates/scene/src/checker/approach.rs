//! Pairs in motion: how near, how soon, each at the level of detail that it needs.

use elbowroom_proximity::contact::Detail;
use elbowroom_proximity::impact::{Steady, earliest};
use elbowroom_proximity::{Cuboid, Separation, Shape};
use elbowroom_spatial::{Motion, Pose, Vec3};

use super::list::{Pair, PairList};
use super::narrow::Placed;
use super::nearest::less_margin;
use super::{Candidate, Core};
use crate::model::Solid;
use crate::{Approach, Level, LevelOfDetail, SceneMotion, SceneState};

/// A side of a pair in motion.
struct Moving<'s> {
    placed: Placed<'s>,
    motion: Motion,
}

/// What was found of a pair, metres less margin.
struct Found {
    metres: f64,
    lower: f64,
    on: [Vec3; 2],
    detail: Detail,
    /// Proven time before which they do not meet, seconds; at most the horizon.
    earliest_s: f64,
}

/// What a question is about.
struct Terms<'p> {
    policy: &'p LevelOfDetail,
    /// How far ahead a proof looks, seconds: what the policy or the question needs.
    horizon_s: f64,
    /// Metres that the exact distance need not be told beyond, less margin.
    reach: f64,
}

impl<'s> Core<'s> {
    /// Every pair within the policy's reach, in the order of the hierarchy.
    pub(super) fn approaching(
        &mut self,
        list: &mut PairList,
        (state, motion): (&SceneState, &SceneMotion),
        policy: &LevelOfDetail,
        horizon_s: f64,
        mut found: impl FnMut(Approach),
    ) {
        let scene = self.scene;
        // Every member's motion once, though it is in many pairs.
        let mut moving = std::mem::take(&mut self.moving);
        moving.clear();
        moving.extend(scene.models.iter().enumerate().map(|(i, m)| {
            let motion = motion.of(scene, state, m.member).unwrap_or(Motion::REST);
            (motion, lasting_speed(&Moving { placed: Placed::new(scene, state, i), motion }))
        }));
        let fastest = moving.iter().fold(0.0, |most: f64, m| if m.1 > most || m.1.is_nan() { m.1 } else { most });
        let within = or_everything(policy.within_m);
        let soon = |speed: f64| within.max(or_everything(speed * policy.exact_s));
        self.collect(list, state, soon(2.0 * fastest), false);
        self.sort();
        for i in 0..self.candidates.len() {
            let Candidate { index, .. } = self.candidates[i];
            let pair = &mut list.pairs[index as usize];
            let [(motion_a, speed_a), (motion_b, speed_b)] = [pair.a, pair.b].map(|m| moving[m as usize]);
            // Neither near nor, at these speeds, soon.
            let reach = soon(speed_a + speed_b);
            let apart = f64::from(state.boxes[pair.a as usize].gap(&state.boxes[pair.b as usize]));
            if apart - pair.margin > reach {
                self.cleared(Level::L2);
                continue;
            }
            let terms = Terms { policy, horizon_s: horizon_s.max(policy.exact_s), reach };
            let [a, b] = self.sides(pair, state);
            let sides = [Moving { placed: a, motion: motion_a }, Moving { placed: b, motion: motion_b }];
            let proven = (self.known(pair, state) - pair.margin).max(0.0);
            if let Some(f) = self.approach(pair, &sides, proven, &terms) {
                found(tell(&sides, &f, horizon_s));
            }
        }
        self.moving = moving;
        self.narrow.counts.answered.add(self.deepest, 1);
    }

    /// From the box around each down to where the answer is good enough, or exact.
    fn approach(&mut self, pair: &mut Pair, sides: &[Moving<'s>; 2], proven: f64, terms: &Terms) -> Option<Found> {
        let (policy, limit) = (terms.policy, terms.reach + pair.margin);
        let [a, b] = [&sides[0].placed, &sides[1].placed];
        let lower = (self.narrow.gap(a, b) - pair.margin).max(proven);
        let found = coarse(sides, pair.margin, lower, centres(a, b), Detail::Boxes(0), terms);
        if self.out(&found, Level::L2, terms) {
            return None;
        }
        let mut next = policy.depth(lower, relative_speed(sides));
        if policy.progressive && settles(&found, policy) {
            self.deepen(Level::L2);
            return Some(found);
        }
        if next == Detail::Boxes(0) {
            next = Detail::Boxes(1);
        }
        // What one level does not prove is asked of the next.
        while let Detail::Boxes(depth @ 1..=2) = next {
            let Some((lower, on)) = self.narrow.bound_at(a, b, depth, limit) else { break };
            let found = coarse(sides, pair.margin, (lower - pair.margin).max(proven), on, next, terms);
            if self.out(&found, Level::L3, terms) {
                return None;
            }
            if settles(&found, policy) {
                self.deepen(Level::L3);
                return Some(found);
            }
            next = Detail::Boxes(depth + 1);
        }
        self.deepen(Level::L3);
        let Some(s) = self.narrow.measure(a, b, Level::L3, limit, &mut pair.hint) else {
            self.narrow.counts.pairs_cleared.add(Level::L3, 1);
            return None;
        };
        let (metres, lower) = less_margin(&s, pair.margin);
        let found = coarse(sides, pair.margin, lower.max(proven), [s.on_a, s.on_b], Detail::Exact, terms);
        let out = self.out(&found, Level::L3, terms);
        (!out).then_some(Found { metres: metres.max(proven), ..found })
    }

    /// True where a pair is neither near nor soon.
    fn out(&mut self, found: &Found, level: Level, terms: &Terms) -> bool {
        let out = found.lower > or_everything(terms.policy.within_m) && found.earliest_s >= terms.policy.exact_s;
        if out {
            self.cleared(level);
        }
        out
    }

    fn cleared(&mut self, level: Level) {
        self.narrow.counts.pairs_cleared.add(level, 1);
        self.deepen(level);
    }
}

/// True where exactness would change nothing that matters.
fn settles(found: &Found, policy: &LevelOfDetail) -> bool {
    found.lower > policy.exact_m && found.earliest_s >= policy.exact_s
}

/// A proven distance, and what follows from it.
fn coarse(sides: &[Moving; 2], margin: f64, lower: f64, on: [Vec3; 2], detail: Detail, terms: &Terms) -> Found {
    let earliest_s = free_for(sides, (lower, on), margin, terms.horizon_s);
    let lower = lower.max(0.0);
    Found { metres: lower, lower, on, detail, earliest_s }
}

fn tell([a, b]: &[Moving; 2], found: &Found, horizon_s: f64) -> Approach {
    let [on_a, on_b] = found.on;
    let velocity = |m: &Moving, p: Vec3| m.motion.velocity_at(p - m.placed.in_world.translation);
    let toward = (on_b - on_a).try_normalize().unwrap_or(Vec3::ZERO);
    let closing_m_s = (velocity(a, on_a) - velocity(b, on_b)).dot(toward);
    let estimate_s = match found.metres {
        metres if !(metres > 0.0) => 0.0,
        metres if closing_m_s > 0.0 => metres / closing_m_s,
        _ => f64::INFINITY,
    };
    Approach {
        a: a.placed.model.member,
        b: b.placed.model.member,
        lower_bound: found.lower,
        metres: found.metres,
        on_a,
        on_b,
        closing_m_s,
        estimate_s,
        earliest_s: found.earliest_s.min(horizon_s.max(0.0)),
        detail: found.detail,
    }
}

/// NaN is no limit.
fn or_everything(metres: f64) -> f64 {
    if metres.is_nan() { f64::INFINITY } else { metres.max(0.0) }
}

/// Points of two boxes that look at each other.
fn centres(a: &Placed, b: &Placed) -> [Vec3; 2] {
    let Some((x, y)) = a.obb().zip(b.obb()) else { return [a.in_world.translation, b.in_world.translation] };
    let nearest = |o: &elbowroom_spatial::Obb, p: Vec3| {
        let q = o.pose.inverse_transform_point(p);
        o.pose.transform_point(q.max(-o.half_extents).min(o.half_extents))
    };
    let on_b = nearest(&y, nearest(&x, y.pose.translation));
    [nearest(&x, on_b), on_b]
}

/// No point of the member is ever faster, m/s, so long as its frame's velocity and angular velocity stay what they are.
fn lasting_speed(m: &Moving) -> f64 {
    let turning = m.motion.angular_velocity.length();
    match m.placed.obb() {
        Some(obb) => {
            let arm = obb.pose.translation.distance(m.placed.in_world.translation);
            m.motion.velocity.length() + turning * (arm + obb.half_extents.length())
        }
        None if turning == 0.0 => m.motion.velocity.length(),
        None => f64::INFINITY,
    }
}

/// How fast the two come nearer at most just now, m/s: a guess at how soon, the proof is [`free_for`].
fn relative_speed([a, b]: &[Moving; 2]) -> f64 {
    let seen = |x: &Moving, y: &Moving| {
        let at = x.placed.obb().map_or(x.placed.in_world.translation, |o| o.pose.translation);
        let velocity = |m: &Moving| m.motion.velocity_at(at - m.placed.in_world.translation);
        let reach = x.placed.obb().map_or(f64::INFINITY, |o| o.half_extents.length());
        let turning = (x.motion.angular_velocity - y.motion.angular_velocity).length();
        (velocity(x) - velocity(y)).length() + if turning > 0.0 { turning * reach } else { 0.0 }
    };
    seen(a, b).min(seen(b, a))
}

/// Proven seconds in which the two do not meet, by the boxes around them; at most the horizon.
fn free_for([a, b]: &[Moving; 2], (lower, on): (f64, [Vec3; 2]), margin: f64, horizon_s: f64) -> f64 {
    if !(lower > 0.0 && horizon_s > 0.0) {
        return 0.0;
    }
    // The margin is put around one of them, the one that has an end.
    let first = a.placed.obb().is_some();
    let (margin_a, margin_b) = if first { (margin, 0.0) } else { (0.0, margin) };
    let Some((shape_a, path_a)) = around(a, margin_a, horizon_s) else { return 0.0 };
    let Some((shape_b, path_b)) = around(b, margin_b, horizon_s) else { return 0.0 };
    let near = Separation { distance: lower, lower_bound: lower, on_a: on[0], on_b: on[1] };
    horizon_s * earliest(&near, (&shape_a, &path_a), (&shape_b, &path_b))
}

/// The box around a member, or its one solid where it has no end, and how it goes on.
fn around(m: &Moving, margin: f64, seconds: f64) -> Option<(Shape, Steady)> {
    let (shape, start): (Shape, Pose) = match (m.placed.obb(), &m.placed.model.exact[..]) {
        (Some(obb), _) => (Shape::Cuboid(Cuboid { half_extents: obb.half_extents + Vec3::splat(margin) }), obb.pose),
        (None, [Solid { shape, in_member, .. }]) if margin == 0.0 => (shape.clone(), m.placed.in_world * *in_member),
        _ => return None,
    };
    let path = Steady::from_motion(m.placed.in_world, &m.motion, seconds);
    Some((shape, Steady { start, ..path }))
}
