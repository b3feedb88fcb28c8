//! Links that always touch where they are joined: meshes that overlap at a wrist, a piston in its cylinder.

use std::sync::Arc;

use elbowroom_kinematics::{ChainState, JointId, LinkId};
use elbowroom_proximity::contact::{TriangleContact, for_each_triangle_contact, triangle_surface};
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_spatial::{Pose, Vec3};

use crate::rest_pose::touch;
use crate::{Collider, RSequence, Robot};

/// Configurations that are sampled.
const SAMPLES: u64 = 1000;
/// Largest number of moving joints between links that several joint values move against each other.
const MOST_JOINTS: usize = 2;
/// The largest share of the smaller link's size that contacts may lie from the joint: 1 is as far as that link extends.
const MOST_REACH: f64 = 1.0;
/// The largest share of it by which the farthest contact of one configuration may lie farther from the joint than that of another.
const MOST_SPREAD: f64 = 0.25;
/// Error of the triangles of round shapes, as a share of the diagonal of their boxes: some twenty segments around.
const CHORD_ERROR: f64 = 0.005;

/// Links that reach farther from their own origin, or are farther from the root link, are not compared, m: by rounding all their
/// triangles would touch.
const LARGEST_M: f64 = 1e4;
/// A pair with more contacts in all configurations together is given up, so that the search ends soon.
const MOST_CONTACTS: usize = 2_000_000;

/// Two links of one robot that touch in every sampled configuration, and nowhere but at a joint between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointContact {
    /// One link.
    pub a: LinkId,
    /// The other link.
    pub b: LinkId,
    /// The moving joint between them at which they meet.
    pub joint: JointId,
    /// In each configuration the farthest contact lies between these distances from the origin of the joint, m.
    pub farthest_m: (f64, f64),
    /// Number of sampled configurations, spread evenly over the joint limits. The same configurations each time.
    pub samples: u64,
}

/// The pairs of links that always touch where they are joined, such as a flange that is drawn into the wrist, or a piston in its
/// cylinder: not by the robot's motion but by its model. `start` are joint values in rad or m, one per
/// [active joint](elbowroom_kinematics::Chain::active_joints); empty where their number does not match the chain or a value is not
/// finite.
///
/// A pair is found where all of this holds:
///
/// - It is tested ([`Robot::links_can_meet`]). At most two moving joints lie between the links, or one joint value alone moves all
///   joints between them (mimic joints follow it), as for a balancing cylinder.
/// - Their surfaces touch at `start` and in each of 1000 configurations over the joint limits, with two million contacts in all at most.
/// - For one of the joints between them, the same in all configurations, no contact is farther from its origin than the diagonal of the
///   smaller link's box.
/// - Unless one joint value alone moves them, the farthest contacts of any two configurations differ in that distance by no more
///   than a quarter of the diagonal. So links that touch at the joint, and in some configurations farther out as well, are not
///   found.
///
/// ```
/// use elbowroom_robot::{example, joint_contacts};
/// let arm = example::arm()?;
/// assert!(joint_contacts(&arm, &vec![0.0; arm.chain.dof()]).is_empty());
/// # Ok::<(), elbowroom_kinematics::ChainError>(())
/// ```
pub fn joint_contacts(robot: &Robot, start: &[f64]) -> Vec<JointContact> {
    let mut state = ChainState::new(&robot.chain);
    if start.len() != state.q.len() || !start.iter().all(|v| v.is_finite()) {
        return Vec::new();
    }
    state.q.copy_from_slice(start);
    robot.chain.forward(&mut state);
    let touching = candidates(robot).filter(|(a, b)| touch(robot, &state, *a, *b));
    let mut candidates: Vec<Candidate> = touching.filter_map(|(a, b)| Candidate::new(robot, a, b)).collect();
    let mut workspace = Workspace::new();
    candidates.retain_mut(|pair| pair.measure(&state, &mut workspace));
    let sequence = RSequence::new(robot.chain.dof());
    for n in 0..SAMPLES {
        if candidates.is_empty() {
            break;
        }
        sequence.set_state(&robot.chain, &mut state, n, 0);
        candidates.retain_mut(|pair| pair.measure(&state, &mut workspace));
    }
    candidates.into_iter().filter_map(Candidate::found).collect()
}

/// Pairs of links that a query tests although few joints lie between them.
fn candidates(robot: &Robot) -> impl Iterator<Item = (LinkId, LinkId)> + '_ {
    let links: Vec<LinkId> = robot.links_with_colliders().collect();
    let pairs: Vec<_> = links.iter().enumerate().flat_map(|(i, a)| links[i + 1..].iter().map(|b| (*a, *b))).collect();
    let is_close = |joints: &[JointId]| joints.len() <= MOST_JOINTS || follow_one_value(robot, joints);
    pairs.into_iter().filter(move |(a, b)| is_close(&moving_joints(robot, *a, *b)) && robot.links_can_meet(*a, *b))
}

fn moving_joints(robot: &Robot, a: LinkId, b: LinkId) -> Vec<JointId> {
    let mut joints = robot.chain.joints_between(a, b);
    joints.retain(|j| robot.chain.joints()[j.0].kind.moves());
    joints
}

