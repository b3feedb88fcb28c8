//! Self-collision: pairs of links that are near, from the tables and bounding spheres down to the leaves.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, prelude::*};

use super::super::block_request::NearPair;
use super::{Kernel, Reach, is_leaf, push_children, within};
use crate::lanes::{LANES, splat};
use crate::model::LinkPair;

impl<S: Simd> Kernel<'_, '_, '_, S> {
    #[inline(always)]
    pub(super) fn self_collision(&mut self) {
        let robot = self.model.robot;
        self.mark_near_pairs();
        for (index, pair) in robot.pairs.iter().enumerate() {
            if !self.workspace.near_pairs[index] {
                continue;
            }
            if self.bodies_near(index, pair, 0.0) {
                self.note(NearPair::Links(pair.a.0 as u32, pair.b.0 as u32));
            }
            if self.is_done() {
                return;
            }
        }
    }

    /// Marks the pairs whose bounding spheres are near and which the tables do not exclude.
    #[inline(always)]
    fn mark_near_pairs(&mut self) {
        let (simd, robot, motion) = (self.simd, self.model.robot, self.model.motion);
        self.workspace.near_pairs.fill(true);
        if let Some(tables) = robot.tables.get() {
            for table in tables {
                let deltas = [self.workspace.deltas[table.steps[0]], self.workspace.deltas[table.steps[1]]];
                let near = table.near(simd, &self.workspace.values, deltas);
                for (bit, &pair) in table.pairs.iter().enumerate() {
                    self.workspace.near_pairs[pair] = near >> bit & 1 == 1;
                }
            }
        }
        for body in &robot.covered_links {
            if !body.nodes.is_empty() {
                self.workspace.centre(simd, robot, body.nodes.start);
            }
        }
        self.workspace.square_reaches(simd, motion);
        for (index, pair) in robot.pairs.iter().enumerate() {
            let (a, b) = (&robot.covered_links[pair.a.0].nodes, &robot.covered_links[pair.b.0].nodes);
            if a.is_empty() || b.is_empty() {
                self.workspace.near_pairs[index] = false;
            } else if self.workspace.near_pairs[index] {
                let column = motion.pair(index);
                let square = splat(simd, self.workspace.reach_squares[column / LANES].0[column % LANES]);
                let from_b =
                    self.workspace.known_centre(simd, a.start).minus(self.workspace.known_centre(simd, b.start));
                let near = !(from_b.dot(from_b).simd_ge(square).to_bitmask() as u32) & self.request.active;
                self.workspace.near_pairs[index] = near != 0;
            }
        }
    }

    /// Descends in the trees of two links. True if the links are not proven apart.
    #[inline(always)]
    pub(super) fn bodies_near(&mut self, index: usize, pair: &LinkPair, more_m: f32) -> bool {
        let (simd, robot) = (self.simd, self.model.robot);
        let (a, b) = (&robot.covered_links[pair.a.0], &robot.covered_links[pair.b.0]);
        if a.nodes.is_empty() || b.nodes.is_empty() {
            return false;
        }
        let (half_chord, sag) = self.workspace.pair_motion(self.model.motion.pair(index), pair.common_frame);
        let margin_m = pair.margin_m + more_m;
        let mut open = std::mem::take(&mut self.workspace.node_pairs);
        open.clear();
        open.push((a.nodes.start, b.nodes.start));
        let mut is_near = false;
        let mut lanes = self.request.active;
        while let Some((i, j)) = open.pop() {
            let (m, n) = (&robot.nodes[i as usize], &robot.nodes[j as usize]);
            let from_b = self.workspace.centre(simd, robot, i).minus(self.workspace.centre(simd, robot, j));
            let reach = Reach { radius: m.radius + n.radius + margin_m, half_chord, sag };
            if within(simd, from_b, reach.radius + half_chord) & lanes & self.open_lanes() == 0 {
                continue;
            }
            let (is_leaf_a, is_leaf_b) = (is_leaf(m, i + 1), is_leaf(n, j + 1));
            let are_leaves = is_leaf_a && is_leaf_b;
            let touching = if are_leaves { self.touching(from_b, reach) } else { 0 };
            if touching != 0 {
                is_near = true;
                lanes &= !self.settled_by(touching);
            } else if self.request.chords {
                let local = self.workspace.frames[pair.common_frame].local_direction(simd, from_b);
                let direction = local.plus(local.next_lane());
                let height = direction.dot(local).min(direction.dot(local.next_lane()));
                let unproven = self.not_apart(direction, height, reach);
                if unproven == 0 {
                    continue;
                }
                if are_leaves {
                    self.result.unproven |= unproven;
                    is_near = true;
                    lanes &= !self.settled_by(unproven);
                }
            }
            if are_leaves {
                if lanes == 0 || self.is_done() {
                    break;
                }
            } else if !is_leaf_a && (is_leaf_b || m.radius >= n.radius) {
                push_children(robot, i, |child| open.push((child, j)));
            } else {
                push_children(robot, j, |child| open.push((i, child)));
            }
        }
        self.workspace.node_pairs = open;
        is_near
    }
}
