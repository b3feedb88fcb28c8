//! Vectors of lanes: three coordinates, each a SIMD register.
//!
//! f32 lanes fuse multiplications with additions where the processor can, f64 lanes never do: what f32 decides is
//! safe however it rounds, and what is told was measured in f64, alike on every instruction set.

use std::ops::{Add, Mul, Sub};

use fearless_simd::{Simd, f32x8, f32x16, f64x8, prelude::*};

/// Arithmetic of one register.
pub(super) trait Lanes: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// `self·k + c`, in one rounding or in two.
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

/// Three coordinates of many points.
#[derive(Clone, Copy)]
pub(super) struct V3<T>(pub T, pub T, pub T);

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
pub(super) type W8<S> = f32x8<S>;

#[inline(always)]
pub(super) fn load16<S: Simd>(simd: S, p: &[[f32; 16]; 3]) -> V3<W16<S>> {
    V3(W16::load_array_ref(simd, &p[0]), W16::load_array_ref(simd, &p[1]), W16::load_array_ref(simd, &p[2]))
}

#[inline(always)]
pub(super) fn splat16<S: Simd>(simd: S, p: [f32; 3]) -> V3<W16<S>> {
    V3(W16::splat(simd, p[0]), W16::splat(simd, p[1]), W16::splat(simd, p[2]))
}

/// A row of three numbers, each in all lanes.
#[inline(always)]
pub(super) fn row16<S: Simd>(simd: S, r: [f32; 3]) -> [W16<S>; 3] {
    [W16::splat(simd, r[0]), W16::splat(simd, r[1]), W16::splat(simd, r[2])]
}

#[inline(always)]
pub(super) fn rows16<S: Simd>(simd: S, m: &[[f32; 3]; 3]) -> [[W16<S>; 3]; 3] {
    [row16(simd, m[0]), row16(simd, m[1]), row16(simd, m[2])]
}

#[inline(always)]
pub(super) fn abs16<S: Simd>(v: V3<W16<S>>) -> V3<W16<S>> {
    V3(v.0.abs(), v.1.abs(), v.2.abs())
}

#[inline(always)]
pub(super) fn store16<S: Simd>(v: V3<W16<S>>) -> [[f32; 16]; 3] {
    let mut out = [[0.0; 16]; 3];
    v.0.store_slice(&mut out[0]);
    v.1.store_slice(&mut out[1]);
    v.2.store_slice(&mut out[2]);
    out
}

#[inline(always)]
pub(super) fn load8<S: Simd>(simd: S, p: &[[f32; 8]; 3]) -> V3<W8<S>> {
    V3(W8::load_array_ref(simd, &p[0]), W8::load_array_ref(simd, &p[1]), W8::load_array_ref(simd, &p[2]))
}

#[inline(always)]
pub(super) fn load_corners<S: Simd>(simd: S, p: &[[[f32; 8]; 3]; 3]) -> [V3<W8<S>>; 3] {
    [load8(simd, &p[0]), load8(simd, &p[1]), load8(simd, &p[2])]
}

#[inline(always)]
pub(super) fn rows8<S: Simd>(simd: S, m: &[[f32; 3]; 3]) -> [[W8<S>; 3]; 3] {
    [row8(simd, m[0]), row8(simd, m[1]), row8(simd, m[2])]
}

#[inline(always)]
fn row8<S: Simd>(simd: S, r: [f32; 3]) -> [W8<S>; 3] {
    [W8::splat(simd, r[0]), W8::splat(simd, r[1]), W8::splat(simd, r[2])]
}

#[inline(always)]
pub(super) fn splat8<S: Simd>(simd: S, p: [f32; 3]) -> V3<W8<S>> {
    V3(W8::splat(simd, p[0]), W8::splat(simd, p[1]), W8::splat(simd, p[2]))
}
