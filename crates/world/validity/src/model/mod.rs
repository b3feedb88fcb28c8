//! A robot prepared for validity checks: a chain for batched forward kinematics, and links covered by spheres.

mod axis_cylinder;
mod body;
mod close_pairs;
mod forward;
mod joint_step;
mod lever_arms;
mod pair_table;
mod single_forward;
mod sphere_packs;

use std::sync::OnceLock;

use elbowroom_kinematics::{Chain, LinkId};
use elbowroom_proximity::Shape;
use elbowroom_robot::{GeometryId, Robot, collision_pairs};
use elbowroom_spatial::Pose;

pub use axis_cylinder::AxisCylinder;
pub(crate) use body::{CoveredLink, InnerSphere, SphereNode};
pub(crate) use forward::{BatchedChain, FrameLanes};
pub(crate) use joint_step::{JointStep, single};
pub(crate) use pair_table::{BEYOND_RAD, CELLS, LEVELS, MAX_PAIRS, PairTable, cells};
pub(crate) use single_forward::{Frame, JointTurns};
pub(crate) use sphere_packs::{RootSphere, SpherePack, SpherePacks};

use self::body::push_tree;
use self::close_pairs::closer_slacks;
use self::lever_arms::{Reach, lever_arms};
use crate::cover::{Ball, ROUNDING_M, SphereCover};
use crate::cover_source::{BuiltCovers, CoverSource, covers};
use crate::error::ValidityError;

/// Largest protrusion of the cover of a link, m.
const SLACK_M: f64 = 0.005;
/// Largest protrusion of the cover of a small link or part, such as those of grippers, m.
const FINE_SLACK_M: f64 = 0.002;
/// Diagonal of the bounding box below which a link is small, m.
const FINE_DIAGONAL_M: f64 = 0.25;

/// Largest error of a joint's rotation in single precision, rad.
///
/// It includes the errors of its angle (up to 8 rad), of sine and cosine, and of the products of rotations. README.md of
/// this crate derives it.
pub(crate) const ROTATION_ERROR_RAD: f64 = 4e-6;
/// Rounding errors of coordinates per joint, and once more of comparisons, per metre that they can reach.
///
/// Derived in README.md.
pub(crate) const ROUNDING_SHARE: f64 = 2e-6;
/// Rounding error of a margin, per metre.
const MARGIN_SHARE: f64 = 1e-6;
/// Largest reach of a covered robot from the origin of the world, m.
const LONGEST_REACH_M: f64 = 1e6;

/// Index of a body in a [`CoveredRobot`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CoveredLinkId(pub usize);

/// Two links of the robot that must not touch.
#[derive(Debug, Clone)]
pub(crate) struct LinkPair {
    pub a: CoveredLinkId,
    pub b: CoveredLinkId,
    pub margin_m: f32,
    /// The frame in which the pair is compared: the frame of the last joint that moves both links.
    pub common_frame: usize,
    /// The joints that move one link against the other.
    pub joints: Vec<RelativeJoint>,
}

/// A joint that moves one body of a pair and not the other.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RelativeJoint {
    /// Step of the joint in the chain.
    pub step: usize,
    /// Lever arm of the joint for the body that it moves, m per rad or per m.
    pub lever_m: f32,
}

/// A robot with a sphere cover for each link, for a [`ValidityChecker`](crate::ValidityChecker).
///
/// It is constant; any number of checkers may share one.
///
/// ```
/// use elbowroom_spatial::Pose;
/// use elbowroom_validity::CoveredRobot;
/// let arm = elbowroom_robot::example::arm()?;
/// let covered = CoveredRobot::new(&arm, Pose::IDENTITY)?;
/// assert_eq!(covered.dof(), arm.chain.dof());
/// assert_eq!(covered.covered_links().len(), arm.links_with_colliders().count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CoveredRobot {
    pub(crate) chain: BatchedChain,
    pub(crate) covered_links: Vec<CoveredLink>,
    pub(crate) nodes: Vec<SphereNode>,
    /// The trees of `nodes` for one configuration at a time.
    pub(crate) packs: SpherePacks,
    pub(crate) inner: Vec<InnerSphere>,
    pub(crate) pairs: Vec<LinkPair>,
    /// Built at first use.
    pub(crate) tables: OnceLock<Vec<PairTable>>,
    /// Upper bound on the distance of any point of a link from the origin of the world, m.
    pub(crate) reach_m: f32,
    dof: usize,
}