/// True where one joint value alone moves the joints.
fn follow_one_value(robot: &Robot, joints: &[JointId]) -> bool {
    let value = |j: &JointId| robot.chain.mimic_source(*j).map_or(*j, |mimic| mimic.joint);
    joints.iter().map(value).all(|v| joints.first().map(value) == Some(v))
}

/// A pair that was in contact in all configurations so far.
struct Candidate<'r> {
    robot: &'r Robot,
    links: [LinkId; 2],
    /// Per link, its surfaces with their poses in the link.
    surfaces: [Vec<(Arc<TriMesh>, Pose)>; 2],
    /// The moving joints between the links at which all contacts were so far.
    joints: Vec<JointRegion>,
    /// Diagonal of the box of the smaller link, m.
    size_m: f64,
    /// The largest difference between the farthest contacts of two configurations, m.
    most_spread_m: f64,
    /// Number of contacts so far.
    contacts: usize,
}

/// How far from a joint two links touch.
struct JointRegion {
    joint: JointId,
    /// Least and largest distance of a configuration's farthest contact from the joint's origin, m.
    farthest_m: (f64, f64),
}

impl<'r> Candidate<'r> {
    /// `None` where a link has a surface without triangles, or is too large.
    fn new(robot: &'r Robot, a: LinkId, b: LinkId) -> Option<Self> {
        if ![a, b].iter().all(|l| robot.link_radius(*l) <= LARGEST_M) {
            return None;
        }
        let region = |joint| JointRegion { joint, farthest_m: (f64::INFINITY, 0.0) };
        let joints = moving_joints(robot, a, b);
        let follow_one_value = follow_one_value(robot, &joints);
        let joints = joints.into_iter().map(region).collect();
        let chord_error_m = |c: &Collider| CHORD_ERROR * c.shape.aabb(&Pose::IDENTITY).extent().length();
        let surface = |c: &Collider| Some((triangle_surface(&c.shape, chord_error_m(c))?, c.in_link));
        let of_link = |l: LinkId| robot.colliders[l.0].iter().map(surface).collect::<Option<Vec<_>>>();
        let diagonal_m = |l: LinkId| {
            let boxes = robot.colliders[l.0].iter().map(|c| c.shape.aabb(&c.in_link));
            boxes.reduce(|x, y| x.union(&y)).map_or(0.0, |b| b.extent().length())
        };
        let size_m = diagonal_m(a).min(diagonal_m(b));
        let most_spread_m = if follow_one_value { f64::INFINITY } else { MOST_SPREAD * size_m };
        let surfaces = [of_link(a)?, of_link(b)?];
        Some(Self { robot, links: [a, b], surfaces, joints, size_m, most_spread_m, contacts: 0 })
    }

    /// Takes the contacts of a configuration; false where there is none, or one away from the joints.
    fn measure(&mut self, state: &ChainState, workspace: &mut Workspace) -> bool {
        if !self.links.iter().all(|l| state.link_in_root(*l).translation.length() <= LARGEST_M) {
            return false;
        }
        let contacts = self.contacts(state, workspace);
        self.contacts += contacts.len();
        if self.contacts > MOST_CONTACTS {
            return false;
        }
        let (chain, size_m, most_spread_m) = (&self.robot.chain, self.size_m, self.most_spread_m);
        self.joints.retain_mut(|region| {
            let joint = &chain.joints()[region.joint.0];
            let origin = (state.link_in_root(joint.parent) * joint.origin).translation;
            let farthest_m = contacts.iter().map(|p| origin.distance(*p)).fold(0.0, f64::max);
            let (least, most) = &mut region.farthest_m;
            (*least, *most) = (least.min(farthest_m), most.max(farthest_m));
            *most <= MOST_REACH * size_m && *most - *least <= most_spread_m
        });
        !contacts.is_empty() && !self.joints.is_empty()
    }

    /// The points at which the links touch, in the root link.
    fn contacts(&self, state: &ChainState, workspace: &mut Workspace) -> Vec<Vec3> {
        let in_root = self.links.map(|l| state.link_in_root(l));
        let mut contacts = Vec::new();
        for (x, x_in_link) in &self.surfaces[0] {
            let x_in_root = in_root[0] * *x_in_link;
            for (y, y_in_link) in &self.surfaces[1] {
                let y_in_root = in_root[1] * *y_in_link;
                let found = |contact: TriangleContact| contacts.extend(contact.segment);
                if for_each_triangle_contact(x, &x_in_root, y, &y_in_root, workspace, found) {
                    // Which one is inside is not said: the smaller one.
                    let extent = |mesh: &TriMesh| mesh.aabb().extent().length();
                    let (inner, at) = if extent(x) < extent(y) { (x, x_in_root) } else { (y, y_in_root) };
                    contacts.extend(inner.vertices().iter().map(|p| at.transform_point(*p)));
                }
            }
        }
        contacts
    }

    fn found(self) -> Option<JointContact> {
        let nearest = self.joints.into_iter().min_by(|a, b| a.farthest_m.1.total_cmp(&b.farthest_m.1))?;
        let [a, b] = self.links;
        Some(JointContact { a, b, joint: nearest.joint, farthest_m: nearest.farthest_m, samples: SAMPLES })
    }
}
