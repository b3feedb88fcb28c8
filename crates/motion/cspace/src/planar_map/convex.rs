//! Boxes and convex polyhedra: outlines per plane, intervals per row.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::arm_grid::ArmGrid;
use super::context::{ConvexContext, Outlines, PlaneRows};
use super::line_distances::{line_distances, reaching_radius};
use super::normals::OutlineNormals;
use super::outline::Directions;
use super::plane_solid::PlaneSolid;
use super::rows::write_plane;
use super::simd_math::ANGLE_ERROR;
use super::upper_arm;
use crate::Layer;

/// Margin for angles seen from the shoulder in single precision, radians.
const UPPER_MARGIN: f64 = 2.0 * ANGLE_ERROR as f64;

/// Adds the spans of some planes. `solid` is the obstacle in the frame of a plane of the arm; `full_rows` is workspace.
pub(super) fn build<B: PlaneSolid>(
    arm_grid: &ArmGrid,
    context: &ConvexContext,
    solid: &mut B,
    planes: Range<usize>,
    full_rows: &mut [u16],
    layer: &mut Layer,
) {
    let mut outlines = Outlines::new(context);
    let shoulder = &arm_grid.grid.axes()[1];
    for (i, &plane) in arm_grid.planes.iter().enumerate().take(planes.end).skip(planes.start) {
        let before = layer.spans.len();
        let mut ordered = true;
        for side in [1.0, -1.0] {
            if !context.may_reach(plane, side) {
                continue;
            }
            solid.rotate_to_plane(plane);
            if !outlines.set_normals(context, solid, side) {
                continue;
            }
            full_rows.fill(0);
            if let Some((lo, hi)) = outlines.set_upper(context, solid, side).range_from(-PI) {
                upper_arm::mark_rows(shoulder, lo - UPPER_MARGIN, hi + UPPER_MARGIN, full_rows);
            }
            let rows = PlaneRows {
                first: i * shoulder.count(),
                count: shoulder.count(),
                full: full_rows,
                middles: &arm_grid.middles,
                borders: &arm_grid.borders,
            };
            ordered &= before == layer.spans.len();
            ordered &= outlines.write_rows(context, solid, side, &rows, layer);
        }
        if !ordered {
            layer.spans[before..].sort_unstable();
        }
    }
}

impl Outlines {
    /// Determines the links that reach the solid in one plane, and the normals of its outline; false if no link reaches
    /// it.
    fn set_normals<B: PlaneSolid>(&mut self, context: &ConvexContext, solid: &B, side: f64) -> bool {
        let lean = (context.tangent * side) as f32;
        let gap = reaching_radius(context, solid, lean, side as f32) - context.margin;
        let arm = &context.arm;
        let [upper, fore, wrist] = [arm.upper_radius_m, arm.fore_radius_m, arm.wrist_radius_m].map(|r| r as f32);
        (self.upper.exists, self.fore.exists, self.wrist.exists) = (upper >= gap, fore >= gap, wrist >= gap);
        if !(self.upper.exists || self.fore.exists || self.wrist.exists) {
            return false;
        }
        // In the shoulder's frame y is down, in the solid's frame z is up.
        let own = solid.own_directions(lean).map(|[x, z]| [x, -z]);
        self.normals = OutlineNormals::new(own, context.spacing_cosine);
        true
    }

    /// Sets the upper arm's outline; returns the directions in which the upper arm meets it.
    fn set_upper<B: PlaneSolid>(&mut self, context: &ConvexContext, solid: &B, side: f64) -> Directions {
        if !self.upper.exists {
            return Directions::Nowhere;
        }
        let (lean, radius) = ((context.tangent * side) as f32, context.arm.upper_radius_m as f32);
        line_distances(context, solid, &self.normals, lean, radius, &mut self.upper.far);
        self.upper.complete_within(context.simd_level, &self.normals, context.upper_reach)
    }

    /// Adds the spans of one plane; false if their rows do not ascend.
    ///
    /// The convex hull of a solid rotated about the shoulder is little larger than the solid if the solid is within a
    /// narrow angle, but much larger if it surrounds the shoulder. Such a solid is cut into sectors.
    fn write_rows<B: PlaneSolid>(
        &mut self,
        context: &ConvexContext,
        solid: &B,
        side: f64,
        rows: &PlaneRows,
        layer: &mut Layer,
    ) -> bool {
        let lean = (context.tangent * side) as f32;
        if !(self.fore.exists || self.wrist.exists) {
            return write_plane(context, self, rows, true, layer);
        }
        let (lo, hi) = self.set_rotated(context, solid, lean, None).range_from(0.0).unwrap_or((0.0, TAU));
        if hi - lo < context.sectors.whole_rad {
            return write_plane(context, self, rows, true, layer);
        }
        let sectors = ((hi - lo) / context.sectors.width_rad).ceil();
        let exist = (self.fore.exists, self.wrist.exists);
        for k in 0..sectors as u32 {
            let border = |k: u32| (lo + (hi - lo) * f64::from(k) / sectors).sin_cos();
            let ((sin, cos), (next_sin, next_cos)) = (border(k), border(k + 1));
            let sides = [[sin as f32, -cos as f32], [-next_sin as f32, next_cos as f32]];
            let own = solid.own_directions(lean).map(|[x, z]| [x, -z]);
            self.normals = OutlineNormals::new(sides.into_iter().chain(own), context.spacing_cosine);
            (self.fore.exists, self.wrist.exists) = exist;
            self.set_rotated(context, solid, lean, Some(sides));
            write_plane(context, self, rows, k == 0, layer);
        }
        false
    }

    /// Sets the outlines of forearm and wrist, or their parts in a sector with these two normals, rotated by half a
    /// step of θ2. Returns the directions from the shoulder in which the larger outline lies before the rotation.
    fn set_rotated<B: PlaneSolid>(
        &mut self,
        context: &ConvexContext,
        solid: &B,
        lean: f32,
        sector: Option<[[f32; 2]; 2]>,
    ) -> Directions {
        let Self { normals, raw, fore, wrist, .. } = self;
        let mut directions = Directions::Nowhere;
        for (link, radius) in [(wrist, context.arm.wrist_radius_m), (fore, context.arm.fore_radius_m)] {
            if !link.exists {
                continue;
            }
            line_distances(context, solid, normals, lean, radius as f32, &mut raw.far);
            for [x, y] in sector.into_iter().flatten() {
                // The nearest normal is the sector's own: its sides are inserted first.
                let along = |k: &usize| normals.x[*k] * x + normals.y[*k] * y;
                if let Some(k) = (0..normals.count).max_by(|a, b| along(a).total_cmp(&along(b))) {
                    raw.far[k] = raw.far[k].min(context.margin);
                }
            }
            directions = directions.union(raw.rotate_both_ways(context.simd_level, normals, context.turn, link));
        }
        // If the wrist's outline vanishes by rounding, the end of the forearm uses the forearm's outline.
        if self.fore.exists && !self.wrist.exists {
            self.wrist.clone_from(&self.fore);
        }
        self.set_reach_limits(context);
        directions
    }
}
