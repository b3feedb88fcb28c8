//! The kernel for a block of sixteen configurations: obstacles and self-collision.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

mod root_touches;
mod self_collision;

use fearless_simd::{Simd, f32x16, prelude::*};

use super::block_request::{BlockRequest, BlockResult, NearPair};
use super::motion_table::MotionTable;
use super::node_obstacles::NodeObstacle;
use super::workspace::Workspace;
use crate::lanes::{V3, splat};
use crate::model::{CoveredRobot, SphereNode};
use crate::obstacles::{BroadPhase, ObstacleSet, RoundedSolid};

/// A robot and its obstacles.
#[derive(Clone, Copy)]
pub(crate) struct BlockModel<'m> {
    pub robot: &'m CoveredRobot,
    pub obstacles: &'m ObstacleSet,
    pub tree: &'m BroadPhase,
    pub motion: &'m MotionTable,
    /// Per body and obstacle: true if the pair is not checked. Empty if every pair is checked.
    pub skipped: &'m [bool],
}

/// Margins of a pair of spheres or of a sphere and an obstacle.
#[derive(Clone, Copy)]
struct Reach {
    /// Sum of the two radii, and of the margin of links.
    radius: f32,
    half_chord: f32,
    sag: f32,
}

impl BlockModel<'_> {
    /// Tests the block for which the workspace was prepared.
    ///
    /// Stops as soon as the answer is known: with chords, at the first lane that touches; otherwise when all lanes touch.
    #[inline(always)]
    pub fn check<S: Simd>(
        &self,
        simd: S,
        workspace: &mut Workspace,
        request: BlockRequest,
        pairs: Option<&mut Vec<NearPair>>,
    ) -> BlockResult {
        workspace.begin_block();
        if request.chords {
            workspace.spread(simd, self.robot, self.motion);
        }
        self.robot.chain.forward(simd, &workspace.values, &mut workspace.frames);
        let mut kernel = Kernel { simd, model: *self, workspace, request, result: BlockResult::default(), pairs };
        if kernel.request.chords && kernel.pairs.is_none() {
            kernel.obstacles_by_level();
        } else {
            kernel.obstacles();
        }
        if !kernel.is_done() {
            kernel.self_collision();
        }
        let BlockResult { touching, unproven } = kernel.result;
        BlockResult { touching: touching & request.active, unproven: unproven & request.active }
    }
}

impl BlockModel<'_> {
    /// Whether a body and a solid of an obstacle are not checked.
    #[inline(always)]
    fn is_skipped(&self, body: usize, solid: u32) -> bool {
        let source = self.obstacles.outer_source[solid as usize] as usize;
        !self.skipped.is_empty() && self.skipped[body * self.obstacles.len() + source]
    }

    /// Lanes in which two links may be at most their margin plus `more_m` apart.
    #[inline(always)]
    pub fn check_pair<S: Simd>(
        &self,
        simd: S,
        workspace: &mut Workspace,
        request: BlockRequest,
        pair: usize,
        more_m: f32,
    ) -> u32 {
        workspace.begin_block();
        self.robot.chain.forward(simd, &workspace.values, &mut workspace.frames);
        let mut kernel = Kernel { simd, model: *self, workspace, request, result: BlockResult::default(), pairs: None };
        kernel.bodies_near(pair, &self.robot.pairs[pair], more_m);
        kernel.result.touching
    }
}

struct Kernel<'k, 'm, 'p, S: Simd> {
    simd: S,
    model: BlockModel<'m>,
    workspace: &'k mut Workspace,
    request: BlockRequest,
    result: BlockResult,
    /// If given, collects every near pair, and no test ends early.
    pairs: Option<&'p mut Vec<NearPair>>,
}

