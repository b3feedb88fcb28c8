//! The weight matrix: which pair to look at first (S3, "Collision queries sorted using a weight matrix").
//!
//! A priori by kinematics and morphology: the more joints lie between two members the more they move against each other,
//! large solids meet more than small ones, and members whose reaches hardly overlap seldom meet. Then each result counts: a contact raises the weight of its pair
//! and lowers all others. A question that finds nothing looked at every likely pair in vain and changes no order.
//!
//! So weights depend on nothing but which contacts were told, and the contact told is the one of the largest weight: the
//! same one at every level that is exact, however many pairs the boxes before it dismiss.

use elbowroom_kinematics::JointKind;
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::{Member, Object, SceneRobot, pairs};

/// What weighs of one member before anything was asked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prior {
    /// Distance (m) of the solids' farthest point from the member's origin; infinite for solids without end.
    radius_m: f64,
    /// A ball that holds the member whatever its joints do, or nearly so: joints without limits slide 1 m.
    centre: Vec3,
    reach_m: f64,
}

impl Prior {
    pub fn of(robots: &[SceneRobot], objects: &[Object], member: Member) -> Self {
        match member {
            Member::Object(o) => {
                let object = &objects[o];
                let bounds = object.shape.aabb(&Pose::IDENTITY);
                let radius_m = 0.5 * bounds.extent().length();
                let finite = radius_m.is_finite();
                let centre = if finite { object.in_world.transform_point(middle(&bounds)) } else { Vec3::ZERO };
                let radius_m = if finite { radius_m } else { f64::INFINITY };
                Self { radius_m, centre, reach_m: radius_m }
            }
            Member::Link { robot, link } => {
                let r = &robots[robot];
                let chain = &r.robot.chain;
                let radius_m = pairs::radius(&r.robot.bodies[link.0]);
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

    /// Weight of a pair before anything was asked, in no unit: 1 + the moving joints `between` them, times (x / (1 + x))³
    /// where x are both radii (m), times the share of the smaller reach that the larger one overlaps.
    ///
    /// The cube: of two solids thrown at random into one volume, the volume of the places in which they overlap grows
    /// with the cube of their sizes.
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

/// Number of moving joints between two members: along the chain of one robot, otherwise through both bases.
pub(crate) fn joints_between(robots: &[SceneRobot], a: Member, b: Member) -> usize {
    match (a, b) {
        (Member::Link { robot, link }, Member::Link { robot: other, link: to }) if robot == other => {
            let chain = &robots[robot].robot.chain;
            let between = pairs::joints_between(chain, link, to);
            between.iter().filter(|j| chain.joints()[j.0].kind.moves()).count()
        }
        _ => depth(robots, a) + depth(robots, b),
    }
}

fn middle(bounds: &Aabb) -> Vec3 {
    (bounds.min + bounds.max) * 0.5
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

/// A contact moves the weight of its pair this share of the way to [`HIT`],
const RAISE: f64 = 0.25;
/// which is above every weight by kinematics alone, so that what hit last time comes first.
pub(crate) const HIT: f64 = 1e3;
/// All others lose this share.
const DECAY: f64 = 1.0 / 64.0;
/// No weight falls below this: it would have no order in the end.
const LEAST: f64 = 1e-9;

/// The weight of a pair that was told to be in contact.
pub(crate) fn raised(weight: f64) -> f64 {
    weight + RAISE * (HIT.max(weight) - weight)
}

/// The weight of a pair while another is told.
pub(crate) fn lowered(weight: f64) -> f64 {
    (weight * (1.0 - DECAY)).max(LEAST.min(weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hits_raise_and_the_hits_of_others_lower_and_both_stay_finite() {
        let mut w = 7.0;
        for _ in 0..10_000 {
            let more = raised(w);
            assert!(more >= w && more <= HIT);
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
    fn large_within_reach_and_many_joints_apart_weighs_more() {
        let base = Prior { radius_m: 0.2, centre: Vec3::ZERO, reach_m: 1.0 };
        let ball = Prior { radius_m: 0.1, centre: Vec3::X * 0.8, reach_m: 0.1 };
        let weight = base.weight(&ball, 1);
        assert!(base.weight(&ball, 2) > weight);
        assert!(Prior { radius_m: 0.3, ..base }.weight(&ball, 1) > weight);
        assert!(base.weight(&Prior { centre: Vec3::X * 1.05, ..ball }, 1) < weight);
        assert_eq!(base.weight(&Prior { centre: Vec3::X * 1.2, ..ball }, 1), 0.0);
        let floor = Prior { radius_m: f64::INFINITY, centre: Vec3::ZERO, reach_m: f64::INFINITY };
        assert_eq!(base.weight(&floor, 1), 2.0);
        assert_eq!(base.weight(&floor, 3), floor.weight(&base, 3));
        assert_eq!(base.weight(&Prior { radius_m: f64::NAN, reach_m: f64::NAN, ..ball }, 1), 2.0);
    }
}
