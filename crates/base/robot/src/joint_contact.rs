//! Links that touch at the joint that connects them: meshes that overlap at a wrist, a piston in its cylinder, a
//! lever at its pin.

use std::sync::Arc;

use elbowroom_kinematics::{ChainState, JointId, LinkId};
use elbowroom_proximity::contact::{TriangleContact, for_each_triangle_contact, triangle_surface};
use elbowroom_proximity::{TriMesh, Workspace};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::rest_pose::touch;
use crate::{Collider, RSequence, Robot};

/// Number of sampled configurations.
const SAMPLES: u64 = 1000;
/// Largest number of moving joints between the links if several joint values move them relative to each other.
const MOST_JOINTS: usize = 2;
/// Largest number of moving joints between the links if a mimic joint is among them: a linkage.
const MOST_LINKAGE_JOINTS: usize = 3;
/// Largest distance of a contact from the joint, as a fraction of the smaller link's size: 1 is as far as that link
/// extends.
const MOST_REACH: f64 = 1.0;
/// Largest difference between the farthest contacts of two configurations, in distance from the joint, as a fraction
/// of the smaller link's size.
const MOST_SPREAD: f64 = 0.25;
/// Largest extent of all contacts at a pivot, on either link, as a fraction of the smaller link's size.
const PIVOT_EXTENT: f64 = 0.5;
/// Smallest fraction of the configurations in which links touch at a pivot.
const PIVOT_SHARE: f64 = 0.5;
/// Largest difference between axes that count as the same, m and rad.
const SAME_AXIS: f64 = 1e-6;
/// Error of the triangles of round shapes, as a fraction of the diagonal of their boxes: about twenty segments
/// around.
const CHORD_ERROR: f64 = 0.005;

/// Largest distance (m) of a link's points from its own origin, and of that origin from the root link. Farther links
/// are not compared: because of rounding, all their triangles would touch.
const LARGEST_M: f64 = 1e4;
/// Largest number of contacts of a pair in all configurations together. A pair with more is dropped, so that the
/// search ends soon.
const MOST_CONTACTS: usize = 2_000_000;

/// Two links of one robot that touch because of their model, not because of the robot's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointContact {
    /// One link.
    pub a: LinkId,
    /// The other link.
    pub b: LinkId,
    /// The kind of contact.
    pub kind: JointContactKind,
    /// The moving joint between them that is nearest to the contacts.
    pub joint: JointId,
    /// Range (m), over the configurations, of the distance between the nearest contact and the origin of the joint.
    pub nearest_m: (f64, f64),
    /// Range (m), over the configurations, of the distance between the farthest contact and the origin of the joint.
    pub farthest_m: (f64, f64),
    /// Number of sampled configurations in which they touch.
    pub contacts: u64,
    /// Number of sampled configurations, which are spread evenly over the joint limits and are always the same.
    pub samples: u64,
}

/// Why a contact belongs to the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointContactKind {
    /// The links touch in every configuration, and only at the joint.
    AtJoint,
    /// The links touch in every configuration, always at the joint and in some configurations also farther out. They
    /// turn against each other about one axis, or a mimic joint is between them, so they are joined like links that a
    /// joint connects directly.
    Linkage,
    /// One joint value moves the links through mimic joints. In at least half of its values they touch, always at the
    /// same place of each link: the pivot at which a linkage is closed, such as the eye of a piston rod.
    Pivot,
}

