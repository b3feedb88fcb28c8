//! The kernel for one configuration, whose lanes are spheres.
//!
//! Positions and comparisons equal those of a block, and so does the answer.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, prelude::*};

use super::block::BlockModel;
use super::single_workspace::{LinkMatrix, SingleWorkspace, WorldSphere};
use crate::lanes::{LANES, V3, splat};
use crate::model::{LinkPair, RootSphere, SpherePack};
use crate::obstacles::{BroadPhase, RoundedSolid};
use crate::validity::Validity;

/// Up to this number of solids, each is tested against sixteen spheres; above it, the tree of boxes is used.
const FEW_SOLIDS: usize = 24;

/// A robot and its obstacles, at one configuration.
pub(crate) struct SingleKernel<'k, 'm, S: Simd> {
    pub simd: S,
    pub model: BlockModel<'m>,
    /// Boxes of the solids inside obstacles.
    pub inner: &'m BroadPhase,
    pub matrix: &'m LinkMatrix,
    pub workspace: &'k mut SingleWorkspace,
    /// True if spheres touch and no collision is proven so far.
    pub is_touching: bool,
}

impl<S: Simd> SingleKernel<'_, '_, S> {
    /// Whether a configuration is free.
    #[inline(always)]
    pub fn check(&mut self, q: &[f64]) -> Validity {
        let (simd, robot) = (self.simd, self.model.robot);
        if !self.workspace.begin(robot, q) {
            return Validity::Uncertain;
        }
        let w = &mut *self.workspace;
        robot.chain.forward_single(simd, &w.values, &mut w.turns, &mut w.frames);
        if self.obstacles_hit() || self.links_hit() {
            Validity::Hit
        } else if self.is_touching {
            Validity::Uncertain
        } else {
            Validity::Free
        }
    }

    /// True if a collision with an obstacle is proven.
    #[inline(always)]
    fn obstacles_hit(&mut self) -> bool {
        self.workspace.place_roots(self.simd, &self.model.robot.packs);
        if self.model.obstacles.outer.len() <= FEW_SOLIDS { self.few_hit() } else { self.many_hit() }
    }

