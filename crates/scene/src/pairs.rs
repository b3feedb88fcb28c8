//! Which solids of a cell can meet, and how far they can move.

use elbowroom_kinematics::{Chain, JointId, JointKind, LinkId};
use elbowroom_spatial::Aabb;

use crate::{Body, Reason, Robot};

pub use crate::first_contacts::FirstContacts;
pub use crate::member::Member;
pub use crate::rest::{RestingContact, resting_contacts};

/// All pairs that a collision query has to look at, in a fixed order.
///
/// Links of one robot are a pair unless they are adjacent (at most one moving joint between them, directly or through
/// fixed joints and links without solids), disabled by the SRDF, or not moved against each other by any joint. Links of different robots, and link and object, are a
/// pair where a joint moves one of them. Two objects are none.
pub fn pairs(robots: &[&Robot], objects: usize) -> Vec<(Member, Member)> {
    let mut list = Vec::new();
    let members: Vec<(usize, LinkId)> = robots
        .iter()
        .enumerate()
        .flat_map(|(r, robot)| {
            (0..robot.bodies.len()).filter(|l| !robot.bodies[*l].is_empty()).map(move |l| (r, LinkId(l)))
        })
        .collect();
    for (i, &(ra, a)) in members.iter().enumerate() {
        for &(rb, b) in &members[i + 1..] {
            let meet = if ra == rb {
                links_can_meet(robots[ra], a, b)
            } else {
                is_moved(&robots[ra].chain, a) || is_moved(&robots[rb].chain, b)
            };
            if meet {
                list.push((Member::Link { robot: ra, link: a }, Member::Link { robot: rb, link: b }));
            }
        }
        if is_moved(&robots[ra].chain, a) {
            list.extend((0..objects).map(|o| (Member::Link { robot: ra, link: a }, Member::Object(o))));
        }
    }
    list
}

/// True where two links of one robot are a pair.
pub fn links_can_meet(robot: &Robot, a: LinkId, b: LinkId) -> bool {
    why_no_pair(robot, a, b).is_none()
}

/// Why two links of one robot are no pair; `None` where they are one.
pub(crate) fn why_no_pair(robot: &Robot, a: LinkId, b: LinkId) -> Option<Reason> {
    let chain = &robot.chain;
    let between = joints_between(chain, a, b);
    match between.iter().filter(|j| chain.joints()[j.0].kind.moves()).count() {
        0 => return Some(Reason::NoJointBetween),
        1 if nothing_between(robot, a, b, &between) => return Some(Reason::Adjacent),
        _ => {}
    }
    let same = |p: &&(LinkId, LinkId, String)| (p.0, p.1) == (a, b) || (p.0, p.1) == (b, a);
    robot.disabled_pairs.iter().find(same).map(|p| Reason::Srdf(p.2.clone()))
}

/// True where two links have no link with solids between them, however many joints there are: what they overlap by may be
/// how the robot is built.
pub(crate) fn joined_without_solids(robot: &Robot, a: LinkId, b: LinkId) -> bool {
    nothing_between(robot, a, b, &joints_between(&robot.chain, a, b))
}

/// True where no link with solids stands between two links that `between` joins.
fn nothing_between(robot: &Robot, a: LinkId, b: LinkId, between: &[JointId]) -> bool {
    let links = between.iter().flat_map(|j| [robot.chain.joints()[j.0].parent, robot.chain.joints()[j.0].child]);
    links.filter(|l| *l != a && *l != b).all(|l| robot.bodies[l.0].is_empty())
}

pub(crate) fn is_moved(chain: &Chain, link: LinkId) -> bool {
    chain.path(link).iter().any(|j| chain.joints()[j.0].kind.moves())
}

/// The joints on the way from one link to the other.
pub(crate) fn joints_between(chain: &Chain, a: LinkId, b: LinkId) -> Vec<JointId> {
    let (a, b) = (chain.path(a), chain.path(b));
    let common = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    a[common..].iter().chain(&b[common..]).copied().collect()
}

/// Farthest that any point of the link can move per unit of each joint on `joints`, as (index in q, m per rad or m).
///
/// A point carried by a revolute joint moves by at most its distance from the axis times the turn; that distance is at
/// most the sum of the offsets, strokes and radius beyond the joint.
pub fn motion_bound(chain: &Chain, link: LinkId, radius_m: f64, joints: &[JointId]) -> Vec<(usize, f64)> {
    let mut bound: Vec<(usize, f64)> = Vec::new();
    let mut reach = radius_m;
    for id in chain.path(link).iter().rev() {
        let joint = &chain.joints()[id.0];
        if joint.kind.moves() && joints.contains(id) {
            let (source, multiplier) = chain.mimic_source(*id).map_or((*id, 1.0), |m| (m.joint, m.multiplier));
            let lever = if joint.kind == JointKind::Prismatic { 1.0 } else { reach };
            if let Some(index) = chain.q_index(source) {
                bound.push((index, lever * multiplier.abs()));
            }
        }
        reach += joint.origin.translation.length();
        if joint.kind == JointKind::Prismatic {
            let source = chain.mimic_source(*id).map_or(*id, |m| m.joint);
            let stroke = chain.joints()[source.0].limits;
            let (scale, offset) = chain.mimic_source(*id).map_or((1.0, 0.0), |m| (m.multiplier.abs(), m.offset.abs()));
            reach += stroke.lower.abs().max(stroke.upper.abs()) * scale + offset;
        }
    }
    bound
}

/// No point of the link within `radius_m` of its origin travels farther than this, m, while all joints go straight and together
/// from one configuration to another; in a share of that no farther than the same share. As [`motion_bound`], but slides
/// count as far out as they are on that way, not as far as they can be.
pub fn farthest(chain: &Chain, link: LinkId, radius_m: f64, from: &[f64], to: &[f64]) -> f64 {
    let (mut reach, mut travel) = (radius_m, 0.0);
    for id in chain.path(link).iter().rev() {
        let joint = &chain.joints()[id.0];
        let (source, multiplier, offset) =
            chain.mimic_source(*id).map_or((*id, 1.0, 0.0), |m| (m.joint, m.multiplier, m.offset));
        let ends =
            chain.q_index(source).and_then(|i| Some([*from.get(i)?, *to.get(i)?])).filter(|_| joint.kind.moves());
        let values = ends.map_or([0.0; 2], |ends| ends.map(|q| multiplier * q + offset));
        let change = (values[1] - values[0]).abs();
        travel += if joint.kind == JointKind::Prismatic { change } else { change * reach };
        reach += joint.origin.translation.length();
        if joint.kind == JointKind::Prismatic {
            reach += values[0].abs().max(values[1].abs());
        }
    }
    travel
}

/// Distance (m) of the farthest point of the bodies from their link's origin, at most.
pub fn radius(bodies: &[Body]) -> f64 {
    let corner = |b: &Aabb| b.min.abs().max(b.max.abs()).length();
    bodies.iter().map(|b| corner(&b.shape.aabb(&b.in_link))).fold(0.0, f64::max)
}
