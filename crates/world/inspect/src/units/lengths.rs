//! Unit errors of lengths: compares solids with the chain that carries them, and the chain with the size of a workshop.
//!
//! The chain's own dimensions are the reference `R`: the longest distance from the root to a leaf through the origins and
//! strokes of its joints. For 35 published arms, the sum of the largest box edges of all moved links is 1.0 to 1.65 times
//! that distance without strokes. This is close enough to distinguish factors of 2.5. Chains of few links follow no such
//! rule: only extreme sizes are suspect.

use elbowroom_kinematics::{Chain, JointId, JointKind, LinkId};
use elbowroom_robot::Robot;
use elbowroom_spatial::Aabb;

use super::factor::{self, UnitConfusion};
use super::{SuspectQuantity, SuspectUnit, UnitLabel};

/// Typical sum of the sizes of all moved links, relative to the longest distance through the chain.
const LINK_SUM: f64 = 1.3;
/// Smallest number of moved links with solids for which the rule for arms applies.
const ARM: usize = 4;
/// Ratio of a link to the chain, above which the link is suspect.
const LARGE: f64 = 10.0;
/// Ratio for a link of an arm whose other links are plausible.
const LARGE_IN_ARM: f64 = 3.2;
/// Ratio for a fixed link, which may be a building.
const LARGE_AND_FIXED: f64 = 100.0;
/// Size in a chain of few links, m. Smaller links are not suspected of being too large.
const LARGE_M: f64 = 5.0;
/// Typical size of a link, relative to its chain.
const LINK: f64 = 0.35;
/// Ratio of the chain to the model's largest solid, above which the model is suspect.
const SMALL: f64 = 200.0;
/// Length of a chain or stroke above which it is suspect, m.
const FAR_M: f64 = 50.0;
/// Length of a typical arm, m.
const ARM_M: f64 = 1.5;

/// Size of a link with solids.
#[derive(Debug, Clone, Copy)]
struct LinkSize {
    link: LinkId,
    /// Largest edge of the box around its solids, m.
    extent_m: f64,
    /// True if a joint moves the link.
    is_moved: bool,
}

struct Sizes<'r> {
    chain: &'r Chain,
    /// Longest distance through the chain, m.
    reference: f64,
    /// Longest distance through the chain without strokes, m: the reference for the links of an arm.
    arm: f64,
    /// Links with solids.
    links: Vec<LinkSize>,
}

pub(super) fn suspects(robot: &Robot) -> Vec<SuspectUnit> {
    let sizes = Sizes::of(robot);
    let mut suspects = sizes.strokes();
    if !(sizes.reference > 0.0 && sizes.reference.is_finite()) {
        return suspects;
    }
    if let Some(all) = sizes.all_links() {
        suspects.push(all);
        return suspects;
    }
    let single: Vec<SuspectUnit> = sizes.links.iter().filter_map(|l| sizes.single(*l)).collect();
    if single.is_empty() {
        suspects.extend(sizes.small().or_else(|| sizes.far()));
    }
    suspects.extend(single);
    suspects
}

impl<'r> Sizes<'r> {
    fn of(robot: &'r Robot) -> Self {
        let chain = &robot.chain;
        let moved = |l: usize| chain.path(LinkId(l)).iter().any(|j| chain.joints()[j.0].kind.moves());
        let link = |l: usize| Some(LinkSize { link: LinkId(l), extent_m: extent(robot, l)?, is_moved: moved(l) });
        let (reference, arm) = (longest_distance(chain, true), longest_distance(chain, false));
        Self { chain, reference, arm, links: (0..robot.colliders.len()).filter_map(link).collect() }
    }

