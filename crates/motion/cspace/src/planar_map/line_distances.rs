//! Kernels: distances of an outline's lines from the shoulder.

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, dispatch};

use super::context::ConvexContext;
use super::normals::{OutlineNormals, PADDED_NORMALS};
use super::plane_solid::{PlaneSolid, TiltedDirections};
use super::simd_math::{WIDTH, load, mad, splat};
use super::wedge_support::support_distance;

/// Radius from which the grown solid intersects the wedge, metres; negative if the solid itself intersects it.
pub(super) fn reaching_radius<B: PlaneSolid>(context: &ConvexContext, solid: &B, lean: f32, side: f32) -> f32 {
    let offset = context.arm.offset_m as f32;
    dispatch!(context.simd_level, simd => reaching_radius_lanes(simd, solid, lean, side, offset))
}

/// Three directions in three lanes: across the right and the left side of the wedge, and ahead.
#[inline(always)]
fn reaching_radius_lanes<S: Simd, B: PlaneSolid>(simd: S, solid: &B, lean: f32, side: f32, offset: f32) -> f32 {
    let lanes = |first: [f32; 3]| {
        let mut all = [0.0; WIDTH];
        all[..3].copy_from_slice(&first);
        load(simd, &all)
    };
    let directions = TiltedDirections {
        x: lanes([0.0, 0.0, side]),
        z: splat(simd, 0.0),
        lean: lanes([lean, lean, 0.0]),
        side: lanes([1.0, -1.0, 0.0]),
    };
    let piece = solid.linear_piece(simd, &directions, lanes([1.0, 1.0, 0.0]));
    let (at, slope) = (piece.at.to_array(), piece.slope.to_array());
    let beside = slope[0].min(slope[1]) * (1.0 / (1.0 + lean * lean).sqrt());
    let ahead = at[2] + side * offset;
    -beside.min(ahead)
}

/// Distances from the shoulder of the lines that bound the solid, grown by a radius and cut by the wedge.
pub(super) fn line_distances<B: PlaneSolid>(
    context: &ConvexContext,
    solid: &B,
    normals: &OutlineNormals,
    lean: f32,
    radius: f32,
    out: &mut [f32; PADDED_NORMALS],
) {
    dispatch!(context.simd_level, simd => line_distances_lanes(simd, context, solid, normals, lean, radius, out));
}

#[inline(always)]
fn line_distances_lanes<S: Simd, B: PlaneSolid>(
    simd: S,
    context: &ConvexContext,
    solid: &B,
    normals: &OutlineNormals,
    lean: f32,
    radius: f32,
    out: &mut [f32; PADDED_NORMALS],
) {
    let radius = radius + context.margin;
    let zero = splat(simd, 0.0);
    let side = splat(simd, lean.signum());
    let offset = splat(simd, context.arm.offset_m as f32);
    let [up, down] = solid.vertical_extents();
    let stretch = splat(simd, context.max_stretch);
    // The part out of the arm's reach does not matter, and rotating far corners would enlarge the outline.
    let length = (context.arm.upper_length_m + context.arm.fore_length_m) as f32;
    let limit = splat(simd, length * (1.0 + 1e-5) + context.margin);
    for at in (0..normals.count).step_by(WIDTH) {
        let (x, z) = (load(simd, &normals.x[at..]), -load(simd, &normals.y[at..]));
        let distance = support_distance(simd, solid, [x, z], lean, radius);
        // In this wedge, everything is in front of the base axis.
        let height = (z * splat(simd, up)).max(z * splat(simd, -down));
        let axis = mad(z.abs(), splat(simd, radius), height) - x * offset;
        let inward = (x * side).simd_lt(zero);
        let distance = inward.select(distance.min(axis), distance);
        let outward = (x * side).max(zero) * stretch;
        (distance + outward).min(limit).store_slice(&mut out[at..at + WIDTH]);
    }
}