    /// Tests each solid against sixteen nodes of the broad phase at a time.
    #[inline(always)]
    fn few_hit(&mut self) -> bool {
        let (simd, packs) = (self.simd, &self.model.robot.packs);
        let mut left = packs.broad_phase.len();
        for row in 0..self.workspace.roots.len() {
            let used = used_lanes(left);
            left = left.saturating_sub(LANES);
            let (centres, radii) = (self.workspace.roots[row].load(simd), self.workspace.root_radii[row].load(simd));
            for (i, solid) in self.model.obstacles.outer.iter().enumerate() {
                let from = solid.vector_from_core(simd, centres).vector;
                let reach = radii + splat(simd, solid.radius);
                let mut near = !(from.dot(from).simd_ge(reach * reach).to_bitmask() as u32) & used;
                while near != 0 {
                    let root = &packs.broad_phase[row * LANES + near.trailing_zeros() as usize];
                    near &= near - 1;
                    if self.solid_hit(root, i) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// Tests each node of the broad phase against the tree of boxes.
    #[inline(always)]
    fn many_hit(&mut self) -> bool {
        let (simd, packs) = (self.simd, &self.model.robot.packs);
        for (i, root) in packs.broad_phase.iter().enumerate() {
            let centre = self.workspace.root_centre(i);
            let mut found = std::mem::take(&mut self.workspace.found);
            self.model.tree.near_sphere(simd, centre, root.radius, &mut self.workspace.open, &mut found);
            let is_hit = self.any_hit(root, &found);
            self.workspace.found = found;
            if is_hit {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn any_hit(&mut self, root: &RootSphere, solids: &[u32]) -> bool {
        for &solid in solids {
            if self.solid_hit(root, solid as usize) {
                return true;
            }
        }
        false
    }

    /// Tests a node of the broad phase against a solid. True if a collision is proven.
    #[inline(always)]
    fn solid_hit(&mut self, root: &RootSphere, solid: usize) -> bool {
        let (skipped, obstacles) = (self.model.skipped, self.model.obstacles);
        let source = obstacles.outer_source[solid];
        if !skipped.is_empty() && skipped[root.body as usize * obstacles.len() + source as usize] {
            return false;
        }
        // An obstacle may have thousands of solids; one more touching solid changes nothing.
        if self.workspace.unproven.contains(&(root.body, source)) || !self.touches(root.pack, &obstacles.outer[solid]) {
            return false;
        }
        self.is_touching = true;
        let is_hit = self.is_proven_hit(root.body as usize, source);
        if !is_hit {
            self.workspace.unproven.push((root.body, source));
        }
        is_hit
    }

    /// True if a leaf below a pack touches a solid.
    #[inline(always)]
    fn touches(&mut self, pack: u32, solid: &RoundedSolid) -> bool {
        let (simd, packs) = (self.simd, &self.model.robot.packs.packs);
        let mut open = std::mem::take(&mut self.workspace.open_packs);
        open.clear();
        open.push(pack);
        let mut is_touching = false;
        while let Some(at) = open.pop() {
            let pack = &packs[at as usize];
            let centres = self.workspace.centres(simd, pack, at);
            let from = solid.vector_from_core(simd, centres).vector;
            let reach = pack.radii.load(simd) + splat(simd, solid.radius);
            let mut near = !(from.dot(from).simd_ge(reach * reach).to_bitmask() as u32) & pack.used;
            if near & pack.leaves != 0 {
                is_touching = true;
                break;
            }
            while near != 0 {
                open.extend(pack.below[near.trailing_zeros() as usize]);
                near &= near - 1;
            }
        }
        self.workspace.open_packs = open;
        is_touching
    }

    /// True if an inner sphere of a body overlaps a solid inside an obstacle.
    #[inline(always)]
    fn is_proven_hit(&mut self, body: usize, obstacle: u32) -> bool {
        let (simd, robot, obstacles) = (self.simd, self.model.robot, self.model.obstacles);
        let Some(root) = &robot.packs.links[body] else { return false };
        let at = self.workspace.frames[root.frame as usize].point(simd, root.centre);
        let mut found = std::mem::take(&mut self.workspace.found_inner);
        self.inner.near_sphere(simd, [at[0], at[1], at[2]], root.radius, &mut self.workspace.open, &mut found);
        let mut is_hit = false;
        for &i in &found {
            if obstacles.inner_source[i as usize] != obstacle {
                continue;
            }
            let solid = &obstacles.inner[i as usize];
            for at in robot.packs.inner[body].clone() {
                let pack = &robot.packs.packs[at];
                let from = solid.vector_from_core(simd, self.workspace.centres(simd, pack, at as u32)).vector;
                is_hit |= self.shorter(from, pack, solid.radius);
            }
            if is_hit {
                break;
            }
        }
        self.workspace.found_inner = found;
        is_hit
    }

    /// True if a vector is certainly shorter than the sum of its sphere's radius and another radius. False for NaN.
    #[inline(always)]
    fn shorter(&self, vector: V3<S>, pack: &SpherePack, radius: f32) -> bool {
        let simd = self.simd;
        let reach = pack.radii.load(simd) + splat(simd, radius);
        let is_shorter = vector.dot(vector).simd_lt(reach * reach) & reach.simd_gt(splat(simd, 0.0));
        is_shorter.to_bitmask() as u32 & pack.used != 0
    }

    /// True if a collision of two links is proven.
    #[inline(always)]
    fn links_hit(&mut self) -> bool {
        let (simd, robot) = (self.simd, self.model.robot);
        if robot.pairs.is_empty() {
            return false;
        }
        self.workspace.exclude_by_tables(simd, robot);
        self.workspace.place_links(simd, &robot.packs);
        for (a, root) in robot.packs.links.iter().enumerate() {
            let Some(root) = root else { continue };
            let centre = V3::splat(simd, self.workspace.link_centre(a));
            for row in a / LANES..self.matrix.rows {
                let from = self.workspace.links[row].load(simd).minus(centre);
                let squares = self.matrix.square_reaches(a, row).load(simd);
                let mut near = !(from.dot(from).simd_ge(squares).to_bitmask() as u32);
                near &= self.matrix.partners(a, row);
                while near != 0 {
                    let b = row * LANES + near.trailing_zeros() as usize;
                    near &= near - 1;
                    let pair = self.matrix.pair(a, b);
                    if !self.workspace.is_excluded[pair] && self.pair_hit(root, &robot.pairs[pair], [a, b]) {
                        return true;
                    }
                }
            }
        }
        false
    }

    /// True if a collision of a pair is proven. `links` has the link with the sphere first.
    #[inline(always)]
    fn pair_hit(&mut self, root: &RootSphere, pair: &LinkPair, links: [usize; 2]) -> bool {
        let centre = self.workspace.link_centre(links[0]);
        let below = (!root.is_leaf).then_some(root.pack);
        let sphere = WorldSphere { centre, radius: root.radius, below };
        let Some(other) = &self.model.robot.packs.links[links[1]] else { return false };
        if !self.trees_touch(sphere, other.pack, pair.margin_m) {
            return false;
        }
        self.is_touching = true;
        self.are_inside(links)
    }

    /// Descends from a sphere of one tree and a pack of the other. True if two leaves are closer than the margin.
    #[inline(always)]
    fn trees_touch(&mut self, sphere: WorldSphere, pack: u32, margin_m: f32) -> bool {
        let (simd, packs) = (self.simd, &self.model.robot.packs.packs);
        let mut open = std::mem::take(&mut self.workspace.open_pairs);
        open.clear();
        open.push((sphere, pack));
        let mut is_touching = false;
        while let Some((sphere, at)) = open.pop() {
            let pack = &packs[at as usize];
            let from = self.workspace.centres(simd, pack, at).minus(V3::splat(simd, sphere.centre));
            let reach = pack.radii.load(simd) + splat(simd, sphere.radius) + splat(simd, margin_m);
            let mut near = !(from.dot(from).simd_ge(reach * reach).to_bitmask() as u32) & pack.used;
            if sphere.below.is_none() && near & pack.leaves != 0 {
                is_touching = true;
                break;
            }
            while near != 0 {
                let lane = near.trailing_zeros() as usize;
                near &= near - 1;
                let other = WorldSphere {
                    centre: self.workspace.centre(at, lane),
                    radius: pack.radii.0[lane],
                    below: pack.below[lane],
                };
                open.push(match (sphere.below, other.below) {
                    (Some(_), Some(of_other)) if other.radius > sphere.radius => (sphere, of_other),
                    (Some(of_sphere), _) => (other, of_sphere),
                    (None, Some(of_other)) => (sphere, of_other),
                    (None, None) => continue,
                });
            }
        }
        self.workspace.open_pairs = open;
        is_touching
    }

    /// True if inner spheres of two links overlap.
    #[inline(always)]
    fn are_inside(&mut self, links: [usize; 2]) -> bool {
        let (simd, packs) = (self.simd, &self.model.robot.packs);
        let mut is_hit = false;
        for one in packs.inner[links[0]].clone() {
            let spheres = &packs.packs[one];
            self.workspace.centres(simd, spheres, one as u32);
            for lane in 0..spheres.used.count_ones() as usize {
                let centre = V3::splat(simd, self.workspace.centre(one as u32, lane));
                for other in packs.inner[links[1]].clone() {
                    let pack = &packs.packs[other];
                    let from = self.workspace.centres(simd, pack, other as u32).minus(centre);
                    is_hit |= self.shorter(from, pack, spheres.radii.0[lane]);
                }
            }
        }
        is_hit
    }
}

/// One bit for each of the first `count` lanes.
#[inline(always)]
fn used_lanes(count: usize) -> u32 {
    if count >= LANES { 0xffff } else { (1 << count) - 1 }
}