    fn moved(&self) -> impl Iterator<Item = f64> + '_ {
        self.links.iter().filter(|l| l.is_moved).map(|l| l.extent_m)
    }

    fn largest(&self) -> f64 {
        self.links.iter().fold(0.0, |m: f64, l| m.max(l.extent_m))
    }

    /// Factor by which the sum of the moved links' `extents` (m) is too large; `whole` is the number of moved links.
    fn times(&self, extents: &[f64], whole: usize) -> f64 {
        let together = extents.iter().sum::<f64>() * whole as f64 / extents.len() as f64;
        together / (LINK_SUM * self.arm)
    }

    /// Sizes of the moved links that are not far larger than the chain, m.
    fn ordinary(&self) -> Vec<f64> {
        self.moved().filter(|e| *e <= LARGE_IN_ARM * self.arm).collect()
    }

    /// True if links are as long as the distances between joints. The links of a gantry are as long as its strokes.
    fn is_arm(&self) -> bool {
        self.arm > 0.0 && self.arm.is_finite() && self.reference <= 3.0 * self.arm && self.moved().count() >= ARM
    }

    /// True if the moved links have the sizes of an arm, except for some that are far too large.
    fn is_arm_with_outliers(&self) -> bool {
        let (ordinary, moved) = (self.ordinary(), self.moved().count());
        self.is_arm() && 2 * ordinary.len() >= moved && factor::nearest(self.times(&ordinary, moved)).is_none()
    }

    /// Suspects all meshes of an arm by the same factor, or all of its joints.
    fn all_links(&self) -> Option<SuspectUnit> {
        let moved: Vec<f64> = self.moved().collect();
        if !self.is_arm() || self.is_arm_with_outliers() {
            return None;
        }
        let confusion = factor::nearest(self.times(&moved, moved.len()))?;
        let (largest, reference) = (self.largest(), self.arm);
        if confusion.factor < 1.0 && reference > FAR_M {
            let times = reference / (moved.iter().sum::<f64>() / LINK_SUM);
            return Some(self.joints(factor::nearest(times)?));
        }
        let reason = format!(
            "the meshes of the moved links add up to {:.4} m on a chain of {reference:.4} m, about {} times what they should: {}\n  \
             write: {}",
            moved.iter().sum::<f64>(),
            shown(confusion.factor),
            confusion.words,
            remedy(&confusion, true)
        );
        Some(self.suspect(SuspectQuantity::Meshes, None, Some(largest), confusion, reason))
    }

    /// Suspects one link that is far larger than the chain.
    fn single(&self, size: LinkSize) -> Option<SuspectUnit> {
        let LinkSize { link, extent_m, is_moved } = size;
        let in_arm = is_moved && self.is_arm_with_outliers();
        let bound = match (is_moved, in_arm) {
            (true, true) => LARGE_IN_ARM,
            (true, false) => LARGE,
            (false, _) => LARGE_AND_FIXED,
        };
        let reference = if in_arm { self.arm } else { self.reference };
        if !(extent_m > bound * reference && (in_arm || extent_m > LARGE_M)) {
            return None;
        }
        let confusion = factor::nearest(extent_m / (LINK * reference)).filter(|m| m.factor > 1.0)?;
        let name = &self.chain.links()[link.0];
        let reason = format!(
            "link `{name}` is {extent_m:.4} m large on a chain of {reference:.4} m: {}\n  write: {}",
            confusion.words,
            remedy(&confusion, false)
        );
        Some(self.suspect(SuspectQuantity::Meshes, Some(name.clone()), Some(extent_m), confusion, reason))
    }

    /// Suspects a model whose solids are all tiny compared with the chain.
    fn small(&self) -> Option<SuspectUnit> {
        let (largest, reference) = (self.largest(), self.reference);
        if !(largest > 0.0 && largest * SMALL < reference) {
            return None;
        }
        if reference > FAR_M {
            return Some(self.joints(factor::nearest(reference / ARM_M)?));
        }
        let confusion = factor::nearest(largest / (LINK * reference)).filter(|m| m.factor < 1.0)?;
        let reason = format!(
            "the largest solid is {largest:.1e} m on a chain of {reference:.4} m: {}, or joints in mm\n  write: {}, or <origin \
             xyz=\"…\"/> in metres",
            confusion.words,
            remedy(&confusion, true)
        );
        Some(self.suspect(SuspectQuantity::Meshes, None, Some(largest), confusion, reason))
    }

    /// Suspects the joints of a chain that is too large for a workshop, with solids that match it or without solids.
    fn far(&self) -> Option<SuspectUnit> {
        if self.reference <= FAR_M {
            return None;
        }
        Some(self.joints(factor::nearest(self.reference / ARM_M)?))
    }

    fn joints(&self, confusion: UnitConfusion) -> SuspectUnit {
        let reason = format!(
            "the chain is {:.4} m long: {}\n  write: <origin xyz=\"…\"/> in metres, {} times the numbers there",
            self.reference,
            confusion.words,
            confusion.remedy()
        );
        self.suspect(SuspectQuantity::Joints, None, None, confusion, reason)
    }

    /// Suspects prismatic joints with a stroke longer than a workshop.
    fn strokes(&self) -> Vec<SuspectUnit> {
        let joints = self.chain.joints().iter().filter(|j| j.kind == JointKind::Prismatic && j.mimic.is_none());
        let far = joints.filter_map(|j| Some((j, stroke(j.limits.lower, j.limits.upper).filter(|s| *s > FAR_M)?)));
        far.map(|(joint, metres)| {
            let name = &joint.name;
            let reason = format!(
                "the prismatic joint `{name}` travels {metres:.4} m: its limits look like mm, read as metres\n  write: <limit lower=\"…\" \
                 upper=\"…\"/> in metres"
            );
            SuspectUnit {
                of: SuspectQuantity::Stroke,
                link: None,
                joint: Some(name.clone()),
                extent_m: None,
                reference_m: Some(self.reference),
                looks_like: UnitLabel::Millimetre,
                read_as: UnitLabel::Metre,
                factor: 1000.0,
                reason,
            }
        })
        .collect()
    }

    fn suspect(
        &self,
        of: SuspectQuantity,
        link: Option<String>,
        extent_m: Option<f64>,
        confusion: UnitConfusion,
        reason: String,
    ) -> SuspectUnit {
        let UnitConfusion { factor, looks_like, read_as, .. } = confusion;
        SuspectUnit {
            of,
            link,
            joint: None,
            extent_m,
            reference_m: Some(self.reference),
            looks_like,
            read_as,
            factor,
            reason,
        }
    }
}

