//! Which joints of a robot the map's axes are, and how links hang on them.

use elbowroom_kinematics::{Chain, ChainState, JointKind, LinkId};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::AxisError;

/// More axes than this are refused.
pub const MOST_JOINTS: usize = 8;

/// What the joints do that are not axes of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Others<'a> {
    /// They may be anywhere: what they carry is enclosed in all its places.
    Any,
    /// They stay where these joint values (rad or m, all of the robot's) have them.
    Held(&'a [f64]),
}

/// Why there can be no map of a robot.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobotMapError {
    /// No joint, or too many.
    #[error("a map has 1 to {MOST_JOINTS} joints, not {0}: name fewer of them")]
    Count(usize),
    /// A joint that the robot does not have, or that is named twice.
    #[error("joint {joint} of {dof} is no axis, or one for the second time: name each joint once, counted from 0")]
    Joint {
        /// As it was given.
        joint: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// An axis cannot be cut into cells.
    #[error(transparent)]
    Axis(#[from] AxisError),
    /// The values at which other joints are held.
    #[error("the other joints are held at {given} values, the robot has {dof}: give one finite number per joint")]
    Held {
        /// How many values were given.
        given: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// A solid or the base has a place that is not finite.
    #[error("{0} has a place or a size that is NaN, infinite or beyond 1e5 m: give metres")]
    Place(String),
    /// The map would not fit into the memory that it may use.
    #[error("the map needs more than {mib} MiB: make the steps larger, or allow more memory")]
    Memory {
        /// What was allowed.
        mib: usize,
    },
}

/// One joint of the chain as the map drives it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mover {
    /// Number of the map's axis.
    pub axis: usize,
    /// Where the joint is: the frame of its child.
    pub child: LinkId,
    /// Unit, in the child's frame.
    pub along: Vec3,
    pub turns: bool,
    /// Of the axis's value.
    pub multiplier: f64,
}

/// A joint that is no axis of the map and may be anywhere.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loose {
    pub child: LinkId,
    pub parent: LinkId,
    /// Of the child at value 0, in the parent's frame.
    pub origin: Pose,
    /// Unit, in the child's frame.
    pub along: Vec3,
    /// Values of a slide, metres; `None` for a joint that turns.
    pub slide: Option<[f64; 2]>,
}

/// A link: what moves it.
#[derive(Debug, Clone)]
pub(super) struct Hanging {
    pub movers: Vec<Mover>,
    /// Joints that may be anywhere, from the root on, and the fixed ones between and behind them.
    pub loose: Vec<Loose>,
    /// The last link above the first of them: all that is above moves with the map alone.
    pub carrier: LinkId,
}

/// A robot as the map drives it.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    pub chain: Chain,
    pub base_in_world: Pose,
    /// Places of the axes among the joint values.
    pub joints: Vec<usize>,
    /// Values of the others.
    pub held: Vec<f64>,
    pub links: Vec<Hanging>,
}

impl Drive {
    pub fn new(
        chain: &Chain,
        base_in_world: Pose,
        joints: &[usize],
        others: Others<'_>,
    ) -> Result<Self, RobotMapError> {
        let dof = chain.dof();
        if joints.is_empty() || joints.len() > MOST_JOINTS {
            return Err(RobotMapError::Count(joints.len()));
        }
        if let Some(at) = (0..joints.len()).find(|&i| joints[i] >= dof || joints[..i].contains(&joints[i])) {
            return Err(RobotMapError::Joint { joint: joints[at], dof });
        }
        let held = match others {
            Others::Any => middle(chain),
            Others::Held(q) if q.len() == dof && q.iter().all(|x| x.is_finite()) => q.to_vec(),
            Others::Held(q) => return Err(RobotMapError::Held { given: q.len(), dof }),
        };
        if !base_in_world.is_finite() {
            return Err(RobotMapError::Place("the robot's base".into()));
        }
        let any = others == Others::Any;
        let links = (0..chain.links().len()).map(|link| hanging(chain, LinkId(link), joints, any)).collect();
        Ok(Self { chain: chain.clone(), base_in_world, joints: joints.to_vec(), held, links })
    }

