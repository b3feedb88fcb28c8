//! Upper bounds on how far joints move the points of a link.
//!
//! All bounds come from one walk along the chain from the link to the root ([`joint_reaches`]). A point within
//! `radius_m` of the link's origin is never farther from the origin of a joint's child frame than the reach:
//! `radius_m` plus the joint offsets and the strokes of the slides between them. A rotation by θ displaces the point
//! by at most the reach times θ, a slide by at most its own displacement.
//!
//! | function | bound on |
//! | --- | --- |
//! | [`motion_bound`] | the displacement per unit of each joint, at any configuration |
//! | [`max_motion_bounds`] | the same for the worst of several geometries, one number per entry of `q` |
//! | [`displacement_bound`] | the displacement along a straight joint-space segment |
//! | [`SpeedBound`] | speed and acceleration while all joints move at constant rates |
//!
//! ```
//! use elbowroom_kinematics::motion_bound::{displacement_bound, motion_bound};
//! use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
//!
//! let row = |joint: &str, a: f64| ClassicalRow {
//!     joint: joint.into(), kind: JointKind::Revolute, a, alpha: 0.0, d: 0.0, theta: 0.0, limits: Limits::symmetric(3.0),
//! };
//! let planar = Chain::from_dh("planar", &[row("shoulder", 0.5), row("elbow", 0.25)])?;
//! let tip = planar.tip();
//! // A tool of radius 0.25 m at the tip: the elbow moves it by 0.5 m per radian, the shoulder by 1 m per radian.
//! assert_eq!(motion_bound(&planar, tip, 0.25, &planar.path(tip)), [(1, 0.5), (0, 1.0)]);
//! assert_eq!(displacement_bound(&planar, tip, 0.25, &[0.0, 0.0], &[0.5, -1.0]), 1.0);
//! # Ok::<(), elbowroom_kinematics::ChainError>(())
//! ```

mod speed;

pub use speed::{JointRate, SpeedBound};

use crate::{Chain, JointCoupling, JointId, JointKind, LinkId};

/// A joint between the root and a link, and the reach of the geometry that the joint carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointReach {
    /// The joint.
    pub joint: JointId,
    /// The joint's kind.
    pub kind: JointKind,
    /// The joint's value as a function of `q`; `None` if it is fixed.
    pub coupling: Option<JointCoupling>,
    /// Upper bound of the distance of any point of the geometry from the origin of the joint's child frame, m.
    pub reach_m: f64,
}

impl JointReach {
    /// Largest displacement of a point per unit of the joint's own value: the reach (m per rad), or 1 (m per m) for a
    /// slide.
    pub fn lever_arm(&self) -> f64 {
        if self.kind == JointKind::Prismatic { 1.0 } else { self.reach_m }
    }
}

/// The joints from a link to the root, in that order, each with the reach of a geometry within `radius_m` of the
/// link's origin. `stroke_m` returns the largest distance of a slide from its zero; use [`max_stroke_m`] for any
/// configuration.
pub fn joint_reaches<'c>(
    chain: &'c Chain,
    link: LinkId,
    radius_m: f64,
    stroke_m: impl Fn(JointId) -> f64 + 'c,
) -> impl Iterator<Item = JointReach> + 'c {
    let (mut at, mut reach_m) = (link, radius_m);
    std::iter::from_fn(move || {
        let id = chain.parent_joint(at)?;
        let joint = &chain.joints()[id.0];
        let found = JointReach { joint: id, kind: joint.kind, coupling: chain.coupling(id), reach_m };
        reach_m += joint.origin.translation.length();
        if joint.kind == JointKind::Prismatic {
            reach_m += stroke_m(id);
        }
        at = joint.parent;
        Some(found)
    })
}

/// Largest distance (m) of a slide from its zero within the limits; infinite if a limit is infinite.
pub fn max_stroke_m(chain: &Chain, joint: JointId) -> f64 {
    let Some(c) = chain.coupling(joint) else { return 0.0 };
    let limits = chain.joints()[chain.active_joints()[c.index].0].limits;
    limits.lower.abs().max(limits.upper.abs()) * c.multiplier.abs() + c.offset.abs()
}

/// Largest displacement per unit of each joint of `joints` of any point within `radius_m` of the link's origin, at
/// any configuration within the limits.
///
/// Returns (index in `q`, m per rad or m), from the link to the root. Joints that are not between the root and the
/// link are left out. A mimic joint has an entry of its own, with the index of the joint that it follows.
pub fn motion_bound(chain: &Chain, link: LinkId, radius_m: f64, joints: &[JointId]) -> Vec<(usize, f64)> {
    joint_reaches(chain, link, radius_m, |id| max_stroke_m(chain, id))
        .filter(|r| joints.contains(&r.joint))
        .filter_map(|r| r.coupling.map(|c| (c.index, r.lever_arm() * c.multiplier.abs())))
        .collect()
}

/// Largest displacement of any point of several geometries per unit of each entry of `q` (m per rad or m), at any
/// configuration.
///
/// A geometry is a link and the radius (m) around the link's origin that encloses it. The contribution of a mimic
/// joint is added to the contribution of the joint that it follows.
pub fn max_motion_bounds(chain: &Chain, geometries: impl IntoIterator<Item = (LinkId, f64)>) -> Vec<f64> {
    let mut bounds = vec![0.0; chain.dof()];
    let mut scratch = bounds.clone();
    update_max_motion_bounds(chain, geometries, &mut bounds, &mut scratch);
    bounds
}

/// Like [`max_motion_bounds`], written to `bounds` without allocation; `scratch` is overwritten. `bounds` and
/// `scratch` have one entry per entry of `q`.
pub fn update_max_motion_bounds(
    chain: &Chain,
    geometries: impl IntoIterator<Item = (LinkId, f64)>,
    bounds: &mut [f64],
    scratch: &mut [f64],
) {
    bounds.fill(0.0);
    for (link, radius_m) in geometries {
        scratch.fill(0.0);
        for reach in joint_reaches(chain, link, radius_m, |id| max_stroke_m(chain, id)) {
            if let Some(c) = reach.coupling {
                scratch[c.index] += reach.lever_arm() * c.multiplier.abs();
            }
        }
        bounds.iter_mut().zip(&*scratch).for_each(|(most, own)| *most = most.max(*own));
    }
}

/// Upper bound of the distance (m) that any point within `radius_m` of the link's origin travels while all joints
/// move together along the straight segment between two configurations.
///
/// Along a fraction of the segment, the distance is at most that fraction of the bound. Like [`motion_bound`],
/// except that slides count with their largest distance from zero on the segment. NaN if a value is NaN.
pub fn displacement_bound(chain: &Chain, link: LinkId, radius_m: f64, from: &[f64], to: &[f64]) -> f64 {
    let ends = |coupling: Option<JointCoupling>| {
        let ends = coupling.and_then(|c| Some((c, [*from.get(c.index)?, *to.get(c.index)?])));
        ends.map_or([0.0; 2], |(c, ends)| ends.map(|q| c.multiplier * q + c.offset))
    };
    let stroke_m = |id| {
        let [a, b] = ends(chain.coupling(id)).map(f64::abs);
        a.max(b)
    };
    let mut travel = 0.0;
    for r in joint_reaches(chain, link, radius_m, stroke_m) {
        let values = ends(r.coupling);
        let change = (values[1] - values[0]).abs();
        travel += if r.kind == JointKind::Prismatic { change } else { change * r.reach_m };
    }
    travel
}
