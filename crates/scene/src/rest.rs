//! Links without a solid between them that touch where the robot rests: built that way, or a mistake.

use elbowroom_kinematics::{ChainState, LinkId};
use elbowroom_proximity::collides;

use crate::Robot;
use crate::matrix::RSequence;
use crate::pairs::{joined_without_solids, links_can_meet};

/// States of the joint space that are looked at to see whether the links come apart.
const SAMPLES: u32 = 200;

/// Two links of one robot that are a pair, have no link with solids between them, and touch where the robot rests.
///
/// Nothing in the model tells whether this is a fault. The links of a wrist whose axes cross, or fingers drawn closed, may be
/// meant to overlap; then an SRDF should disable the pair. How often they touch in the joint space is a hint: always, where
/// they overlap by design.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RestingContact {
    /// One link.
    pub a: LinkId,
    /// The other.
    pub b: LinkId,
    /// In how many of `samples` states of the joint space they touch.
    pub contacts: u32,
    /// States that were looked at, spread evenly over the joint limits; the same ones each time.
    pub samples: u32,
}

impl RestingContact {
    /// True where no state was found in which the links are apart.
    pub fn always(&self) -> bool {
        self.contacts == self.samples
    }
}

/// The pairs that touch at `rest`: joint values in rad or m, one per [active
/// joint](elbowroom_kinematics::Chain::active_joints). Empty where the number of values does not fit the chain.
///
/// ```
/// use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_scene::{Body, Robot, pairs};
/// use elbowroom_spatial::{Pose, Vec3};
/// // Two fingers that slide along x on a palm without solids: closed at 0, open at 0.1 m each.
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
///     robot.bodies[finger].push(Body { name: String::new(), shape, in_link: Pose::IDENTITY });
/// }
/// let closed = pairs::resting_contacts(&robot, &[0.0, 0.0]);
/// assert_eq!((closed[0].a, closed[0].b, closed[0].always()), (LinkId(1), LinkId(2), false));
/// assert!(pairs::resting_contacts(&robot, &[0.05, 0.0]).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resting_contacts(robot: &Robot, rest: &[f64]) -> Vec<RestingContact> {
    let mut state = ChainState::new(&robot.chain);
    if rest.len() != state.q.len() || !rest.iter().all(|v| v.is_finite()) {
        return Vec::new();
    }
    state.q.copy_from_slice(rest);
    robot.chain.forward(&mut state);
    let mut found: Vec<RestingContact> = candidates(robot)
        .filter(|(a, b)| touch(robot, &state, *a, *b))
        .map(|(a, b)| RestingContact { a, b, contacts: 0, samples: SAMPLES })
        .collect();
    if found.is_empty() {
        return found;
    }
    let sequence = RSequence::new(robot.chain.dof());
    for n in 0..SAMPLES {
        sequence.put(&robot.chain, &mut state, u64::from(n), 0);
        for pair in &mut found {
            pair.contacts += u32::from(touch(robot, &state, pair.a, pair.b));
        }
    }
    found
}

/// Pairs of links with no link with solids between them. Adjacent links are none.
fn candidates(robot: &Robot) -> impl Iterator<Item = (LinkId, LinkId)> + '_ {
    let links: Vec<LinkId> = (0..robot.bodies.len()).filter(|l| !robot.bodies[*l].is_empty()).map(LinkId).collect();
    let pairs: Vec<_> = links.iter().enumerate().flat_map(|(i, a)| links[i + 1..].iter().map(|b| (*a, *b))).collect();
    pairs.into_iter().filter(|(a, b)| joined_without_solids(robot, *a, *b) && links_can_meet(robot, *a, *b))
}

fn touch(robot: &Robot, state: &ChainState, a: LinkId, b: LinkId) -> bool {
    let in_root = |l: LinkId| state.link_in_root(l);
    robot.bodies[a.0].iter().any(|x| {
        let at_x = in_root(a) * x.in_link;
        robot.bodies[b.0].iter().any(|y| collides(&x.shape, &at_x, &y.shape, &(in_root(b) * y.in_link)))
    })
}