impl CoveredRobot {
    /// Covers a robot with its base at a pose. The pairs of links are those of [`collision_pairs`], without margins.
    ///
    /// # Errors
    /// [`ValidityError`] if spheres cannot enclose a link: it is unbounded, or has NaN or infinite numbers.
    pub fn new(robot: &Robot, base_in_world: Pose) -> Result<Self, ValidityError> {
        let mut covered = Self::without_pairs(robot, base_in_world)?;
        let body = |id: GeometryId| match id {
            GeometryId::Link { link, .. } => {
                covered.covered_links.iter().position(|b| b.link == link).map(CoveredLinkId)
            }
            GeometryId::Object(_) => None,
        };
        let pairs: Vec<_> =
            collision_pairs(&[robot], 0).into_iter().filter_map(|(a, b)| Some((body(a)?, body(b)?))).collect();
        for (a, b) in pairs {
            covered.add_pair(a, b, 0.0);
        }
        Ok(covered)
    }

    /// Like [`new`](Self::new), but without pairs of links. [`add_pair`](Self::add_pair) adds pairs.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn without_pairs(robot: &Robot, base_in_world: Pose) -> Result<Self, ValidityError> {
        Self::with_covers(robot, base_in_world, &BuiltCovers)
    }

    /// Like [`without_pairs`](Self::without_pairs), with covers from a source, which several threads call at once.
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn with_covers(robot: &Robot, base_in_world: Pose, source: &dyn CoverSource) -> Result<Self, ValidityError> {
        let chain = BatchedChain::new(&robot.chain, base_in_world);
        let dof = robot.chain.dof();
        let mut covered = Self {
            chain,
            covered_links: Vec::new(),
            nodes: Vec::new(),
            packs: SpherePacks::default(),
            inner: Vec::new(),
            pairs: Vec::new(),
            tables: OnceLock::new(),
            reach_m: 0.0,
            dof,
        };
        for (link, cover) in link_covers(robot, source) {
            covered.add_cover(&robot.chain, link, cover)?;
        }
        Ok(covered)
    }

    /// Adds a body that moves with a link: a tool, or a part that the robot holds.
    ///
    /// The poses of its shapes are in the link's frame.
    ///
    /// # Errors
    /// [`ValidityError`] if the link does not exist, or spheres cannot enclose a shape.
    pub fn add_covered_link(
        &mut self,
        chain: &Chain,
        link: LinkId,
        shapes: &[(&Shape, Pose)],
    ) -> Result<CoveredLinkId, ValidityError> {
        self.add_cover(chain, link, SphereCover::new(shapes, slack_m(shapes)))
    }

    fn add_cover(
        &mut self,
        chain: &Chain,
        link: LinkId,
        cover: Option<SphereCover>,
    ) -> Result<CoveredLinkId, ValidityError> {
        let name = || chain.links().get(link.0).cloned().unwrap_or_else(|| format!("number {}", link.0));
        let Some(&at) = self.chain.links.get(link.0) else { return Err(ValidityError::NoSuchLink { index: link.0 }) };
        let cover = cover.ok_or_else(|| ValidityError::NotCovered { link: name() })?;
        let in_frame = |b: &Ball| Ball { centre: at.in_frame.transform_point(b.centre), ..*b };
        let radius_m = cover.outer.iter().map(in_frame).map(|b| b.centre.length() + b.radius).fold(0.0, f64::max);
        let levers = lever_arms(&self.chain, at.frame, cover.outer.iter().map(in_frame));
        let reach = Reach::new(&self.chain, at.frame, radius_m);
        if !(reach.world_m <= LONGEST_REACH_M) {
            return Err(ValidityError::NotCovered { link: name() });
        }
        self.reach_m = self.reach_m.max((reach.world_m as f32).next_up());
        let rounding_m = rounding_m(reach);
        let first_inner = self.inner.len() as u32;
        self.inner.extend(cover.inner.iter().filter_map(|ball| inner_sphere(ball, &at.in_frame, rounding_m)));
        let inner = first_inner..self.inner.len() as u32;
        let (nodes, broad_phase) = push_tree(&mut self.nodes, &cover.outer, at, rounding_m);
        let inner_spheres = &self.inner[first_inner as usize..];
        self.packs.push_link(&self.nodes, &nodes, &broad_phase, inner_spheres, at.frame);
        let lever_m = levers.iter().map(|&l| (l as f32).next_up()).map(|l| if l > f32::from_bits(1) { l } else { 0.0 });
        let lever_m = lever_m.collect();
        self.covered_links.push(CoveredLink { link, frame: at.frame, nodes, broad_phase, inner, lever_m });
        Ok(CoveredLinkId(self.covered_links.len() - 1))
    }

    /// Adds a pair of links that must stay farther apart than a margin (m).
    pub fn add_pair(&mut self, a: CoveredLinkId, b: CoveredLinkId, margin_m: f64) {
        let (Some(one), Some(other)) = (self.covered_links.get(a.0), self.covered_links.get(b.0)) else { return };
        let (of_a, of_b) = (self.chain.steps_to(one.frame), self.chain.steps_to(other.frame));
        let common = of_a.iter().zip(&of_b).take_while(|(i, j)| i == j).count();
        let joint = |body: &CoveredLink, step: usize| RelativeJoint { step, lever_m: body.lever_m[step] };
        let joints =
            of_a[common..].iter().map(|&i| joint(one, i)).chain(of_b[common..].iter().map(|&i| joint(other, i)));
        let joints = joints.collect();
        self.tables = OnceLock::new();
        let common_frame = common.checked_sub(1).map_or(0, |last| of_a[last] + 1);
        // NaN as a margin counts as infinite: no pair keeps it.
        let margin_m = if margin_m.is_nan() { f64::INFINITY } else { margin_m };
        let margin_m = ((margin_m.max(0.0) * (1.0 + MARGIN_SHARE)) as f32).next_up();
        self.pairs.push(LinkPair { a, b, margin_m, common_frame, joints });
    }

    /// Number of values of a configuration.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// The link of each body.
    pub fn covered_links(&self) -> impl ExactSizeIterator<Item = LinkId> + '_ {
        self.covered_links.iter().map(|b| b.link)
    }

    /// Radius of the sphere around a body, m; 0 if it has no spheres.
    pub(crate) fn bounding_radius_m(&self, body: CoveredLinkId) -> f32 {
        let nodes = &self.covered_links[body.0].nodes;
        if nodes.is_empty() { 0.0 } else { self.nodes[nodes.start as usize].radius }
    }

    /// Number of spheres that enclose a body.
    pub fn spheres(&self, body: CoveredLinkId) -> usize {
        let Some(b) = self.covered_links.get(body.0) else { return 0 };
        b.nodes.clone().filter(|&i| self.nodes[i as usize].end == i + 1).count()
    }
}

