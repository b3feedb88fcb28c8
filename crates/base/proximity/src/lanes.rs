//! SIMD lanes: points as three registers of coordinates, and the choice of the instruction set.
//!
//! f32 lanes fuse multiplications with additions if the processor can; f64 lanes never do. Decisions in f32 are
//! conservative whatever the rounding. Returned distances are computed in f64 and do not depend on the instruction
//! set.

// A kernel is compiled for the lowest instruction set unless it is inlined into the function that selects the set.
#![allow(clippy::inline_always)]

use std::ops::{Add, Mul, Sub};
use std::sync::OnceLock;

use elbowroom_spatial::Vec3;
use fearless_simd::{Level as SimdLevel, Simd, f32x8, f32x16, f64x8, prelude::*};

/// Error bound of a gap in f32, per unit of extent: 2⁻¹⁷ = 128 half-units of rounding. README.md of `mesh_mesh`
/// counts 75 for the worst test.
pub(crate) const F32_ERROR: f64 = 1.0 / 131_072.0;

/// The best instruction set of this processor, detected once.
#[inline]
pub(crate) fn detected_simd_level() -> SimdLevel {
    static DETECTED: OnceLock<SimdLevel> = OnceLock::new();
    *DETECTED.get_or_init(SimdLevel::new)
}

/// Arithmetic on one register.
pub(crate) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// `self·k + c`, with one rounding or two.
    fn times_plus(self, k: Self, c: Self) -> Self;
}

impl<S: Simd> Lanes for f32x16<S> {
    #[inline(always)]
    fn times_plus(self, k: Self, c: Self) -> Self {
        self.mul_add(k, c)
    }
}

impl<S: Simd> Lanes for f32x8<S> {
    #[inline(always)]
    fn times_plus(self, k: Self, c: Self) -> Self {
        self.mul_add(k, c)
    }
}

impl<S: Simd> Lanes for f64x8<S> {
    #[inline(always)]
    fn times_plus(self, k: Self, c: Self) -> Self {
        self * k + c
    }
}

/// The three coordinates of many points.
#[derive(Clone, Copy)]
pub(crate) struct V3<T>(pub T, pub T, pub T);

impl<T: Lanes> V3<T> {
    #[inline(always)]
    pub fn dot(self, o: Self) -> T {
        self.2.times_plus(o.2, self.1.times_plus(o.1, self.0 * o.0))
    }

    #[inline(always)]
    pub fn minus(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1, self.2 - o.2)
    }

    #[inline(always)]
    pub fn plus(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1, self.2 + o.2)
    }

    #[inline(always)]
    pub fn times(self, k: T) -> Self {
        Self(self.0 * k, self.1 * k, self.2 * k)
    }

    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self(self.1 * o.2 - self.2 * o.1, self.2 * o.0 - self.0 * o.2, self.0 * o.1 - self.1 * o.0)
    }

    /// `[rows]·self`, each row given as three broadcast numbers.
    #[inline(always)]
    pub fn mapped(self, rows: &[[T; 3]; 3]) -> Self {
        Self(self.along(&rows[0]), self.along(&rows[1]), self.along(&rows[2]))
    }

    #[inline(always)]
    fn along(self, r: &[T; 3]) -> T {
        self.2.times_plus(r[2], self.1.times_plus(r[1], self.0 * r[0]))
    }

    /// `[rows]·self + shift`.
    #[inline(always)]
    pub fn placed(self, rows: &[[T; 3]; 3], shift: Self) -> Self {
        let along = |r: &[T; 3], c: T| self.2.times_plus(r[2], self.1.times_plus(r[1], self.0.times_plus(r[0], c)));
        Self(along(&rows[0], shift.0), along(&rows[1], shift.1), along(&rows[2], shift.2))
    }
}

pub(crate) type W16<S> = f32x16<S>;
pub(crate) type W8<S> = f32x8<S>;

