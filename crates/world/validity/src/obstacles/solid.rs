//! A convex obstacle with rounded edges: a box, point, segment, half-space or cylinder, with a radius around it.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use elbowroom_spatial::{Pose, Vec3};
use fearless_simd::{Select, Simd, f32x16, prelude::*};

use super::box_tree::Bounds;
use crate::lanes::{Fused, V3, splat};
use crate::model::single;

/// Length that represents "unbounded"; its product with zero is zero.
const FAR: f32 = 1e30;

/// All points within `radius` of a core.
#[derive(Debug, Clone)]
pub(crate) struct RoundedSolid {
    /// Origin of its frame in the world, m.
    origin: [f32; 3],
    /// Columns of its rotation; `None` if its axes are parallel to the world axes.
    columns: Option<[[f32; 3]; 3]>,
    core: Core,
    /// Radius around the core, m.
    pub radius: f32,
}

/// The core that the radius surrounds, in the frame of the solid.
#[derive(Debug, Clone, Copy)]
enum Core {
    /// A box. Points, segments and half-spaces are boxes with zero or unbounded extents.
    Box { low: [f32; 3], high: [f32; 3] },
    /// A cylinder about z.
    Cylinder { radius: f32, half_length: f32 },
}

/// A point relative to a solid, with the shortest vector from the core to the point.
pub(crate) struct FromCore<S: Simd> {
    /// The point in the frame of the solid.
    pub point: V3<S>,
    /// Vector from the nearest point of the core.
    pub vector: V3<S>,
}

impl RoundedSolid {
    pub fn point(centre: Vec3, radius: f32) -> Self {
        Self::with_core(Core::Box { low: [0.0; 3], high: [0.0; 3] }, None, centre, radius)
    }

    pub fn cuboid(half: Vec3, in_world: &Pose, radius: f32) -> Self {
        let half = single(half);
        Self::with_core(Core::Box { low: half.map(|h| -h), high: half }, Some(in_world), in_world.translation, radius)
    }

    pub fn segment(half_length: f64, in_world: &Pose, radius: f32) -> Self {
        Self::cuboid(Vec3::Z * half_length, in_world, radius)
    }

    pub fn half_space(in_world: &Pose, radius: f32) -> Self {
        let core = Core::Box { low: [-FAR; 3], high: [FAR, FAR, 0.0] };
        Self::with_core(core, Some(in_world), in_world.translation, radius)
    }

    pub fn cylinder(core_radius: f64, half_length: f64, in_world: &Pose, radius: f32) -> Self {
        let core = Core::Cylinder { radius: core_radius as f32, half_length: half_length as f32 };
        Self::with_core(core, Some(in_world), in_world.translation, radius)
    }

    fn with_core(core: Core, in_world: Option<&Pose>, origin: Vec3, radius: f32) -> Self {
        let columns = in_world.map(|p| p.rotation).map(|r| [r.x_axis(), r.y_axis(), r.z_axis()].map(single));
        let columns = columns.filter(|c| *c != [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        Self { origin: single(origin), columns, core, radius }
    }

    /// A box around the solid in the world.
    pub fn bounds(&self) -> Bounds {
        let (centre, half) = self.core.centre_and_half();
        let axes = self.columns.unwrap_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let mut bounds = Bounds::EMPTY;
        for k in 0..3 {
            let middle: f32 = self.origin[k] + (0..3).map(|i| axes[i][k] * centre[i]).sum::<f32>();
            let reach: f32 = (0..3).map(|i| (axes[i][k] * half[i]).abs()).sum::<f32>() + self.radius;
            // A generous bound on the rounding errors of this sum.
            let reach = reach + 1e-6 * (reach + middle.abs() + self.origin[k].abs());
            (bounds.min[k], bounds.max[k]) = (middle - reach, middle + reach);
        }
        bounds
    }

    /// The vector from the core to a point of the world.
    #[inline(always)]
    pub fn vector_from_core<S: Simd>(&self, simd: S, at: V3<S>) -> FromCore<S> {
        let offset = at.minus(V3::splat(simd, self.origin));
        let point = match &self.columns {
            None => offset,
            Some(c) => V3(
                offset.dot(V3::splat(simd, c[0])),
                offset.dot(V3::splat(simd, c[1])),
                offset.dot(V3::splat(simd, c[2])),
            ),
        };
        FromCore { point, vector: self.core.vector_to(simd, point) }
    }

    /// The largest product of a point of the core with a direction, both in the frame of the solid.
    #[inline(always)]
    pub fn support<S: Simd>(&self, simd: S, d: V3<S>) -> f32x16<S> {
        match self.core {
            Core::Box { low, high } => {
                support_along(simd, d.0, low[0], high[0])
                    + support_along(simd, d.1, low[1], high[1])
                    + support_along(simd, d.2, low[2], high[2])
            }
            Core::Cylinder { radius, half_length } => {
                let across = d.1.fused(d.1, d.0 * d.0).sqrt();
                across.fused(splat(simd, radius), d.2.abs() * splat(simd, half_length))
            }
        }
    }
}

#[inline(always)]
fn support_along<S: Simd>(simd: S, d: f32x16<S>, low: f32, high: f32) -> f32x16<S> {
    (d * splat(simd, low)).max(d * splat(simd, high))
}

/// Difference of a coordinate and the nearest coordinate of an interval.
#[inline(always)]
fn beyond<S: Simd>(simd: S, p: f32x16<S>, low: f32, high: f32) -> f32x16<S> {
    p - p.max(splat(simd, low)).min(splat(simd, high))
}

impl Core {
    fn centre_and_half(&self) -> ([f32; 3], [f32; 3]) {
        match *self {
            Self::Box { low, high } => {
                ([0, 1, 2].map(|k| 0.5 * (low[k] + high[k])), [0, 1, 2].map(|k| 0.5 * (high[k] - low[k])))
            }
            Self::Cylinder { radius, half_length } => ([0.0; 3], [radius, radius, half_length]),
        }
    }

    #[inline(always)]
    fn vector_to<S: Simd>(&self, simd: S, p: V3<S>) -> V3<S> {
        match *self {
            Self::Box { low, high } => V3(
                beyond(simd, p.0, low[0], high[0]),
                beyond(simd, p.1, low[1], high[1]),
                beyond(simd, p.2, low[2], high[2]),
            ),
            Self::Cylinder { radius, half_length } => {
                let zero = splat(simd, 0.0);
                let across = p.1.fused(p.1, p.0 * p.0).sqrt();
                let outside = (across - splat(simd, radius)).max(zero);
                let share = across.simd_gt(zero).select(outside / across, zero);
                V3(p.0 * share, p.1 * share, beyond(simd, p.2, -half_length, half_length))
            }
        }
    }
}