/// The covers of all links with colliders, in the order of the chain.
///
/// Links that are always near others get a smaller slack.
fn link_covers(robot: &Robot, source: &dyn CoverSource) -> Vec<(LinkId, Option<SphereCover>)> {
    let mut covers = usual_covers(robot, source);
    for (link, slack) in closer_slacks(robot, &covers) {
        let shapes: Vec<_> = robot.colliders[link.0].iter().map(|c| (&c.shape, c.in_link)).collect();
        if slack < slack_m(&shapes)
            && let Some(entry) = covers.iter_mut().find(|(covered, _)| *covered == link)
        {
            entry.1 = source.cover(&shapes, slack);
        }
    }
    covers
}

/// The covers of all links with colliders, in the order of the chain, built on all processors.
fn usual_covers(robot: &Robot, source: &dyn CoverSource) -> Vec<(LinkId, Option<SphereCover>)> {
    let links: Vec<LinkId> = robot.links_with_colliders().collect();
    let body = |link: &LinkId| {
        let shapes: Vec<_> = robot.colliders[link.0].iter().map(|c| (&c.shape, c.in_link)).collect();
        let slack_m = slack_m(&shapes);
        (shapes, slack_m)
    };
    let bodies: Vec<_> = links.iter().map(body).collect();
    links.into_iter().zip(covers(&bodies, source)).collect()
}

/// The slack of a cover, m, by the size of the covered shapes.
fn slack_m(shapes: &[(&Shape, Pose)]) -> f64 {
    let bounds = shapes.iter().map(|(s, p)| s.aabb(p)).reduce(|a, b| a.union(&b));
    let is_small = bounds.is_some_and(|b| b.extent().length() < FINE_DIAGONAL_M);
    if is_small { FINE_SLACK_M } else { SLACK_M }
}

/// Bound on the rounding errors of a point of a body, and of values computed from the point, m.
fn rounding_m(reach: Reach) -> f64 {
    let terms = (reach.joints + 1) as f64;
    ROTATION_ERROR_RAD * reach.arms_m + ROUNDING_SHARE * terms * reach.world_m + ROUNDING_M
}

fn inner_sphere(ball: &Ball, in_frame: &Pose, rounding_m: f64) -> Option<InnerSphere> {
    let radius = (ball.radius - rounding_m) as f32;
    let centre = single(in_frame.transform_point(ball.centre));
    (radius > 0.0).then_some(InnerSphere { centre, radius: radius.next_down() })
}
