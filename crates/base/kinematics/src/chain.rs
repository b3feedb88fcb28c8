//! A kinematic chain: a constant tree of links and joints.

use std::collections::HashMap;

use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::forward_step::ForwardStep;
use crate::{Joint, JointCoupling, JointId, JointKind, LinkId};

/// An immutable tree of links and joints, built and checked by [`Chain::new`].
///
/// Links and joints keep the order of the file. The vector `q` has one value per *independent* joint (neither fixed
/// nor mimic), also in file order: see [`Chain::active_joints`].
#[derive(Debug, Clone)]
pub struct Chain {
    pub(crate) name: String,
    pub(crate) links: Vec<String>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) link_by_name: HashMap<String, LinkId>,
    pub(crate) joint_by_name: HashMap<String, JointId>,
    pub(crate) root: LinkId,
    pub(crate) parent_joint: Vec<Option<JointId>>,
    /// Joints from the root outwards.
    pub(crate) order: Vec<JointId>,
    pub(crate) active: Vec<JointId>,
    /// Coupling of each joint; `None` if it is fixed.
    pub(crate) couplings: Vec<Option<JointCoupling>>,
    /// The joints of `order`, prepared for the forward pass.
    pub(crate) steps: Vec<ForwardStep>,
}

impl Chain {
    /// The robot's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of the links, in file order.
    pub fn links(&self) -> &[String] {
        &self.links
    }

    /// The joints, in file order.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Number of independent joints (neither fixed nor mimic), which is the length of `q`.
    pub fn dof(&self) -> usize {
        self.active.len()
    }

    /// The independent joints, in the order of `q`.
    pub fn active_joints(&self) -> &[JointId] {
        &self.active
    }

    /// The joints from the root outwards: every joint follows the joint that carries its parent.
    pub fn topological_order(&self) -> &[JointId] {
        &self.order
    }

    /// The link with this name.
    pub fn link(&self, name: &str) -> Option<LinkId> {
        self.link_by_name.get(name).copied()
    }

    /// The joint with this name.
    pub fn joint(&self, name: &str) -> Option<JointId> {
        self.joint_by_name.get(name).copied()
    }

    /// The link without a parent.
    pub fn root(&self) -> LinkId {
        self.root
    }

    /// The joint whose child is the link; `None` for the root and for links that are not in this chain.
    pub fn parent_joint(&self, link: LinkId) -> Option<JointId> {
        self.parent_joint.get(link.0).copied().flatten()
    }

    /// The links without children, in file order.
    pub fn leaves(&self) -> Vec<LinkId> {
        let mut is_leaf = vec![true; self.links.len()];
        for joint in &self.joints {
            is_leaf[joint.parent.0] = false;
        }
        (0..self.links.len()).filter(|&i| is_leaf[i]).map(LinkId).collect()
    }

    /// The leaf with the most non-mimic joints (including fixed joints) between it and the root; among equals, the first
    /// in the file.
    pub fn tip(&self) -> LinkId {
        let mut best = (self.root, 0);
        for leaf in self.leaves() {
            let joints = self.path(leaf).into_iter().filter(|j| self.joints[j.0].mimic.is_none()).count();
            if joints > best.1 {
                best = (leaf, joints);
            }
        }
        best.0
    }

    /// The joints from the root to the link, in that order; empty for the root.
    pub fn path(&self, link: LinkId) -> Vec<JointId> {
        let mut path = Vec::new();
        let mut at = link;
        while let Some(joint) = self.parent_joint(at) {
            path.push(joint);
            at = self.joints[joint.0].parent;
        }
        path.reverse();
        path
    }

    /// The joints on the path from one link to the other: first the joints above the first link only, from the root
    /// outwards, then the joints above the second link only.
    pub fn joints_between(&self, a: LinkId, b: LinkId) -> Vec<JointId> {
        let (a, b) = (self.path(a), self.path(b));
        let common = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
        a[common..].iter().chain(&b[common..]).copied().collect()
    }

    /// True if a joint between the root and the link moves it.
    pub fn is_movable(&self, link: LinkId) -> bool {
        let mut at = link;
        while let Some(id) = self.parent_joint(at) {
            let joint = &self.joints[id.0];
            if joint.kind.moves() {
                return true;
            }
            at = joint.parent;
        }
        false
    }

    /// Lower bounds of `q`, rad or m; −∞ if unlimited.
    pub fn lower(&self) -> Vec<f64> {
        self.active.iter().map(|j| self.joints[j.0].limits.lower).collect()
    }

    /// Upper bounds of `q`, rad or m; +∞ if unlimited.
    pub fn upper(&self) -> Vec<f64> {
        self.active.iter().map(|j| self.joints[j.0].limits.upper).collect()
    }

    /// Index of the joint's value in `q`; `None` for fixed and mimic joints.
    pub fn q_index(&self, joint: JointId) -> Option<usize> {
        self.active.iter().position(|&j| j == joint)
    }

    /// The independent joint that a mimic joint follows, through mimics of mimics, with the total multiplier and offset
    /// (rad or m); `None` if the joint is independent or fixed.
    pub fn mimic_source(&self, joint: JointId) -> Option<crate::Mimic> {
        self.joints.get(joint.0)?.mimic?;
        let c = self.couplings[joint.0]?;
        Some(crate::Mimic { joint: self.active[c.index], multiplier: c.multiplier, offset: c.offset })
    }

    /// The joint's value as a function of `q`, through mimics of mimics; `None` if the joint is fixed or not in this
    /// chain.
    pub fn coupling(&self, joint: JointId) -> Option<JointCoupling> {
        self.couplings.get(joint.0).copied().flatten()
    }

    /// Value (rad or m) of any joint at `q`: its own entry, the value that it mimics, or 0 if it is fixed. NaN if `q` is
    /// too short.
    pub fn joint_value(&self, joint: JointId, q: &[f64]) -> f64 {
        self.coupling(joint).map_or(0.0, |c| c.value(q))
    }

    /// The pose of a joint's child in its parent at the joint value `value` (rad or m).
    pub fn child_in_parent(&self, joint: JointId, value: f64) -> Pose {
        let j = &self.joints[joint.0];
        match j.kind {
            JointKind::Fixed => j.origin,
            JointKind::Prismatic => j.origin * Pose::from_translation(j.axis * value),
            JointKind::Revolute | JointKind::Continuous => {
                j.origin * Pose::new(Rotation::from_axis_angle(j.axis, value), Vec3::ZERO)
            }
        }
    }
}
