//! Which links of one robot are a collision pair, and why others are not.

use elbowroom_kinematics::{JointId, LinkId};

use crate::Robot;

/// Why two links of one robot are no collision pair.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Exclusion {
    /// At most one moving joint between them, directly or through fixed joints and links without colliders.
    Adjacent,
    /// No joint moves one against the other.
    NoJointBetween,
    /// The SRDF disables the pair, for its own reason.
    Srdf(String),
}

impl Robot {
    /// True if two links are a collision pair: no [`Robot::exclusion`] applies.
    pub fn links_can_meet(&self, a: LinkId, b: LinkId) -> bool {
        self.exclusion(a, b).is_none()
    }

    /// Why two links are no collision pair; `None` if they are one.
    pub fn exclusion(&self, a: LinkId, b: LinkId) -> Option<Exclusion> {
        let between = self.chain.joints_between(a, b);
        match between.iter().filter(|j| self.chain.joints()[j.0].kind.moves()).count() {
            0 => return Some(Exclusion::NoJointBetween),
            1 if self.no_collider_between(a, b, &between) => return Some(Exclusion::Adjacent),
            _ => {}
        }
        let same = |p: &&(LinkId, LinkId, String)| (p.0, p.1) == (a, b) || (p.0, p.1) == (b, a);
        self.disabled_pairs.iter().find(same).map(|p| Exclusion::Srdf(p.2.clone()))
    }

    /// True if no link with colliders lies between two links, however many joints do. Such links may be designed to
    /// overlap.
    pub fn joined_without_colliders(&self, a: LinkId, b: LinkId) -> bool {
        self.no_collider_between(a, b, &self.chain.joints_between(a, b))
    }

    /// True if no link with colliders lies between two links that the joints `between` connect.
    fn no_collider_between(&self, a: LinkId, b: LinkId, between: &[JointId]) -> bool {
        let joints = between.iter().map(|j| &self.chain.joints()[j.0]);
        let links = joints.flat_map(|j| [j.parent, j.child]);
        links.filter(|l| *l != a && *l != b).all(|l| self.colliders[l.0].is_empty())
    }
}