    /// A state for [`Drive::place`].
    pub fn state(&self) -> ChainState {
        let mut state = ChainState::new(&self.chain);
        state.q.copy_from_slice(&self.held);
        self.chain.forward(&mut state);
        state
    }

    /// Puts the map's joints somewhere.
    pub fn place(&self, state: &mut ChainState, q: &[f64]) {
        for (&joint, &value) in self.joints.iter().zip(q) {
            state.q[joint] = value;
        }
        self.chain.forward(state);
    }

    /// The first axis, as a frame whose z lies along it.
    pub fn base_axis(&self) -> Pose {
        let movers = self.links.iter().flat_map(|l| &l.movers);
        let Some(first) = movers.into_iter().find(|m| m.axis == 0) else { return self.base_in_world };
        let child = self.link_in_world(&self.state(), first.child);
        let along = child.transform_vector(first.along);
        let base = self.base_in_world;
        // The base's own directions where they fit: angles are then those of the joint.
        let upright = base.transform_vector(Vec3::Z).dot(along) > 1.0 - 1e-12;
        let rotation = if upright { base.rotation } else { Rotation::from_z(along) };
        Pose::new(rotation, child.translation)
    }

    pub fn link_in_world(&self, state: &ChainState, link: LinkId) -> Pose {
        self.base_in_world * state.link_in_root(link)
    }
}

/// Joint values in the middle of their ranges; 0 where there is none.
fn middle(chain: &Chain) -> Vec<f64> {
    let middle = |(low, high): (f64, f64)| if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { 0.0 };
    chain.lower().into_iter().zip(chain.upper()).map(middle).collect()
}

fn hanging(chain: &Chain, link: LinkId, axes: &[usize], any: bool) -> Hanging {
    let mut out = Hanging { movers: Vec::new(), loose: Vec::new(), carrier: chain.root() };
    for id in chain.path(link) {
        let joint = &chain.joints()[id.0];
        let mimic = chain.mimic_source(id);
        let source = mimic.map_or(id, |m| m.joint);
        let (multiplier, offset) = mimic.map_or((1.0, 0.0), |m| (m.multiplier, m.offset));
        let value = chain.q_index(source).filter(|_| joint.kind.moves());
        let axis = value.and_then(|value| axes.iter().position(|&a| a == value));
        match axis {
            Some(axis) if out.loose.is_empty() => {
                let turns = joint.kind.turns();
                out.movers.push(Mover { axis, child: joint.child, along: joint.axis, turns, multiplier });
                out.carrier = joint.child;
            }
            // Behind a joint that may be anywhere, an axis of the map is one more of those.
            Some(_) => out.loose.push(loose(chain, id, multiplier, offset)),
            None if any && value.is_some() => out.loose.push(loose(chain, id, multiplier, offset)),
            None if out.loose.is_empty() => out.carrier = joint.child,
            None => out.loose.push(fixed(chain, id)),
        }
    }
    out
}

fn loose(chain: &Chain, id: elbowroom_kinematics::JointId, multiplier: f64, offset: f64) -> Loose {
    let joint = &chain.joints()[id.0];
    let source = chain.mimic_source(id).map_or(id, |m| m.joint);
    let limits = chain.joints()[source.0].limits;
    let ends = [limits.lower, limits.upper].map(|value| multiplier * value + offset);
    let slide = (joint.kind == JointKind::Prismatic).then_some([ends[0].min(ends[1]), ends[0].max(ends[1])]);
    Loose { child: joint.child, parent: joint.parent, origin: joint.origin, along: joint.axis, slide }
}

/// A joint that does not move, between or behind those that do: a slide of no length.
fn fixed(chain: &Chain, id: elbowroom_kinematics::JointId) -> Loose {
    let joint = &chain.joints()[id.0];
    Loose { child: joint.child, parent: joint.parent, origin: joint.origin, along: Vec3::Z, slide: Some([0.0; 2]) }
}