#[inline(always)]
pub(crate) fn load16<S: Simd>(simd: S, p: &[[f32; 16]; 3]) -> V3<W16<S>> {
    V3(W16::load_array_ref(simd, &p[0]), W16::load_array_ref(simd, &p[1]), W16::load_array_ref(simd, &p[2]))
}

#[inline(always)]
pub(crate) fn splat16<S: Simd>(simd: S, p: [f32; 3]) -> V3<W16<S>> {
    V3(W16::splat(simd, p[0]), W16::splat(simd, p[1]), W16::splat(simd, p[2]))
}

/// A row of three numbers, each in all lanes.
#[inline(always)]
pub(crate) fn row16<S: Simd>(simd: S, r: [f32; 3]) -> [W16<S>; 3] {
    [W16::splat(simd, r[0]), W16::splat(simd, r[1]), W16::splat(simd, r[2])]
}

#[inline(always)]
pub(crate) fn rows16<S: Simd>(simd: S, m: &[[f32; 3]; 3]) -> [[W16<S>; 3]; 3] {
    [row16(simd, m[0]), row16(simd, m[1]), row16(simd, m[2])]
}

#[inline(always)]
pub(crate) fn abs16<S: Simd>(v: V3<W16<S>>) -> V3<W16<S>> {
    V3(v.0.abs(), v.1.abs(), v.2.abs())
}

#[inline(always)]
pub(crate) fn store16<S: Simd>(v: V3<W16<S>>) -> [[f32; 16]; 3] {
    let mut out = [[0.0; 16]; 3];
    v.0.store_slice(&mut out[0]);
    v.1.store_slice(&mut out[1]);
    v.2.store_slice(&mut out[2]);
    out
}

#[inline(always)]
pub(crate) fn load8<S: Simd>(simd: S, p: &[[f32; 8]; 3]) -> V3<W8<S>> {
    V3(W8::load_array_ref(simd, &p[0]), W8::load_array_ref(simd, &p[1]), W8::load_array_ref(simd, &p[2]))
}

#[inline(always)]
pub(crate) fn load_corners<S: Simd>(simd: S, p: &[[[f32; 8]; 3]; 3]) -> [V3<W8<S>>; 3] {
    [load8(simd, &p[0]), load8(simd, &p[1]), load8(simd, &p[2])]
}

#[inline(always)]
pub(crate) fn rows8<S: Simd>(simd: S, m: &[[f32; 3]; 3]) -> [[W8<S>; 3]; 3] {
    [row8(simd, m[0]), row8(simd, m[1]), row8(simd, m[2])]
}

#[inline(always)]
fn row8<S: Simd>(simd: S, r: [f32; 3]) -> [W8<S>; 3] {
    [W8::splat(simd, r[0]), W8::splat(simd, r[1]), W8::splat(simd, r[2])]
}

#[inline(always)]
pub(crate) fn splat8<S: Simd>(simd: S, p: [f32; 3]) -> V3<W8<S>> {
    V3(W8::splat(simd, p[0]), W8::splat(simd, p[1]), W8::splat(simd, p[2]))
}

#[inline(always)]
pub(crate) fn store8<S: Simd>(v: V3<W8<S>>) -> [[f32; 8]; 3] {
    let mut out = [[0.0; 8]; 3];
    v.0.store_slice(&mut out[0]);
    v.1.store_slice(&mut out[1]);
    v.2.store_slice(&mut out[2]);
    out
}

#[inline(always)]
pub(crate) fn array16<S: Simd>(x: W16<S>) -> [f32; 16] {
    let mut out = [0.0; 16];
    x.store_slice(&mut out);
    out
}

#[inline(always)]
pub(crate) fn array8<S: Simd>(x: W8<S>) -> [f32; 8] {
    let mut out = [0.0; 8];
    x.store_slice(&mut out);
    out
}

/// Converts a vector to single precision.
#[inline]
pub(crate) fn narrow(v: Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}
