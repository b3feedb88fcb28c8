//! The distance of a tool from one surface, and how far it may move before it must be measured again.

use elbowroom_proximity::advanced::mesh_separation_with;
use elbowroom_proximity::{DistanceSettings, TriMesh, WarmStart, Workspace};
use elbowroom_spatial::Pose;

use crate::ProtectedSurface;

/// Rounding of the sizes of motions, metres.
const ROUNDING_M: f64 = 1e-12;

/// The last distance to a surface, and where it was found.
///
/// A motion of the tool changes it at most by what a point of the tool moves, so small steps far from the surface need
/// no query.
#[derive(Debug, Clone, Default)]
pub(crate) struct SurfaceClearance {
    warm_start: WarmStart,
    /// Pose of the tool at the last query, and a lower bound of the distance there, metres.
    measured: Option<(Pose, f64)>,
}

impl SurfaceClearance {
    /// A lower bound of the distance of the tool at a pose, at most `limit_m`; 0 inside. A query looks `farther_m` beyond
    /// the limit, so that the next motions need none.
    pub fn at(
        &mut self,
        tool: &Tool<'_>,
        protected: &ProtectedSurface,
        tool_in_world: Pose,
        (limit_m, farther_m): (f64, f64),
        workspace: &mut Workspace,
    ) -> f64 {
        if let Some((before, at_least_m)) = self.measured
            && at_least_m - tool.largest_motion_m(before, tool_in_world) >= limit_m
        {
            return limit_m;
        }
        let settings = DistanceSettings {
            limit: limit_m + farther_m,
            warm_start: Some(&mut self.warm_start),
            ..Default::default()
        };
        let surface = protected.surface.mesh();
        let found = mesh_separation_with(tool.mesh, &tool_in_world, surface, &protected.in_world, settings, workspace);
        let at_least_m = found.map_or(limit_m + farther_m, |s| s.lower_bound);
        self.measured = Some((tool_in_world, at_least_m));
        at_least_m.min(limit_m)
    }
}

/// A tool, and the largest distance of its points from the tool point, metres.
pub(crate) struct Tool<'a> {
    pub mesh: &'a TriMesh,
    pub reach_m: f64,
}

impl Tool<'_> {
    /// A bound of the motion of every point of the tool between two poses, metres.
    fn largest_motion_m(&self, from: Pose, to: Pose) -> f64 {
        let turn = if from.rotation == to.rotation { 0.0 } else { (to.rotation * from.rotation.inverse()).angle() };
        from.translation.distance(to.translation) + self.reach_m * turn + ROUNDING_M
    }
}
