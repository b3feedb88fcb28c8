//! Lengths: solids against the chain that carries them, and the chain against a workshop.
//!
//! The chain's own dimensions are the reference `R`: the longest way from the root to a leaf through the origins and
//! strokes of its joints. Of 35 published arms the largest edges of the boxes of all moved links together are 1.0 to 1.65
//! times that way without strokes: near enough to each other to tell factors of 2.5 apart. A chain of few links has no such rule; there only what is
//! far too large or too small is in doubt.

use elbowroom_kinematics::{Chain, JointId, JointKind, LinkId};
use elbowroom_scene::Robot;
use elbowroom_spatial::Aabb;

use super::UnitDoubt;
use super::factor::{self, Mistake};

/// All moved links together, in longest ways through the chain, where the units are right.
const TOGETHER: f64 = 1.3;
/// So many moved links with solids make an arm that this is known of.
const ARM: usize = 4;
/// A link this many times larger than the chain is long is in doubt,
const LARGE: f64 = 10.0;
/// or this many times where the others of an arm are as they should be.
const LARGE_IN_ARM: f64 = 3.2;
/// So is one that stands still, which may be a hall, from here on.
const LARGE_AND_FIXED: f64 = 100.0;
/// Nothing of a few links smaller than this (m) is in doubt of being too large.
const LARGE_M: f64 = 5.0;
/// A link is commonly about a third of its chain.
const LINK: f64 = 0.35;
/// A model whose largest solid is smaller than the chain divided by this is in doubt.
const SMALL: f64 = 200.0;
/// A chain (m) or a stroke (m) beyond this is in doubt; an arm is commonly 1.5 m.
const FAR_M: f64 = 50.0;
const ARM_M: f64 = 1.5;

struct Sizes<'r> {
    chain: &'r Chain,
    /// Longest way through the chain, m.
    reference: f64,
    /// The same without strokes, m: what the links of an arm are compared with.
    arm: f64,
    /// Links with solids: largest edge of the box around them, m, and whether a joint moves the link.
    links: Vec<(LinkId, f64, bool)>,
}

pub(super) fn doubts(robot: &Robot) -> Vec<UnitDoubt> {
    let sizes = Sizes::of(robot);
    let mut doubts = sizes.strokes();
    if !(sizes.reference > 0.0 && sizes.reference.is_finite()) {
        return doubts;
    }
    if let Some(all) = sizes.all_links() {
        doubts.push(all);
        return doubts;
    }
    let single: Vec<UnitDoubt> = sizes.links.iter().filter_map(|l| sizes.single(*l)).collect();
    if single.is_empty() {
        doubts.extend(sizes.small().or_else(|| sizes.far()));
    }
    doubts.extend(single);
    doubts
}

impl<'r> Sizes<'r> {
    fn of(robot: &'r Robot) -> Self {
        let chain = &robot.chain;
        let moved = |l: usize| chain.path(LinkId(l)).iter().any(|j| chain.joints()[j.0].kind.moves());
        let link = |l: usize| Some((LinkId(l), extent(robot, l)?, moved(l)));
        let (reference, arm) = (longest_way(chain, true), longest_way(chain, false));
        Self { chain, reference, arm, links: (0..robot.bodies.len()).filter_map(link).collect() }
    }

