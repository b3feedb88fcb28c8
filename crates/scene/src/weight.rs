//! The weight matrix: which pair to look at first (S3, "Collision queries sorted using a weight matrix").
//!
//! A priori by kinematics and morphology: of solids that may be anywhere within reach of each other, large ones meet more often
//! than small ones, by the cube of their sizes; more often where their reaches overlap far; and more often the more joints move
//! one against the other, so that distal links come first. Then each result counts: a contact raises the weight of its pair
//! and lowers all others. A question that finds nothing looked at every likely pair in vain and changes no order.
//!
//! So weights depend on nothing but which contacts were told, and the contact told is the one of the largest weight: the
//! same one at every level that is exact, however many pairs the boxes before it dismiss.

use elbowroom_kinematics::JointKind;
use elbowroom_proximity::Shape;
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::{Member, Object, SceneRobot, pairs};

/// What weighs of one member before anything was asked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prior {
    /// Half the diagonal (m) of the box around the solids, less where they fill little of it; infinite for solids without end.
    size_m: f64,
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
                let reach_m = if finite { radius_m } else { f64::INFINITY };
                Self { size_m: size([(&object.shape, Pose::IDENTITY)].into_iter()), centre, reach_m }
            }
            Member::Link { robot, link } => {
                let r = &robots[robot];
                let chain = &r.robot.chain;
                let bodies = &r.robot.bodies[link.0];
                let (mut pose, mut fixed, mut reach_m) = (r.base_in_world, true, pairs::radius(bodies));
                for id in chain.path(link) {
                    let joint = &chain.joints()[id.0];
                    if fixed {
                        pose = pose * joint.origin;
                    } else {
                        reach_m += joint.origin.translation.length();
                    }
                    fixed &= !joint.kind.moves();
                    if joint.kind == JointKind::Prismatic {
                        let stroke = joint.limits.lower.abs().max(joint.limits.upper.abs());
                        reach_m += if stroke.is_finite() { stroke } else { 1.0 };
                    }
                }
                let size_m = size(bodies.iter().map(|b| (&b.shape, b.in_link)));
                Self { size_m, centre: pose.translation, reach_m }
            }
        }
    }

    /// Weight of a pair before anything was asked, from 0 to [`MODEL`]. What counts is x: the cube of both sizes together (m), times
    /// the share of both reaches by which they overlap, times 1 + the joints between. The weight is x / (1 m³ + x), which keeps
    /// the order.
    pub fn weight(&self, other: &Self, joints_between: usize) -> f64 {
        // What has no end is as large as what moves before it.
        let size = |one: &Self, other: &Self| if one.size_m.is_finite() { one.size_m } else { other.reach_m };
        let sizes = size(self, other) + size(other, self);
        let reaches = self.reach_m + other.reach_m;
        let overlap = (reaches - self.centre.distance(other.centre)) / reaches;
        let overlap = if overlap.is_finite() { overlap.clamp(0.0, 1.0) } else { 1.0 };
        let x = (1 + joints_between) as f64 * sizes.powi(3) * overlap;
        let weight = MODEL * (x / (1.0 + x));
        if weight.is_finite() { weight } else { 0.0 }
    }
}

/// No weight by the models alone is above this.
const MODEL: f64 = 100.0;
/// A member fills no less of its box than this, as far as weights are concerned: what is hollow may be met all the same.
const HOLLOW: f64 = 0.05;
/// Of the box around an open mesh this is filled, for all that is known.
const OPEN: f64 = 0.3;

/// Half the diagonal of the box around solids, less by the cube root of the share of it that they fill.
fn size<'s>(solids: impl Iterator<Item = (&'s Shape, Pose)>) -> f64 {
    let (mut bounds, mut volume) = (Aabb::EMPTY, 0.0);
    for (shape, pose) in solids {
        let own = shape.aabb(&pose);
        bounds = bounds.union(&own);
        let open = matches!(shape, Shape::Mesh(m) if !m.report().closed);
        volume += if open { OPEN * box_volume(&own) } else { shape.volume().abs() };
    }
    let radius_m = 0.5 * bounds.extent().length();
    if !radius_m.is_finite() {
        return f64::INFINITY;
    }
    let share = volume / box_volume(&bounds);
    radius_m * if share.is_finite() { share.clamp(HOLLOW, 1.0).cbrt() } else { 1.0 }
}

fn box_volume(bounds: &Aabb) -> f64 {
    let extent = bounds.extent();
    extent.x * extent.y * extent.z
}

fn middle(bounds: &Aabb) -> Vec3 {
    (bounds.min + bounds.max) * 0.5
}

/// Number of joints that move two members against each other.
pub(crate) fn joints_between(robots: &[SceneRobot], a: Member, b: Member) -> usize {
    match (a, b) {
        (Member::Link { robot, link }, Member::Link { robot: same, link: other }) if robot == same => {
            let chain = &robots[robot].robot.chain;
            let between = pairs::joints_between(chain, link, other);
            between.iter().filter(|j| chain.joints()[j.0].kind.moves()).count()
        }
        _ => depth(robots, a) + depth(robots, b),
    }
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
    use elbowroom_proximity::{HalfSpace, Sphere};

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
    fn mobile_large_and_within_reach_weigh_more() {
        let base = Prior { size_m: 0.2, centre: Vec3::ZERO, reach_m: 1.0 };
        let ball = Prior { size_m: 0.1, centre: Vec3::X * 0.8, reach_m: 0.1 };
        let weight = base.weight(&ball, 1);
        assert!(base.weight(&ball, 2) > weight);
        assert!(Prior { size_m: 0.3, ..base }.weight(&ball, 1) > weight);
        assert!(base.weight(&Prior { centre: Vec3::X, ..ball }, 1) < weight);
        assert_eq!(base.weight(&Prior { centre: Vec3::X * 1.2, ..ball }, 1), 0.0);
        let floor = Prior { size_m: f64::INFINITY, centre: Vec3::ZERO, reach_m: f64::INFINITY };
        let on_floor = base.weight(&floor, 1);
        assert!(on_floor > weight && on_floor <= MODEL && on_floor == floor.weight(&base, 1));
        let huge = Prior { size_m: 1e200, ..base };
        assert!(base.weight(&Prior { reach_m: f64::NAN, ..ball }, 1) > 0.0 && huge.weight(&huge, 1) < HIT);
    }

    #[test]
    fn what_is_hollow_is_smaller_and_what_has_no_end_is_endless() {
        let size = |solids: &[(&Shape, Pose)]| size(solids.iter().copied());
        let ball = Shape::Sphere(Sphere { radius: 0.2 });
        let one = size(&[(&ball, Pose::IDENTITY)]);
        assert!((one - 0.2 * 3.0_f64.sqrt() * (std::f64::consts::PI / 6.0).cbrt()).abs() < 1e-12);
        let apart = size(&[(&ball, Pose::IDENTITY), (&ball, Pose::from_translation(Vec3::splat(3.0)))]);
        assert!((apart - 1.7 * 3.0_f64.sqrt() * HOLLOW.cbrt()).abs() < 1e-12);
        assert_eq!(size(&[(&Shape::HalfSpace(HalfSpace), Pose::IDENTITY)]), f64::INFINITY);
    }
}
