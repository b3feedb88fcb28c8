//! The weight of a pair, which decides the order of tests.
//!
//! Source: Giralt et al., "Collision queries sorted using a weight matrix".
//!
//! Initial weights come from kinematics and geometry: the more joints lie between two links, the more they move against
//! each other; large geometry collides more often than small geometry; geometry whose reachable volumes hardly overlap
//! seldom meets. Then results count: a contact raises the weight of its pair and lowers all others. A query without a
//! contact changes no weight, because it had to test every pair anyway.
//!
//! Weights therefore depend only on which contacts were reported. The reported contact is the one of the largest weight.
//! It is equal at every exact level, however many pairs the enclosing volumes separate before it.

use elbowroom_kinematics::{JointKind, LinkId};
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::{Object, SceneRobot};

/// Inputs of the initial weights, for one link or object.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeightPrior {
    /// Distance (m) of a link's farthest point from its origin, or half an object's box diagonal; infinite if unbounded.
    radius_m: f64,
    /// Centre of a sphere that contains the geometry at any joint values.
    ///
    /// An approximation: unlimited slides count as 1 m.
    centre: Vec3,
    reach_m: f64,
}

impl WeightPrior {
    pub fn of(robots: &[SceneRobot], objects: &[Object], id: GeometryId) -> Self {
        match id {
            GeometryId::Object(o) => {
                let object = &objects[o.0];
                let bounds = object.shape.aabb(&Pose::IDENTITY);
                let radius_m = 0.5 * bounds.extent().length();
                let finite = radius_m.is_finite();
                let centre = if finite { object.in_world.transform_point(middle(&bounds)) } else { Vec3::ZERO };
                let radius_m = if finite { radius_m } else { f64::INFINITY };
                Self { radius_m, centre, reach_m: radius_m }
            }
            GeometryId::Link { robot, link } => {
                let r = &robots[robot.0];
                let chain = &r.robot.chain;
                let radius_m = r.robot.link_radius(link);
                let (mut pose, mut depth, mut reach_m) = (r.base_in_world, 0, radius_m);
                for id in chain.path(link) {
                    let joint = &chain.joints()[id.0];
                    if depth == 0 {
                        pose = pose * joint.origin;
                    } else {
                        reach_m += joint.origin.translation.length();
                    }
                    depth += usize::from(joint.kind.moves());
                    if joint.kind == JointKind::Prismatic {
                        let stroke = joint.limits.lower.abs().max(joint.limits.upper.abs());
                        reach_m += if stroke.is_finite() { stroke } else { 1.0 };
                    }
                }
                Self { radius_m, centre: pose.translation, reach_m }
            }
        }
    }

    /// Initial weight of a pair, dimensionless.
    ///
    /// The product of 1 + the number of moving joints `between`; (x / (1 + x))³ with x the sum of the two radii (m); and
    /// the overlap of the two reach spheres as a fraction of the smaller diameter. The cube is used because the volume of
    /// the relative positions in which two bodies overlap grows with the cube of their sizes.
    pub fn weight(&self, other: &Self, between: usize) -> f64 {
        let radii = self.radius_m + other.radius_m;
        let size = if radii.is_finite() { radii / (1.0 + radii) } else { 1.0 };
        let reaches = self.reach_m + other.reach_m;
        let smaller = self.reach_m.min(other.reach_m);
        let overlap = (reaches - self.centre.distance(other.centre)) / (2.0 * smaller);
        let overlap = if reaches.is_finite() && overlap.is_finite() { overlap.clamp(0.0, 1.0) } else { 1.0 };
        let weight = (1 + between) as f64 * size.powi(3) * overlap;
        if weight.is_finite() { weight } else { 0.0 }
    }
}

/// Number of moving joints between two links or objects: along the chain of one robot, else through their two bases.
pub(crate) fn joints_between(robots: &[SceneRobot], a: GeometryId, b: GeometryId) -> usize {
    match (a, b) {
        (GeometryId::Link { robot, link }, GeometryId::Link { robot: other, link: to }) if robot == other => {
            let chain = &robots[robot.0].robot.chain;
            chain.joints_between(link, to).iter().filter(|j| chain.joints()[j.0].kind.moves()).count()
        }
        _ => depth(robots, a) + depth(robots, b),
    }
}

fn middle(bounds: &Aabb) -> Vec3 {
    (bounds.min + bounds.max) * 0.5
}

/// Number of moving joints between a link and its base; 0 for objects.
fn depth(robots: &[SceneRobot], id: GeometryId) -> usize {
    match id {
        GeometryId::Object(_) => 0,
        GeometryId::Link { robot, link } => link_depth(robots, robot, link),
    }
}

/// Number of moving joints between a link and its base.
pub(crate) fn link_depth(robots: &[SceneRobot], robot: RobotId, link: LinkId) -> usize {
    let chain = &robots[robot.0].robot.chain;
    chain.path(link).iter().filter(|j| chain.joints()[j.0].kind.moves()).count()
}

/// Fraction of the distance to [`CONTACT_WEIGHT`] by which a contact raises the weight of its pair.
const RAISE: f64 = 0.25;
/// Limit of raised weights: above every initial weight, so that the pair of the last contact is tested first.
pub(crate) const CONTACT_WEIGHT: f64 = 1e3;
/// Fraction that all other weights lose at a contact.
const DECAY: f64 = 1.0 / 64.0;
/// Lower bound of decayed weights. Smaller weights would underflow and lose their order.
const LEAST: f64 = 1e-9;

/// The weight of a pair after it was reported in contact.
pub(crate) fn raised(weight: f64) -> f64 {
    weight + RAISE * (CONTACT_WEIGHT.max(weight) - weight)
}

/// The weight of a pair after another pair was reported in contact.
pub(crate) fn lowered(weight: f64) -> f64 {
    (weight * (1.0 - DECAY)).max(LEAST.min(weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contacts_raise_and_other_contacts_lower_and_both_stay_finite() {
        let mut w = 7.0;
        for _ in 0..10_000 {
            let more = raised(w);
            assert!(more >= w && more <= CONTACT_WEIGHT);
            w = more;
        }
        for _ in 0..100_000 {
            let less = lowered(w);
            assert!(less <= w && less > 0.0);
            w = less;
        }
        assert_eq!(lowered(0.0), 0.0);
    }

    #[test]
    fn large_geometry_within_reach_and_many_joints_apart_weighs_more() {
        let base = WeightPrior { radius_m: 0.2, centre: Vec3::ZERO, reach_m: 1.0 };
        let ball = WeightPrior { radius_m: 0.1, centre: Vec3::X * 0.8, reach_m: 0.1 };
        let weight = base.weight(&ball, 1);
        assert!(base.weight(&ball, 2) > weight);
        assert!(WeightPrior { radius_m: 0.3, ..base }.weight(&ball, 1) > weight);
        assert!(base.weight(&WeightPrior { centre: Vec3::X * 1.05, ..ball }, 1) < weight);
        assert_eq!(base.weight(&WeightPrior { centre: Vec3::X * 1.2, ..ball }, 1), 0.0);
        let floor = WeightPrior { radius_m: f64::INFINITY, centre: Vec3::ZERO, reach_m: f64::INFINITY };
        assert_eq!(base.weight(&floor, 1), 2.0);
        assert_eq!(base.weight(&floor, 3), floor.weight(&base, 3));
        assert_eq!(base.weight(&WeightPrior { radius_m: f64::NAN, reach_m: f64::NAN, ..ball }, 1), 2.0);
    }
}