    fn moved(&self) -> impl Iterator<Item = f64> + '_ {
        self.links.iter().filter(|l| l.2).map(|l| l.1)
    }

    fn largest(&self) -> f64 {
        self.links.iter().fold(0.0, |m: f64, l| m.max(l.1))
    }

    /// How many times too large moved links of `extents` (m) are together; `whole` of them make the arm.
    fn times(&self, extents: &[f64], whole: usize) -> f64 {
        let together = extents.iter().sum::<f64>() * whole as f64 / extents.len() as f64;
        together / (TOGETHER * self.arm)
    }

    /// The moved links that are not far larger than the chain, m.
    fn ordinary(&self) -> Vec<f64> {
        self.moved().filter(|e| *e <= LARGE_IN_ARM * self.arm).collect()
    }

    /// True where links are as long as the ways between joints. Those of a gantry are as long as its strokes.
    fn is_arm(&self) -> bool {
        self.arm > 0.0 && self.arm.is_finite() && self.reference <= 3.0 * self.arm && self.moved().count() >= ARM
    }

    /// True where the moved links are those of an arm, but for some that are far too large.
    fn is_arm_but_for_some(&self) -> bool {
        let (ordinary, moved) = (self.ordinary(), self.moved().count());
        self.is_arm() && 2 * ordinary.len() >= moved && factor::nearest(self.times(&ordinary, moved)).is_none()
    }

    /// All meshes of an arm by the same factor, or all of its joints.
    fn all_links(&self) -> Option<UnitDoubt> {
        let moved: Vec<f64> = self.moved().collect();
        if !self.is_arm() || self.is_arm_but_for_some() {
            return None;
        }
        let mistake = factor::nearest(self.times(&moved, moved.len()))?;
        let (largest, reference) = (self.largest(), self.arm);
        if mistake.factor < 1.0 && reference > FAR_M {
            let times = reference / (moved.iter().sum::<f64>() / TOGETHER);
            return Some(self.joints(factor::nearest(times)?));
        }
        let reason = format!(
            "the meshes of the moved links add up to {:.4} m on a chain of {reference:.4} m, about {} times what they should: {}\n  \
             write: {}",
            moved.iter().sum::<f64>(),
            shown(mistake.factor),
            mistake.words,
            remedy(&mistake, true)
        );
        Some(self.doubt("meshes", None, Some(largest), mistake, reason))
    }

    /// One link that is far larger than the chain.
    fn single(&self, (link, extent_m, moved): (LinkId, f64, bool)) -> Option<UnitDoubt> {
        let in_arm = moved && self.is_arm_but_for_some();
        let bound = match (moved, in_arm) {
            (true, true) => LARGE_IN_ARM,
            (true, false) => LARGE,
            (false, _) => LARGE_AND_FIXED,
        };
        let reference = if in_arm { self.arm } else { self.reference };
        if !(extent_m > bound * reference && (in_arm || extent_m > LARGE_M)) {
            return None;
        }
        let mistake = factor::nearest(extent_m / (LINK * reference)).filter(|m| m.factor > 1.0)?;
        let name = &self.chain.links()[link.0];
        let reason = format!(
            "link `{name}` is {extent_m:.4} m large on a chain of {reference:.4} m: {}\n  write: {}",
            mistake.words,
            remedy(&mistake, false)
        );
        Some(self.doubt("meshes", Some(name.clone()), Some(extent_m), mistake, reason))
    }

    /// Too few links for an arm, and all of them tiny.
    fn small(&self) -> Option<UnitDoubt> {
        let (largest, reference) = (self.largest(), self.reference);
        if !(largest > 0.0 && largest * SMALL < reference) {
            return None;
        }
        if reference > FAR_M {
            return Some(self.joints(factor::nearest(reference / ARM_M)?));
        }
        let mistake = factor::nearest(largest / (LINK * reference)).filter(|m| m.factor < 1.0)?;
        let reason = format!(
            "the largest solid is {largest:.1e} m on a chain of {reference:.4} m: {}, or joints in mm\n  write: {}, or <origin \
             xyz=\"…\"/> in metres",
            mistake.words,
            remedy(&mistake, true)
        );
        Some(self.doubt("meshes", None, Some(largest), mistake, reason))
    }

    /// Solids fit the chain, but both are too large for a workshop; or there are no solids.
    fn far(&self) -> Option<UnitDoubt> {
        if self.reference <= FAR_M {
            return None;
        }
        Some(self.joints(factor::nearest(self.reference / ARM_M)?))
    }

    fn joints(&self, mistake: Mistake) -> UnitDoubt {
        let reason = format!(
            "the chain is {:.4} m long: {}\n  write: <origin xyz=\"…\"/> in metres, {} times the numbers there",
            self.reference,
            mistake.words,
            mistake.remedy()
        );
        self.doubt("joints", None, None, mistake, reason)
    }

    /// Slides that go farther than a workshop is long.
    fn strokes(&self) -> Vec<UnitDoubt> {
        let joints = self.chain.joints().iter().filter(|j| j.kind == JointKind::Prismatic && j.mimic.is_none());
        let far = joints.filter_map(|j| Some((j, stroke(j.limits.lower, j.limits.upper).filter(|s| *s > FAR_M)?)));
        far.map(|(joint, metres)| {
            let name = &joint.name;
            let reason = format!(
                "the slide `{name}` goes {metres:.4} m: its limits look like mm, read as metres\n  write: <limit lower=\"…\" \
                 upper=\"…\"/> in metres"
            );
            UnitDoubt {
                of: "stroke",
                link: None,
                joint: Some(name.clone()),
                extent_m: None,
                reference_m: Some(self.reference),
                looks_like: "mm",
                read_as: "m",
                factor: 1000.0,
                reason,
            }
        })
        .collect()
    }

    fn doubt(
        &self,
        of: &'static str,
        link: Option<String>,
        extent_m: Option<f64>,
        mistake: Mistake,
        reason: String,
    ) -> UnitDoubt {
        let Mistake { factor, looks_like, read_as, .. } = mistake;
        UnitDoubt {
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

/// What to write where a mesh is `mistake.factor` times too large.
fn remedy(mistake: &Mistake, all: bool) -> String {
    let by = mistake.remedy();
    match (mistake.looks_like, mistake.read_as) {
        (unit, "m") => {
            let alike = if all { "" } else { " where all meshes are so" };
            format!("<mesh filename=\"…\" scale=\"{by} {by} {by}\"/>, or --unit {unit}{alike}")
        }
        ("applied twice", unit) => {
            format!("meshes without the scale of {unit} (scale=\"1 1 1\"), or --unit m")
        }
        (unit, _) => {
            format!("a scale in <mesh filename=\"…\" scale=\"…\"/> that is {by} times the one there, or --unit {unit}")
        }
    }
}

/// Longest edge of the box around all solids of a link, in its frame.
fn extent(robot: &Robot, link: usize) -> Option<f64> {
    let around = robot.bodies[link].iter().fold(Aabb::EMPTY, |all, b| all.union(&b.shape.aabb(&b.in_link)));
    let extent = around.extent().max_element();
    (!around.is_empty() && extent.is_finite()).then_some(extent)
}

/// Farthest from 0 that a slide goes, m.
fn stroke(lower: f64, upper: f64) -> Option<f64> {
    let farthest = lower.abs().max(upper.abs());
    farthest.is_finite().then_some(farthest)
}

/// The longest way from the root to a leaf, m. Strokes that are in doubt themselves are no reference.
fn longest_way(chain: &Chain, strokes: bool) -> f64 {
    let stride = |id: &JointId| {
        let joint = &chain.joints()[id.0];
        let stroke = match joint.kind {
            JointKind::Prismatic if strokes => stroke(joint.limits.lower, joint.limits.upper).filter(|s| *s <= FAR_M),
            _ => None,
        };
        joint.origin.translation.length() + stroke.unwrap_or(0.0)
    };
    let way = |leaf: &LinkId| chain.path(*leaf).iter().map(stride).sum::<f64>();
    chain.leaves().iter().map(way).fold(0.0, f64::max)
}