/// Finds the pairs of links that touch at the joint between them because of the model, not because of the robot's
/// motion: for example a flange that is drawn into the wrist, a piston in its cylinder or a lever at its pin.
///
/// `start` are joint values in rad or m, one per [active joint](elbowroom_kinematics::Chain::active_joints). The
/// result is empty if their number does not match the chain or a value is not finite.
///
/// A pair is found if it is tested ([`Robot::links_can_meet`]) and one of the following holds in 1000 configurations
/// over the joint limits, with at most two million contacts in all. Distances are from the origin of one joint
/// between the links, the same joint in all configurations; the size is the diagonal of the smaller link's box.
///
/// - [`AtJoint`](JointContactKind::AtJoint): the links touch in all configurations and at `start`, no contact is
///   farther than the size, and at most two moving joints lie between them. The distances of the farthest contacts
///   of any two configurations differ by at most a quarter of the size, so links that touch at the joint and in some
///   configurations also farther out are not found. If one joint value alone moves all joints between the links
///   (mimic joints follow it), as for a balancing cylinder, there may be more joints and the contact may move along
///   the stroke.
/// - [`Linkage`](JointContactKind::Linkage): the links touch in all configurations and at `start`. All joints
///   between them turn about one axis, or at most three lie between them and one of these is a mimic joint. The
///   distance of the nearest contact is at most the size, and varies by at most a quarter of it. Since the links
///   always touch, testing them gives no information about the contacts farther out.
/// - [`Pivot`](JointContactKind::Pivot): one joint value moves the links, through a mimic joint. They touch in at
///   least half of the configurations. On either link, all contacts of all configurations lie in a box with a
///   diagonal of half the size.
///
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
    // At a pivot the links need not touch at the start.
    let may_be = |a, b| closes_linkage(robot, &moving_joints(robot, a, b)) || touch(robot, &state, a, b);
    let candidates = candidates(robot).filter(|(a, b)| may_be(*a, *b));
    let mut candidates: Vec<Candidate> = candidates.filter_map(|(a, b)| Candidate::new(robot, a, b, &state)).collect();
    let mut workspace = Workspace::new();
    candidates.retain_mut(|pair| pair.measure(&state, &mut workspace));
    for pair in &mut candidates {
        (pair.touching, pair.apart) = (0, 0);
    }
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

/// Pairs of links that a query tests although only few joints lie between them.
fn candidates(robot: &Robot) -> impl Iterator<Item = (LinkId, LinkId)> + '_ {
    let links: Vec<LinkId> = robot.links_with_colliders().collect();
    let pairs: Vec<_> = links.iter().enumerate().flat_map(|(i, a)| links[i + 1..].iter().map(|b| (*a, *b))).collect();
    let is_close = |joints: &[JointId]| {
        let most = if has_mimic(robot, joints) { MOST_LINKAGE_JOINTS } else { MOST_JOINTS };
        joints.len() <= most || follow_one_value(robot, joints)
    };
    pairs.into_iter().filter(move |(a, b)| is_close(&moving_joints(robot, *a, *b)) && robot.links_can_meet(*a, *b))
}

fn moving_joints(robot: &Robot, a: LinkId, b: LinkId) -> Vec<JointId> {
    let mut joints = robot.chain.joints_between(a, b);
    joints.retain(|j| robot.chain.joints()[j.0].kind.moves());
    joints
}

/// True if one joint value alone moves the joints.
fn follow_one_value(robot: &Robot, joints: &[JointId]) -> bool {
    let value = |j: &JointId| robot.chain.mimic_source(*j).map_or(*j, |mimic| mimic.joint);
    joints.iter().map(value).all(|v| joints.first().map(value) == Some(v))
}

fn has_mimic(robot: &Robot, joints: &[JointId]) -> bool {
    joints.iter().any(|j| robot.chain.mimic_source(*j).is_some())
}

/// True if the links at the ends of the joints may meet at the pivot that closes a linkage.
fn closes_linkage(robot: &Robot, joints: &[JointId]) -> bool {
    joints.len() > 1 && has_mimic(robot, joints) && follow_one_value(robot, joints)
}

/// True if all joints turn about one axis. If this holds in one configuration, it holds in all.
fn share_axis(robot: &Robot, joints: &[JointId], state: &ChainState) -> bool {
    let axis = |j: &JointId| {
        let joint = &robot.chain.joints()[j.0];
        let in_root = state.link_in_root(joint.parent) * joint.origin;
        joint.kind.turns().then(|| (in_root.translation, in_root.transform_vector(joint.axis)))
    };
    let axes: Option<Vec<_>> = joints.iter().map(axis).collect();
    let Some(axes) = axes else { return false };
    let Some((origin, direction)) = axes.first() else { return false };
    let is_same = |(o, d): &(Vec3, Vec3)| {
        d.cross(*direction).length() <= SAME_AXIS && (*o - *origin).cross(*direction).length() <= SAME_AXIS
    };
    axes.iter().all(is_same)
}

