//! Triangles of a robot's links and random joint values, to compare a robot with its copy in another format.

use elbowroom_kinematics::{Chain, JointKind};
use elbowroom_proximity::Shape;
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::Xorshift;

/// Joint values within the limits, and within 7 rad or m.
pub fn random_q(random: &mut Xorshift, chain: &Chain) -> Vec<f64> {
    let bounds = chain.lower().into_iter().zip(chain.upper());
    bounds
        .map(|(lo, hi)| (0.5 + 0.5 * random.between(-1.0, 1.0)) * (hi.min(7.0) - lo.max(-7.0)) + lo.max(-7.0))
        .collect()
}

/// The triangles of the meshes, in the frame of their link.
pub fn corners(colliders: &[Collider]) -> Vec<[Vec3; 3]> {
    let of = |b: &Collider| match &b.shape {
        Shape::Mesh(m) => {
            let corner = |i: u32| b.in_link.transform_point(m.vertices()[i as usize]);
            m.triangles().iter().map(|t| t.map(corner)).collect::<Vec<_>>()
        }
        _ => Vec::new(),
    };
    colliders.iter().flat_map(of).collect()
}

/// Largest distance between corners of triangles in the same order.
pub fn corners_apart(a: &[[Vec3; 3]], b: &[[Vec3; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

/// Colliders of a link and of the links fixed to it at the same pose.
pub fn solids(robot: &Robot, link: &str) -> Vec<[Vec3; 3]> {
    let chain = &robot.chain;
    let mut all = corners(&robot.colliders[chain.link(link).unwrap().0]);
    for joint in chain.joints().iter().filter(|j| j.kind == JointKind::Fixed && chain.links()[j.parent.0] == link) {
        let below = solids(robot, &chain.links()[joint.child.0]);
        all.extend(below.into_iter().map(|t| t.map(|v| joint.origin.transform_point(v))));
    }
    all
}
