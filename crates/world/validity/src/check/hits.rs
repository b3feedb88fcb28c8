//! Proven collisions: an inner sphere of a body overlaps a solid inside an obstacle, or an inner sphere of another body.
//!
//! A box in joint space is proven to be in collision as a whole if the overlap at its centre is deeper than any motion
//! within the box (section 3 of README.md has the lever arms).

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, prelude::*};

use super::block::BlockModel;
use super::block_request::NearPair;
use super::workspace::Workspace;
use crate::lanes::{V3, splat};
use crate::model::{CoveredLink, CoveredRobot, InnerSphere, LinkPair};
use crate::obstacles::BroadPhase;

/// Factor that exceeds the relative rounding error of a sum of lever arms.
const ROUNDED_UP: f32 = 1.0 + 2e-5;

impl BlockModel<'_> {
    /// Lanes of the last block in which one of the pairs certainly collides, one bit each.
    ///
    /// The collision holds for any joint value within the half width (rad or m) of each step around the lane's value.
    /// Empty `half_widths`: at the lane's values themselves.
    #[inline(always)]
    pub fn hits<S: Simd>(
        &self,
        simd: S,
        inner: &BroadPhase,
        workspace: &mut Workspace,
        pairs: &[NearPair],
        half_widths: &[f32],
    ) -> u32 {
        let mut hits = 0;
        for pair in pairs {
            let depth_m = self.motion_within(*pair, half_widths);
            hits |= match *pair {
                NearPair::Obstacle(body, obstacle) => {
                    self.obstacle_hits(simd, inner, workspace, (body, obstacle), depth_m)
                }
                NearPair::Links(a, b) => self.body_hits(simd, workspace, (a, b), depth_m),
            };
        }
        hits
    }

    /// Upper bound on the motion of two points of a pair against each other, m.
    fn motion_within(&self, pair: NearPair, half_widths: &[f32]) -> f32 {
        let sum: f32 = match pair {
            NearPair::Obstacle(link, _) => {
                let levers = &self.robot.covered_links[link as usize].lever_m;
                levers
                    .iter()
                    .zip(half_widths)
                    .filter(|(lever, _)| **lever > 0.0)
                    .map(|(lever, half)| lever * half)
                    .sum()
            }
            NearPair::Links(a, b) => {
                let is_pair = |p: &&LinkPair| (p.a.0, p.b.0) == (a as usize, b as usize);
                let Some(pair) = self.robot.pairs.iter().find(is_pair) else { return f32::INFINITY };
                pair.joints.iter().map(|j| half_widths.get(j.step).map_or(0.0, |half| j.lever_m * half)).sum()
            }
        };
        sum * ROUNDED_UP
    }

    #[inline(always)]
    fn obstacle_hits<S: Simd>(
        &self,
        simd: S,
        inner: &BroadPhase,
        workspace: &mut Workspace,
        (body, obstacle): (u32, u32),
        depth_m: f32,
    ) -> u32 {
        let body = &self.robot.covered_links[body as usize];
        let mut hits = 0;
        for sphere in inner_spheres(self.robot, body) {
            let centre = workspace.frames[body.frame].point(simd, sphere.centre);
            let mut found = std::mem::take(&mut workspace.found);
            inner.around(simd, centre, sphere.radius, &mut workspace.open, &mut found);
            for &i in found.iter().filter(|&&i| self.obstacles.inner_source[i as usize] == obstacle) {
                let solid = &self.obstacles.inner[i as usize];
                hits |=
                    shorter(simd, solid.vector_from_core(simd, centre).vector, sphere.radius + solid.radius - depth_m);
            }
            workspace.found = found;
        }
        hits
    }

    #[inline(always)]
    fn body_hits<S: Simd>(&self, simd: S, workspace: &Workspace, (a, b): (u32, u32), depth_m: f32) -> u32 {
        let (a, b) = (&self.robot.covered_links[a as usize], &self.robot.covered_links[b as usize]);
        let mut hits = 0;
        for one in inner_spheres(self.robot, a) {
            let centre = workspace.frames[a.frame].point(simd, one.centre);
            for other in inner_spheres(self.robot, b) {
                let to = workspace.frames[b.frame].point(simd, other.centre);
                hits |= shorter(simd, centre.minus(to), one.radius + other.radius - depth_m);
            }
        }
        hits
    }
}

fn inner_spheres<'r>(robot: &'r CoveredRobot, body: &CoveredLink) -> &'r [InnerSphere] {
    &robot.inner[body.inner.start as usize..body.inner.end as usize]
}

/// One bit per lane whose vector is certainly shorter than a length. The bit is not set for NaN.
#[inline(always)]
fn shorter<S: Simd>(simd: S, vector: V3<S>, length: f32) -> u32 {
    if !(length > 0.0) {
        return 0;
    }
    vector.dot(vector).simd_lt(splat(simd, length * length)).to_bitmask() as u32
}