impl<S: Simd> Kernel<'_, '_, '_, S> {
    #[inline(always)]
    fn is_done(&self) -> bool {
        let touching = self.result.touching & self.request.active;
        self.pairs.is_none() && (touching == self.request.active || (self.request.chords && touching != 0))
    }

    /// Lanes whose result can still change.
    #[inline(always)]
    fn open_lanes(&self) -> u32 {
        if self.pairs.is_some() { self.request.active } else { self.request.active & !self.result.touching }
    }

    #[inline(always)]
    fn obstacles(&mut self) {
        let robot = self.model.robot;
        // Bodies farthest from the base move most and hit first.
        for (index, body) in robot.covered_links.iter().enumerate().rev() {
            if body.frame == 0 {
                continue;
            }
            for &root in &body.broad_phase {
                self.obstacles_near(index, root);
                if self.is_done() {
                    return;
                }
            }
        }
    }

    /// Like [`obstacles`](Self::obstacles), if only the whole segment counts.
    ///
    /// The first touching sphere ends the test. Large nodes give an answer soonest, so they are tested before the nodes
    /// below them.
    #[inline(always)]
    fn obstacles_by_level(&mut self) {
        if self.touches_as_before() {
            return;
        }
        let mut open = std::mem::take(&mut self.workspace.node_obstacles.open);
        open.clear();
        if !self.any_root_touches(&mut open) {
            let mut next = 0;
            while next < open.len() && !self.any_child_touches(open[next], &mut open) {
                next += 1;
            }
        }
        self.workspace.node_obstacles.open = open;
    }

    /// Tests what ended other segments. True if a sphere touches.
    #[inline(always)]
    fn touches_as_before(&mut self) -> bool {
        let mut place = 0;
        while let Some(pair) = self.workspace.node_obstacles.recent(place) {
            let node = &self.model.robot.nodes[pair.node as usize];
            let solid = &self.model.obstacles.outer[pair.obstacle as usize];
            let centre = self.workspace.centre(self.simd, self.model.robot, pair.node);
            let vector = solid.vector_from_core(self.simd, centre).vector;
            if self.certainly_touches(vector, node.touching_m + solid.radius) {
                self.workspace.node_obstacles.touched_again(place);
                return true;
            }
            place += 1;
        }
        false
    }

    /// Tests the roots of all links. True if a sphere touches.
    #[inline(always)]
    fn any_root_touches(&mut self, open: &mut Vec<NodeObstacle>) -> bool {
        let robot = self.model.robot;
        // Bodies farthest from the base move most and hit first.
        for (index, body) in robot.covered_links.iter().enumerate().rev() {
            if body.frame == 0 {
                continue;
            }
            for &root in &body.broad_phase {
                if self.root_touches(index, root, open) {
                    return true;
                }
            }
        }
        false
    }

    /// Tests the children of a node. True if a sphere touches.
    #[inline(always)]
    fn any_child_touches(&mut self, parent: NodeObstacle, open: &mut Vec<NodeObstacle>) -> bool {
        let robot = self.model.robot;
        let end = robot.nodes[parent.node as usize].end;
        let mut child = parent.node + 1;
        while child < end {
            if self.node_touches(NodeObstacle { node: child, ..parent }, open) {
                return true;
            }
            child = robot.nodes[child as usize].end;
        }
        false
    }

    /// Runs the broad phase of a node, and tests the node against the solids found. True if a sphere touches.
    #[inline(always)]
    fn root_touches(&mut self, body: usize, root: u32, open: &mut Vec<NodeObstacle>) -> bool {
        let node = &self.model.robot.nodes[root as usize];
        let (half_chord, _) = self.workspace.body_motion(body);
        let centre = self.workspace.centre(self.simd, self.model.robot, root);
        let mut found = std::mem::take(&mut self.workspace.found);
        self.model.tree.around(self.simd, centre, node.radius + half_chord, &mut self.workspace.open, &mut found);
        let mut is_touching = false;
        for &obstacle in &found {
            if self.model.is_skipped(body, obstacle) {
                continue;
            }
            if self.node_touches(NodeObstacle { body: body as u32, node: root, obstacle }, open) {
                is_touching = true;
                break;
            }
        }
        self.workspace.found = found;
        is_touching
    }

    /// Tests a node against a solid. True if a sphere touches. Adds the node to `open` if its children must decide.
    #[inline(always)]
    fn node_touches(&mut self, pair: NodeObstacle, open: &mut Vec<NodeObstacle>) -> bool {
        let (simd, robot) = (self.simd, self.model.robot);
        let solid = &self.model.obstacles.outer[pair.obstacle as usize];
        let (half_chord, sag) = self.workspace.body_motion(pair.body as usize);
        let node = &robot.nodes[pair.node as usize];
        let centre = self.workspace.centre(simd, robot, pair.node);
        let from = solid.vector_from_core(simd, centre);
        let reach = Reach { radius: node.radius + solid.radius, half_chord, sag };
        let near = within(simd, from.vector, reach.radius + reach.half_chord);
        if near & self.request.active == 0 {
            return false;
        }
        let is_leaf = is_leaf(node, pair.node + 1);
        if self.certainly_touches(from.vector, node.touching_m + solid.radius)
            || (is_leaf && self.touching(from.vector, reach) != 0)
        {
            self.workspace.node_obstacles.touched(pair);
            return true;
        }
        let direction = from.vector.plus(from.vector.next_lane());
        let (a, b) = (direction.dot(from.point), direction.dot(from.point.next_lane()));
        let unproven = self.not_apart(direction, a.min(b) - solid.support(simd, direction), reach);
        if unproven == 0 {
            return false;
        }
        if is_leaf {
            self.result.unproven |= unproven;
        } else {
            open.push(pair);
        }
        false
    }

    /// Runs the broad phase of a node, and tests the nodes below it against the solids found.
    #[inline(always)]
    fn obstacles_near(&mut self, body: usize, root: u32) {
        let node = &self.model.robot.nodes[root as usize];
        let (half_chord, _) = self.workspace.body_motion(body);
        let centre = self.workspace.centre(self.simd, self.model.robot, root);
        let mut found = std::mem::take(&mut self.workspace.found);
        self.model.tree.around(self.simd, centre, node.radius + half_chord, &mut self.workspace.open, &mut found);
        for &obstacle in &found {
            if self.model.is_skipped(body, obstacle) {
                continue;
            }
            let source = self.model.obstacles.outer_source[obstacle as usize];
            let open = self.request.active & !self.workspace.settled(body, source);
            if open == 0 {
                continue;
            }
            if let Some(settled) = self.tree_against(body, root, &self.model.obstacles.outer[obstacle as usize], open) {
                self.note(NearPair::Obstacle(body as u32, source));
                self.workspace.settle(body, source, settled);
            }
            if self.is_done() {
                break;
            }
        }
        self.workspace.found = found;
    }

    #[inline(always)]
    fn note(&mut self, pair: NearPair) {
        if let Some(pairs) = &mut self.pairs {
            pairs.push(pair);
        }
    }

    /// Descends from a node to the spheres near an obstacle, for some lanes.
    ///
    /// `None` if all lanes are proven apart; otherwise the lanes in which the pair needs no further test.
    #[inline(always)]
    fn tree_against(&mut self, body: usize, root: u32, obstacle: &RoundedSolid, mut open: u32) -> Option<u32> {
        let (simd, robot) = (self.simd, self.model.robot);
        let (half_chord, sag) = self.workspace.body_motion(body);
        let end = robot.nodes[root as usize].end;
        let mut settled = None;
        let mut at = root;
        while at < end {
            let node = &robot.nodes[at as usize];
            let centre = self.workspace.centre(simd, robot, at);
            let from = obstacle.vector_from_core(simd, centre);
            let reach = Reach { radius: node.radius + obstacle.radius, half_chord, sag };
            let near = within(simd, from.vector, reach.radius + reach.half_chord);
            if near & open & self.open_lanes() == 0 {
                at = node.end;
                continue;
            }
            let is_leaf = is_leaf(node, at + 1);
            let touching = if is_leaf { self.touching(from.vector, reach) } else { 0 };
            if touching != 0 {
                settled = Some(settled.unwrap_or(0) | self.settled_by(touching));
            } else if self.request.chords {
                let direction = from.vector.plus(from.vector.next_lane());
                let (a, b) = (direction.dot(from.point), direction.dot(from.point.next_lane()));
                let unproven = self.not_apart(direction, a.min(b) - obstacle.support(simd, direction), reach);
                if unproven == 0 {
                    at = node.end;
                    continue;
                }
                if is_leaf {
                    self.result.unproven |= unproven;
                    settled = Some(settled.unwrap_or(0) | self.settled_by(unproven));
                }
            }
            if is_leaf {
                open &= !settled.unwrap_or(0);
                if open == 0 || self.is_done() {
                    break;
                }
            }
            at += 1;
        }
        settled
    }

    /// Records the lanes in which a leaf below a node certainly touches, without a descent to the leaf.
    #[inline(always)]
    fn certainly_touches(&mut self, vector: V3<S>, length: f32) -> bool {
        if !(length > 0.0) {
            return false;
        }
        let is_touching = vector.dot(vector).simd_lt(splat(self.simd, length * length));
        let touching = is_touching.to_bitmask() as u32 & self.request.active;
        self.result.touching |= touching;
        touching != 0
    }

    /// The lanes in which a pair needs no further test after lanes that are not apart.
    ///
    /// On a segment with a list of pairs: all, because this pair is listed. If only the whole segment counts: none,
    /// because lanes that touch end the test and other lanes may still touch.
    #[inline(always)]
    fn settled_by(&self, not_apart: u32) -> u32 {
        match (self.request.chords, self.pairs.is_some()) {
            (false, _) => not_apart,
            (true, true) => u32::MAX,
            (true, false) => 0,
        }
    }

    /// Records and returns the lanes that touch.
    #[inline(always)]
    fn touching(&mut self, vector: V3<S>, reach: Reach) -> u32 {
        let touching = within(self.simd, vector, reach.radius) & self.request.active;
        self.result.touching |= touching;
        touching
    }

    /// Lanes from which the motion to the next lane is not proven apart.
    ///
    /// `height` is the lower height of the two ends of each motion above the core, along `direction`, which is not
    /// normalized. The best direction is the mean of the directions at both ends: a plane perpendicular to it separates
    /// the chord from the core in nearly every case in which a plane can.
    #[inline(always)]
    fn not_apart(&self, direction: V3<S>, height: f32x16<S>, reach: Reach) -> u32 {
        let radius = splat(self.simd, reach.radius + reach.sag);
        let is_above = height.simd_gt(splat(self.simd, 0.0));
        let is_apart = (height * height).simd_ge(radius * radius * direction.dot(direction)) & is_above;
        !(is_apart.to_bitmask() as u32) & self.request.active
    }
}

/// Calls `push` with the children of a node.
#[inline(always)]
fn push_children(robot: &CoveredRobot, parent: u32, mut push: impl FnMut(u32)) {
    let end = robot.nodes[parent as usize].end;
    let mut child = parent + 1;
    while child < end {
        push(child);
        child = robot.nodes[child as usize].end;
    }
}

#[inline(always)]
fn is_leaf(node: &SphereNode, next: u32) -> bool {
    node.end == next
}

/// One bit per lane whose vector is shorter than a length. The bit is also set for NaN.
#[inline(always)]
fn within<S: Simd>(simd: S, vector: V3<S>, length: f32) -> u32 {
    let is_beyond = vector.dot(vector).simd_ge(splat(simd, length * length));
    !(is_beyond.to_bitmask() as u32) & 0xffff
}