/// A pair that may be joined, according to all configurations so far.
struct Candidate<'r> {
    robot: &'r Robot,
    links: [LinkId; 2],
    /// Surfaces of each link, with their poses in the link.
    surfaces: [Vec<(Arc<TriMesh>, Pose)>; 2],
    /// The moving joints between the links, with the distances of the contacts.
    joints: Vec<JointRegion>,
    /// Diagonal of the box of the smaller link, m.
    size_m: f64,
    /// Largest allowed difference between the farthest contacts of two configurations, m.
    most_spread_m: f64,
    /// The kinds that are still possible.
    may_be_at_joint: bool,
    may_be_linkage: bool,
    may_be_pivot: bool,
    /// Box of all contacts on each link, in the frame of the link.
    boxes: [Option<Aabb>; 2],
    /// Number of configurations in which the links touch, and in which they are apart.
    touching: u64,
    apart: u64,
    /// Number of contacts so far.
    contacts: usize,
}

/// Distances of the contacts of two links from a joint.
struct JointRegion {
    joint: JointId,
    /// Smallest and largest distance of a configuration's nearest contact from the joint's origin, m.
    nearest_m: (f64, f64),
    /// Smallest and largest distance of a configuration's farthest contact from the joint's origin, m.
    farthest_m: (f64, f64),
}

impl JointRegion {
    fn is_at_joint(&self, size_m: f64, most_spread_m: f64) -> bool {
        self.farthest_m.1 <= MOST_REACH * size_m && self.farthest_m.1 - self.farthest_m.0 <= most_spread_m
    }

    fn is_linkage(&self, size_m: f64) -> bool {
        self.nearest_m.1 <= MOST_REACH * size_m && self.nearest_m.1 - self.nearest_m.0 <= MOST_SPREAD * size_m
    }

    fn include(&mut self, nearest_m: f64, farthest_m: f64) {
        let widen = |range: &mut (f64, f64), v: f64| *range = (range.0.min(v), range.1.max(v));
        widen(&mut self.nearest_m, nearest_m);
        widen(&mut self.farthest_m, farthest_m);
    }
}

impl<'r> Candidate<'r> {
    /// Creates a candidate; `None` if a link has a surface without triangles, or is too large.
    fn new(robot: &'r Robot, a: LinkId, b: LinkId, state: &ChainState) -> Option<Self> {
        if ![a, b].iter().all(|l| robot.link_radius(*l) <= LARGEST_M) {
            return None;
        }
        let none = (f64::INFINITY, 0.0);
        let joints = moving_joints(robot, a, b);
        let follow_one_value = follow_one_value(robot, &joints);
        let chord_error_m = |c: &Collider| CHORD_ERROR * c.shape.aabb(&Pose::IDENTITY).extent().length();
        let surface = |c: &Collider| Some((triangle_surface(&c.shape, chord_error_m(c))?, c.in_link));
        let of_link = |l: LinkId| robot.colliders[l.0].iter().map(surface).collect::<Option<Vec<_>>>();
        let diagonal_m = |l: LinkId| {
            let boxes = robot.colliders[l.0].iter().map(|c| c.shape.aabb(&c.in_link));
            boxes.reduce(|x, y| x.union(&y)).map_or(0.0, |b| b.extent().length())
        };
        let size_m = diagonal_m(a).min(diagonal_m(b));
        Some(Self {
            robot,
            links: [a, b],
            surfaces: [of_link(a)?, of_link(b)?],
            size_m,
            most_spread_m: if follow_one_value { f64::INFINITY } else { MOST_SPREAD * size_m },
            may_be_at_joint: joints.len() <= MOST_JOINTS || follow_one_value,
            may_be_linkage: joints.len() > 1 && (has_mimic(robot, &joints) || share_axis(robot, &joints, state)),
            may_be_pivot: closes_linkage(robot, &joints),
            joints: joints.into_iter().map(|joint| JointRegion { joint, nearest_m: none, farthest_m: none }).collect(),
            boxes: [None; 2],
            touching: 0,
            apart: 0,
            contacts: 0,
        })
    }

