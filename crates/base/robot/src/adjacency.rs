//! Collision pairs of the links of one robot, and the reasons for excluded pairs.

use elbowroom_kinematics::{JointId, LinkId};

use crate::Robot;

/// Why two links of one robot are not a collision pair.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Exclusion {
    /// At most one moving joint lies between the links, directly or through fixed joints and links without colliders.
    Adjacent,
    /// No joint moves one link relative to the other.
    NoJointBetween,
    /// The SRDF disables the pair, for its own reason.
    Srdf(String),
}

impl Robot {
    /// True if two links are a collision pair: no [`Robot::exclusion`] applies.
    pub fn links_can_meet(&self, a: LinkId, b: LinkId) -> bool {
        self.exclusion(a, b).is_none()
    }

    /// Why two links are not a collision pair; `None` if they are one.
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

    /// True if no link with colliders lies between two links, for any number of joints between them. Such links may be
    /// designed to overlap.
    pub fn joined_without_colliders(&self, a: LinkId, b: LinkId) -> bool {
        self.no_collider_between(a, b, &self.chain.joints_between(a, b))
    }

    /// True if no link with colliders lies between two links that are connected by the joints `between`.
    fn no_collider_between(&self, a: LinkId, b: LinkId, between: &[JointId]) -> bool {
        let joints = between.iter().map(|j| &self.chain.joints()[j.0]);
        let links = joints.flat_map(|j| [j.parent, j.child]);
        links.filter(|l| *l != a && *l != b).all(|l| self.colliders[l.0].is_empty())
    }
}
