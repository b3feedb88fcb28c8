//! The pair rules on the example arm, with the colliders of its upper arm removed.

use elbowroom_kinematics::{Chain, JointKind, LinkId};
use elbowroom_robot::{Exclusion, GeometryId, ObjectId, Robot, RobotId, collision_pairs, example};

const BASE: LinkId = LinkId(0);
const COLUMN: LinkId = LinkId(1);
const UPPER_ARM: LinkId = LinkId(2);
const FOREARM: LinkId = LinkId(3);

fn arm() -> Robot {
    let mut robot = example::arm().unwrap();
    robot.colliders[UPPER_ARM.0].clear();
    robot
}

#[test]
fn adjacent_links_are_no_pair_and_two_moving_joints_make_one() {
    let mut robot = arm();
    assert_eq!(robot.exclusion(BASE, COLUMN), Some(Exclusion::Adjacent));
    assert!(robot.links_can_meet(COLUMN, FOREARM), "two joints with a link without colliders between them");
    assert!(robot.joined_without_colliders(COLUMN, FOREARM) && !robot.joined_without_colliders(BASE, FOREARM));
    assert!(robot.links_can_meet(BASE, FOREARM) && robot.links_can_meet(FOREARM, BASE));
    robot.disabled_pairs.push((FOREARM, BASE, "Never".into()));
    assert_eq!(robot.exclusion(BASE, FOREARM), Some(Exclusion::Srdf("Never".into())));
    // Across a fixed joint and a link without colliders lies one moving joint, so the links are adjacent.
    let mut joints = robot.chain.joints().to_vec();
    joints[2].kind = JointKind::Fixed;
    robot.chain = Chain::new("stiff", robot.chain.links().to_vec(), joints).unwrap();
    assert_eq!(robot.exclusion(COLUMN, FOREARM), Some(Exclusion::Adjacent));
    assert_eq!(robot.exclusion(UPPER_ARM, FOREARM), Some(Exclusion::NoJointBetween));
}

#[test]
fn pairs_are_listed_once_where_a_joint_moves_one_of_the_two() {
    let robot = arm();
    let list = collision_pairs(&[&robot, &robot], 2);
    // Per arm 2 pairs of links and 2 moving links against 2 objects; 3 · 3 − 1 between the arms (both bases are fixed).
    assert_eq!(list.len(), 2 * 2 + 2 * 2 * 2 + 8);
    let link = |robot, link| GeometryId::Link { robot: RobotId(robot), link };
    assert_eq!(list[0], (link(0, BASE), link(0, FOREARM)));
    assert!(!list.contains(&(link(0, BASE), link(1, BASE))));
    assert!(list.contains(&(link(1, COLUMN), GeometryId::Object(ObjectId(1)))));
    let mut unique = list.clone();
    unique.sort();
    unique.dedup();
    assert_eq!(unique.len(), list.len());
}