    /// Adds the contacts of a configuration; returns false if the pair cannot be of any kind.
    fn measure(&mut self, state: &ChainState, workspace: &mut Workspace) -> bool {
        if !self.links.iter().all(|l| state.link_in_root(*l).translation.length() <= LARGEST_M) {
            return false;
        }
        let contacts = self.contacts(state, workspace);
        self.contacts += contacts.len();
        if self.contacts > MOST_CONTACTS {
            return false;
        }
        if contacts.is_empty() {
            self.apart += 1;
            (self.may_be_at_joint, self.may_be_linkage) = (false, false);
            self.may_be_pivot &= self.apart as f64 <= (1.0 - PIVOT_SHARE) * SAMPLES as f64;
            return self.may_be_pivot;
        }
        self.touching += 1;
        for region in &mut self.joints {
            let joint = &self.robot.chain.joints()[region.joint.0];
            let origin = (state.link_in_root(joint.parent) * joint.origin).translation;
            let distances = || contacts.iter().map(|p| origin.distance(*p));
            region.include(distances().fold(f64::INFINITY, f64::min), distances().fold(0.0, f64::max));
        }
        let (size_m, most_spread_m) = (self.size_m, self.most_spread_m);
        self.may_be_at_joint &= self.joints.iter().any(|j| j.is_at_joint(size_m, most_spread_m));
        self.may_be_linkage &= self.joints.iter().any(|j| j.is_linkage(size_m));
        self.may_be_pivot = self.may_be_pivot && self.are_at_one_place(state, &contacts);
        self.may_be_at_joint || self.may_be_linkage || self.may_be_pivot
    }

    /// Adds contacts to the boxes of the links; true if both remain small.
    fn are_at_one_place(&mut self, state: &ChainState, contacts: &[Vec3]) -> bool {
        self.links.iter().zip(&mut self.boxes).all(|(link, bounds)| {
            let to_link = state.link_in_root(*link).inverse();
            let here = Aabb::from_points(contacts.iter().map(|p| to_link.transform_point(*p)));
            let all = bounds.map_or(here, |b| b.union(&here));
            *bounds = Some(all);
            all.extent().length() <= PIVOT_EXTENT * self.size_m
        })
    }

    /// The points at which the links touch, in the root link's frame.
    fn contacts(&self, state: &ChainState, workspace: &mut Workspace) -> Vec<Vec3> {
        let in_root = self.links.map(|l| state.link_in_root(l));
        let mut contacts = Vec::new();
        for (x, x_in_link) in &self.surfaces[0] {
            let x_in_root = in_root[0] * *x_in_link;
            for (y, y_in_link) in &self.surfaces[1] {
                let y_in_root = in_root[1] * *y_in_link;
                let found = |contact: TriangleContact| contacts.extend(contact.segment);
                if for_each_triangle_contact(x, &x_in_root, y, &y_in_root, workspace, found) {
                    // The contact does not state which surface is inside: assume the smaller one.
                    let extent = |mesh: &TriMesh| mesh.aabb().extent().length();
                    let (inner, at) = if extent(x) < extent(y) { (x, x_in_root) } else { (y, y_in_root) };
                    contacts.extend(inner.vertices().iter().map(|p| at.transform_point(*p)));
                }
            }
        }
        contacts
    }

    fn found(self) -> Option<JointContact> {
        let (size_m, most_spread_m) = (self.size_m, self.most_spread_m);
        let (kind, may_be): (_, &dyn Fn(&JointRegion) -> bool) = if self.may_be_at_joint {
            (JointContactKind::AtJoint, &|j| j.is_at_joint(size_m, most_spread_m))
        } else if self.may_be_linkage {
            (JointContactKind::Linkage, &|j| j.is_linkage(size_m))
        } else {
            (JointContactKind::Pivot, &|_| true)
        };
        let joints = self.joints.iter().filter(|j| may_be(j));
        let nearest = joints.min_by(|a, b| a.farthest_m.1.total_cmp(&b.farthest_m.1))?;
        let ([a, b], contacts) = (self.links, self.touching);
        let JointRegion { joint, nearest_m, farthest_m } = *nearest;
        Some(JointContact { a, b, kind, joint, nearest_m, farthest_m, contacts, samples: SAMPLES })
    }
}
