//! All pairs that a collision query of robots and objects must check.

use elbowroom_kinematics::LinkId;

use crate::{GeometryId, ObjectId, Robot, RobotId};

/// All pairs that a collision query must check, in a fixed order.
///
/// - Two links of one robot are a pair unless [`Robot::exclusion`] names a reason: they are adjacent, disabled by
///   the SRDF, or no joint moves one relative to the other.
/// - Two links of different robots, and a link and an object, are a pair if a joint moves one of them.
/// - Two objects are never a pair.
pub fn collision_pairs(robots: &[&Robot], objects: usize) -> Vec<(GeometryId, GeometryId)> {
    let mut list = Vec::new();
    let links: Vec<(usize, LinkId)> =
        robots.iter().enumerate().flat_map(|(r, robot)| robot.links_with_colliders().map(move |l| (r, l))).collect();
    let id = |(robot, link)| GeometryId::Link { robot: RobotId(robot), link };
    let movable = |(robot, link): (usize, LinkId)| robots[robot].chain.is_movable(link);
    for (i, &a) in links.iter().enumerate() {
        for &b in &links[i + 1..] {
            let meet = if a.0 == b.0 { robots[a.0].links_can_meet(a.1, b.1) } else { movable(a) || movable(b) };
            if meet {
                list.push((id(a), id(b)));
            }
        }
        if movable(a) {
            list.extend((0..objects).map(|o| (id(a), GeometryId::Object(ObjectId(o)))));
        }
    }
    list
}
