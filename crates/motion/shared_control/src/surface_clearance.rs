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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use elbowroom_spatial::{Rotation, Vec3};
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    /// A box with corners at these half edge lengths.
    fn box_mesh(half: Vec3) -> TriMesh {
        let corner = |i: usize| Vec3::from([0, 1, 2].map(|k| if i >> k & 1 == 1 { half[k] } else { -half[k] }));
        let faces = [
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        TriMesh::new((0..8).map(corner).collect(), faces.to_vec()).unwrap()
    }

    /// Walks of a tool around a solid, in small and in large steps, with turns: never more than the distance, and the
    /// distance itself below the limit.
    #[test]
    fn a_distance_that_is_not_measured_again_is_never_too_large() {
        let mesh = box_mesh(Vec3::new(0.05, 0.02, 0.01));
        let tool = Tool { mesh: &mesh, reach_m: Vec3::new(0.05, 0.02, 0.01).length() };
        let solid = ProtectedSurface::new(
            Arc::new(box_mesh(Vec3::new(0.2, 0.3, 0.1))),
            Pose::from_translation(Vec3::new(0.1, 0.0, -0.1)),
        );
        let solid = solid.unwrap();
        let mut random = SplitMix(3);
        let (mut clearance, mut workspace, mut other) =
            (SurfaceClearance::default(), Workspace::default(), Workspace::default());
        let (mut near, mut kept) = (0, 0);
        let mut pose = Pose::from_translation(Vec3::new(0.6, 0.0, 0.2));
        for step in 0..4_000 {
            let size = if step % 50 == 0 { 0.2 } else { 0.004 };
            let by = Vec3::from([0; 3].map(|_| size * (random.unit() - 0.5)));
            let turn = Rotation::from_axis_angle(Vec3::Y, 4.0 * size * (random.unit() - 0.5));
            // Drawn towards the solid, so that it is often near.
            let towards = (solid.in_world.translation - pose.translation) * 0.002;
            pose = Pose::new(turn * pose.rotation, pose.translation + by + towards);
            let before = clearance.measured;
            let limit_m = [0.05, 0.15][step % 2];
            let told = clearance.at(&tool, &solid, pose, (limit_m, 0.1), &mut workspace);
            let surface = solid.surface.mesh();
            let settings = DistanceSettings::default();
            let found = mesh_separation_with(&mesh, &pose, surface, &solid.in_world, settings, &mut other);
            let truth = found.unwrap().distance;
            assert!(told <= truth + 1e-9, "step {step}: {told} of {truth}");
            assert!(told >= truth.min(limit_m) - 1e-6, "step {step}: {told} of {truth}");
            near += usize::from(told < limit_m);
            kept += usize::from(before.is_some() && before == clearance.measured);
        }
        assert!(near > 200 && kept > 500, "{near} near, {kept} not measured again");
    }
}
