//! Link pairs that touch in the rest pose although no collider lies between them.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::collides;

use crate::{RSequence, Robot};

/// Number of configurations that are sampled to see whether the links separate.
const SAMPLES: u32 = 200;

/// Two links of one robot that are a collision pair, have no link with colliders between them, and touch in the rest
/// pose.
///
/// The model does not show whether this is an error. The links of a wrist whose axes intersect, or fingers drawn
/// closed, may be designed to overlap; then an SRDF should disable the pair. The fraction of configurations in which
/// they touch is a hint: it is 1 if they overlap by design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RestPoseContact {
    /// One link.
    pub a: LinkId,
    /// The other link.
    pub b: LinkId,
    /// Number of sampled configurations in which they touch.
    pub contacts: u32,
    /// Number of sampled configurations, which are spread evenly over the joint limits and are always the same.
    pub samples: u32,
}

impl RestPoseContact {
    /// True if the links touch in every sampled configuration.
    pub fn always(&self) -> bool {
        self.contacts == self.samples
    }
}

/// Finds the pairs that touch in the rest pose.
///
/// `rest` are the joint values in rad or m, one per [active joint](elbowroom_kinematics::Chain::active_joints). The
/// result is empty if their number does not match the chain or a value is not finite.
///
/// ```
/// use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_robot::{Collider, Robot, rest_pose_contacts};
/// use elbowroom_spatial::{Pose, Vec3};
/// // Two fingers that slide along x on a palm without colliders: closed at 0, open at 0.1 m each.
/// let finger = |i: usize| Joint {
///     name: format!("finger_{i}"),
///     kind: JointKind::Prismatic,
///     parent: LinkId(0),
///     child: LinkId(i),
///     origin: Pose::IDENTITY,
///     axis: if i == 1 { Vec3::X } else { -Vec3::X },
///     limits: Limits::range(0.0, 0.1),
///     mimic: None,
/// };
/// let links = ["palm", "left", "right"].map(String::from).to_vec();
/// let mut robot = Robot::new(Chain::new("gripper", links, vec![finger(1), finger(2)])?);
/// for finger in [1, 2] {
///     let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.01) });
///     robot.colliders[finger].push(Collider { name: String::new(), shape, in_link: Pose::IDENTITY });
/// }
/// let closed = rest_pose_contacts(&robot, &[0.0, 0.0]);
/// assert_eq!((closed[0].a, closed[0].b, closed[0].always()), (LinkId(1), LinkId(2), false));
/// assert!(rest_pose_contacts(&robot, &[0.05, 0.0]).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rest_pose_contacts(robot: &Robot, rest: &[f64]) -> Vec<RestPoseContact> {
    let mut state = ChainState::new(&robot.chain);
    if rest.len() != state.q.len() || !rest.iter().all(|v| v.is_finite()) {
        return Vec::new();
    }
    state.q.copy_from_slice(rest);
    robot.chain.forward(&mut state);
    let mut found: Vec<RestPoseContact> = candidates(robot)
        .filter(|(a, b)| touch(robot, &state, *a, *b))
        .map(|(a, b)| RestPoseContact { a, b, contacts: 0, samples: SAMPLES })
        .collect();
    if found.is_empty() {
        return found;
    }
    let sequence = RSequence::new(robot.chain.dof());
    for n in 0..SAMPLES {
        sequence.set_state(&robot.chain, &mut state, u64::from(n), 0);
        for pair in &mut found {
            pair.contacts += u32::from(touch(robot, &state, pair.a, pair.b));
        }
    }
    found
}

/// Collision pairs of links without a link with colliders between them.
fn candidates(robot: &Robot) -> impl Iterator<Item = (LinkId, LinkId)> + '_ {
    let links: Vec<LinkId> = robot.links_with_colliders().collect();
    let pairs: Vec<_> = links.iter().enumerate().flat_map(|(i, a)| links[i + 1..].iter().map(|b| (*a, *b))).collect();
    pairs.into_iter().filter(|(a, b)| robot.joined_without_colliders(*a, *b) && robot.links_can_meet(*a, *b))
}

/// True if any colliders of two links touch.
pub(crate) fn touch(robot: &Robot, state: &ChainState, a: LinkId, b: LinkId) -> bool {
    let in_root = |l: LinkId| state.link_in_root(l);
    robot.colliders[a.0].iter().any(|x| {
        let x_in_root = in_root(a) * x.in_link;
        robot.colliders[b.0].iter().any(|y| collides(&x.shape, &x_in_root, &y.shape, &(in_root(b) * y.in_link)))
    })
}
