//! Proven collisions: an inner sphere of a body overlaps something that lies in an obstacle or in another body.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, prelude::*};

use super::block::{BlockModel, NearPair};
use super::workspace::Workspace;
use crate::lanes::{V3, splat};
use crate::model::{CoveredLink, CoveredRobot, InnerSphere};
use crate::obstacles::{Bounds, BoxTree};

impl BlockModel<'_> {
    /// Lanes of the last block at which one of the pairs certainly collides, one bit each.
    #[inline(always)]
    pub fn hits<S: Simd>(&self, simd: S, inner: &BoxTree, workspace: &mut Workspace, pairs: &[NearPair]) -> u32 {
        let mut hits = 0;
        for pair in pairs {
            hits |= match *pair {
                NearPair::Obstacle(body, obstacle) => self.obstacle_hits(simd, inner, workspace, body, obstacle),
                NearPair::Links(a, b) => self.body_hits(simd, workspace, a, b),
            };
        }
        hits
    }

    #[inline(always)]
    fn obstacle_hits<S: Simd>(
        &self,
        simd: S,
        inner: &BoxTree,
        workspace: &mut Workspace,
        body: u32,
        obstacle: u32,
    ) -> u32 {
        let body = &self.robot.covered_links[body as usize];
        let mut hits = 0;
        for sphere in inner_spheres(self.robot, body) {
            let centre = workspace.frames[body.frame].point(simd, sphere.centre);
            let bounds = Bounds::around(centre, sphere.radius);
            let mut found = std::mem::take(&mut workspace.found);
            inner.overlapping(simd, &bounds, &mut workspace.open, &mut found);
            for &i in found.iter().filter(|&&i| self.obstacles.inner_source[i as usize] == obstacle) {
                let solid = &self.obstacles.inner[i as usize];
                hits |= shorter(simd, solid.vector_from_core(simd, centre).vector, sphere.radius + solid.radius);
            }
            workspace.found = found;
        }
        hits
    }

    #[inline(always)]
    fn body_hits<S: Simd>(&self, simd: S, workspace: &Workspace, a: u32, b: u32) -> u32 {
        let (a, b) = (&self.robot.covered_links[a as usize], &self.robot.covered_links[b as usize]);
        let mut hits = 0;
        for one in inner_spheres(self.robot, a) {
            let centre = workspace.frames[a.frame].point(simd, one.centre);
            for other in inner_spheres(self.robot, b) {
                let to = workspace.frames[b.frame].point(simd, other.centre);
                hits |= shorter(simd, centre.minus(to), one.radius + other.radius);
            }
        }
        hits
    }
}

fn inner_spheres<'r>(robot: &'r CoveredRobot, body: &CoveredLink) -> &'r [InnerSphere] {
    &robot.inner[body.inner.start as usize..body.inner.end as usize]
}

/// One bit per lane whose vector is certainly shorter than a length; NaN is not.
#[inline(always)]
fn shorter<S: Simd>(simd: S, vector: V3<S>, length: f32) -> u32 {
    if !(length > 0.0) {
        return 0;
    }
    vector.dot(vector).simd_lt(splat(simd, length * length)).to_bitmask() as u32
}