fn shown(factor: f64) -> String {
    format!("{}", (factor * 1e4).round() / 1e4)
}

/// The hint for a mesh that is `confusion.factor` times too large.
fn remedy(confusion: &UnitConfusion, all: bool) -> String {
    let by = confusion.remedy();
    match (confusion.looks_like, confusion.read_as) {
        (unit, UnitLabel::Metre) => {
            let alike = if all { "" } else { " where all meshes are so" };
            format!("<mesh filename=\"…\" scale=\"{by} {by} {by}\"/>, or --unit {}{alike}", unit.symbol())
        }
        (UnitLabel::AppliedTwice, unit) => {
            format!("meshes without the scale of {} (scale=\"1 1 1\"), or --unit m", unit.symbol())
        }
        (unit, _) => {
            format!(
                "a scale in <mesh filename=\"…\" scale=\"…\"/> that is {by} times the one there, or --unit {}",
                unit.symbol()
            )
        }
    }
}

/// Longest edge of the box around all solids of a link, in its frame, m.
fn extent(robot: &Robot, link: usize) -> Option<f64> {
    let around = robot.colliders[link].iter().fold(Aabb::EMPTY, |all, b| all.union(&b.shape.aabb(&b.in_link)));
    let extent = around.extent().max_element();
    (!around.is_empty() && extent.is_finite()).then_some(extent)
}

/// Largest absolute position of a prismatic joint, m.
fn stroke(lower: f64, upper: f64) -> Option<f64> {
    let farthest = lower.abs().max(upper.abs());
    farthest.is_finite().then_some(farthest)
}

/// The longest distance from the root to a leaf, m. Suspect strokes do not count.
fn longest_distance(chain: &Chain, strokes: bool) -> f64 {
    let stride = |id: &JointId| {
        let joint = &chain.joints()[id.0];
        let stroke = match joint.kind {
            JointKind::Prismatic if strokes => stroke(joint.limits.lower, joint.limits.upper).filter(|s| *s <= FAR_M),
            _ => None,
        };
        joint.origin.translation.length() + stroke.unwrap_or(0.0)
    };
    let distance = |leaf: &LinkId| chain.path(*leaf).iter().map(stride).sum::<f64>();
    chain.leaves().iter().map(distance).fold(0.0, f64::max)
}
