//! Covered links: the covers of a robot's links as trees of spheres.

use elbowroom_kinematics::LinkId;

use super::joint_step::{LinkFrame, single};
use crate::cover::{Ball, ROUNDING_M, enclosing};

/// Children of an inner node.
const FAN_OUT: usize = 4;
/// Radius, m. The broad phase tests the first nodes of a tree that are at most this large.
const BROAD_PHASE_RADIUS_M: f64 = 0.15;

/// Depth, m.
///
/// A node counts as touching only if it touches by more than this: then a leaf below touches, whatever the rounding.
const TOUCHING_MARGIN_M: f64 = 1e-4;

/// A sphere of a tree; it encloses all spheres below it.
#[derive(Debug, Clone)]
pub(crate) struct SphereNode {
    /// Centre in the frame of the body's joint, m.
    pub centre: [f32; 3],
    /// Radius, rounding errors included, m.
    pub radius: f32,
    /// Distance from the centre below which a point touches a leaf below, m; negative if the centre is not in a leaf.
    pub touching_m: f32,
    /// Index of the frame that moves the sphere.
    pub frame: u32,
    /// Index after the last node below this one.
    pub end: u32,
}

/// A sphere inside a body.
#[derive(Debug, Clone)]
pub(crate) struct InnerSphere {
    pub centre: [f32; 3],
    pub radius: f32,
}

/// A link, or a body attached to it, with a cover.
#[derive(Debug, Clone)]
pub(crate) struct CoveredLink {
    pub link: LinkId,
    /// Frame of its joint; 0 if no joint moves it.
    pub frame: usize,
    /// Range of its tree in the list of all nodes; the first node is the root.
    pub nodes: std::ops::Range<u32>,
    /// Nodes that the broad phase tests; every leaf is below one.
    pub broad_phase: Vec<u32>,
    /// Range of its inner spheres in the list of all inner spheres.
    pub inner: std::ops::Range<u32>,
    /// Per step of the chain: upper bound on the motion of any point of the body, m per rad or per m.
    ///
    /// It is 0 if the joint does not move the body.
    pub lever_m: Vec<f32>,
}

/// Appends the tree of a cover. Returns its nodes and the nodes for the broad phase.
pub(crate) fn push_tree(
    nodes: &mut Vec<SphereNode>,
    balls: &[Ball],
    at: LinkFrame,
    rounding_m: f64,
) -> (std::ops::Range<u32>, Vec<u32>) {
    let first = nodes.len() as u32;
    let mut in_frame: Vec<Ball> = balls
        .iter()
        .map(|b| Ball { centre: at.in_frame.transform_point(b.centre), ..*b }.rounded_up())
        .map(|b| Ball { radius: b.radius + rounding_m, ..b })
        .collect();
    let mut tree = TreeBuilder { nodes, frame: at.frame as u32, broad_phase: Vec::new() };
    if !in_frame.is_empty() {
        tree.push(&mut in_frame, false);
    }
    let broad_phase = tree.broad_phase;
    (first..nodes.len() as u32, broad_phase)
}

struct TreeBuilder<'n> {
    nodes: &'n mut Vec<SphereNode>,
    frame: u32,
    broad_phase: Vec<u32>,
}

impl TreeBuilder<'_> {
    /// Appends the tree of some balls; `is_below` is true below a node of the broad phase.
    fn push(&mut self, balls: &mut [Ball], is_below: bool) {
        let ball = if let [only] = balls { *only } else { enclosing(balls) };
        let index = self.nodes.len();
        // Rounding to single precision never makes the radius smaller.
        let radius = ((ball.radius + ROUNDING_M) as f32).next_up();
        let touching_m = touching_m(&ball, balls);
        self.nodes.push(SphereNode { centre: single(ball.centre), radius, touching_m, frame: self.frame, end: 0 });
        let is_leaf = balls.len() == 1;
        let is_root = !is_below && (is_leaf || ball.radius <= BROAD_PHASE_RADIUS_M);
        if is_root {
            self.broad_phase.push(index as u32);
        }
        if !is_leaf {
            for part in split(balls, FAN_OUT) {
                self.push(part, is_below || is_root);
            }
        }
        self.nodes[index].end = self.nodes.len() as u32;
    }
}

/// Distance from the centre of a ball below which a point touches one of the balls in it, rounding errors included, m.
fn touching_m(ball: &Ball, balls: &[Ball]) -> f32 {
    let depth = |b: &Ball| b.radius - b.centre.distance(ball.centre);
    (balls.iter().map(depth).fold(f64::NEG_INFINITY, f64::max) - TOUCHING_MARGIN_M) as f32
}

/// Splits balls at medians along the longest axis into at most `parts` groups, all non-empty.
fn split(balls: &mut [Ball], parts: usize) -> Vec<&mut [Ball]> {
    if parts == 1 || balls.len() == 1 {
        return vec![balls];
    }
    let range = |axis: usize| {
        let values = balls.iter().map(|b| b.centre[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        high - low
    };
    let axis = (0..3).fold(0, |best, k| if range(k) > range(best) { k } else { best });
    balls.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let (low, high) = balls.split_at_mut(balls.len() / 2);
    let mut groups = split(low, parts / 2);
    groups.extend(split(high, parts / 2));
    groups
}
