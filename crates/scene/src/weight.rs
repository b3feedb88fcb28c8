//! The weight matrix: which pair to look at first (S3, "Collision queries sorted using a weight matrix").
//!
//! A priori, links far from the base are likelier to meet something, and near robots likelier to meet than far ones.
//! Then each result counts: a contact raises the weight of its pair, a pair looked at in vain loses some.

use crate::{Member, SceneRobot};

/// Weight before anything was asked: the product of (1 + moving joints above) of both sides, over 1 + distance (m) of
/// the bases.
pub(crate) fn prior(robots: &[SceneRobot], a: Member, b: Member) -> f64 {
    let joints = |m: Member| (1 + depth(robots, m)) as f64;
    let bases = match (a, b) {
        (Member::Link { robot: a, .. }, Member::Link { robot: b, .. }) => {
            robots[a].base_in_world.translation.distance(robots[b].base_in_world.translation)
        }
        _ => 0.0,
    };
    let weight = joints(a) * joints(b) / (1.0 + bases);
    if weight.is_finite() { weight } else { 0.0 }
}

/// Number of moving joints between a link and its base; 0 for objects.
pub(crate) fn depth(robots: &[SceneRobot], member: Member) -> usize {
    match member {
        Member::Object(_) => 0,
        Member::Link { robot, link } => {
            let chain = &robots[robot].robot.chain;
            chain.path(link).iter().filter(|j| chain.joints()[j.0].kind.moves()).count()
        }
    }
}

/// A contact moves the weight this share of the way to [`HIT`].
const RAISE: f64 = 0.25;
/// Above every weight by kinematics alone, so that what hit last time comes first.
pub(crate) const HIT: f64 = 1e3;
/// Looked at in vain: this share is lost.
const DECAY: f64 = 1.0 / 64.0;

/// What a pair's weight becomes after it was looked at.
pub(crate) fn learned(weight: f64, hit: bool) -> f64 {
    if hit { weight + RAISE * (HIT.max(weight) - weight) } else { weight * (1.0 - DECAY) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_raise_and_misses_lower_and_both_stay_finite() {
        let mut w = 7.0;
        for _ in 0..10_000 {
            let more = learned(w, true);
            assert!(more >= w && more <= HIT);
            w = more;
        }
        for _ in 0..100_000 {
            let less = learned(w, false);
            assert!(less <= w && less >= 0.0);
            w = less;
        }
    }
}
