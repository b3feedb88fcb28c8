//! The core of a rounded obstacle around the origin: distances from it in lanes.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use elbowroom_validity::lanes::simd::{Select, Simd, f32x16, prelude::*};
use elbowroom_validity::lanes::{Fused, V3, splat};

/// A solid in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SolidCore {
    /// The origin.
    Point,
    /// A box around the origin, given by its half extents; a segment if two of them are 0.
    Box([f32; 3]),
    /// A cylinder about the z axis.
    Cylinder { radius: f32, half_length: f32 },
    /// All points with z ≤ 0.
    HalfSpace,
}

impl SolidCore {
    /// Vector from the nearest point of the core; a normal of the core if it is not 0.
    #[inline(always)]
    pub fn vector_to<S: Simd>(self, simd: S, p: V3<S>) -> V3<S> {
        let zero = splat(simd, 0.0);
        match self {
            Self::Point => p,
            Self::Box([x, y, z]) => V3(beyond(simd, p.0, x), beyond(simd, p.1, y), beyond(simd, p.2, z)),
            Self::Cylinder { radius, half_length } => {
                let across = p.1.fused(p.1, p.0 * p.0).sqrt();
                let excess = (across - splat(simd, radius)).max(zero);
                let share = across.simd_gt(zero).select(excess / across, zero);
                V3(p.0 * share, p.1 * share, beyond(simd, p.2, half_length))
            }
            Self::HalfSpace => V3(zero, zero, p.2.max(zero)),
        }
    }

    /// Distance of a point from the core; inside, it is negative and its size is at most the depth of the point.
    #[inline(always)]
    pub fn signed_distance<S: Simd>(self, simd: S, p: V3<S>) -> f32x16<S> {
        let vector = self.vector_to(simd, p);
        let outside = vector.dot(vector).sqrt();
        let zero = splat(simd, 0.0);
        match self {
            Self::Point => outside,
            Self::Box([x, y, z]) => {
                let excess = p.0.abs() - splat(simd, x);
                let excess = excess.max(p.1.abs() - splat(simd, y)).max(p.2.abs() - splat(simd, z));
                outside + excess.min(zero)
            }
            Self::Cylinder { radius, half_length } => {
                let across = p.1.fused(p.1, p.0 * p.0).sqrt() - splat(simd, radius);
                outside + across.max(p.2.abs() - splat(simd, half_length)).min(zero)
            }
            Self::HalfSpace => p.2,
        }
    }
}

/// A coordinate minus the nearest value of an interval around 0, given by its half length.
#[inline(always)]
fn beyond<S: Simd>(simd: S, p: f32x16<S>, half: f32) -> f32x16<S> {
    p - p.max(splat(simd, -half)).min(splat(simd, half))
}
