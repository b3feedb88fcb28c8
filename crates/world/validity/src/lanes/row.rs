//! Rows of sixteen numbers, points of sixteen lanes, and the choice of the instruction set.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use std::sync::OnceLock;

use fearless_simd::{Level as SimdLevel, Simd, f32x16, prelude::*};

/// Number of lanes.
pub const LANES: usize = 16;

/// The best instruction set of this processor, detected once.
#[inline]
pub fn detected_simd_level() -> SimdLevel {
    static DETECTED: OnceLock<SimdLevel> = OnceLock::new();
    *DETECTED.get_or_init(SimdLevel::new)
}

/// The same number in all lanes.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, v: f32) -> f32x16<S> {
    f32x16::splat(simd, v)
}

/// Multiplication and addition, rounded once.
pub trait Fused: Sized {
    /// `self·k + c`, rounded once on every instruction set.
    #[must_use]
    fn fused(self, k: Self, c: Self) -> Self;
}

impl<S: Simd> Fused for f32x16<S> {
    #[inline(always)]
    fn fused(self, k: Self, c: Self) -> Self {
        // Without a hardware instruction, sixteen inlined calls would make kernels large and slow to compile.
        #[cfg(target_arch = "x86_64")]
        if matches!(self.simd.level(), SimdLevel::Sse2(_) | SimdLevel::Sse4_2(_)) {
            let [mut a, mut b, mut sum] = [[0.0; LANES]; 3];
            self.store_slice(&mut a);
            k.store_slice(&mut b);
            c.store_slice(&mut sum);
            fused_in_software(&a, &b, &mut sum);
            return Self::simd_from(self.simd, sum);
        }
        self.mul_add_precise(k, c)
    }
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn fused_in_software(a: &[f32; LANES], b: &[f32; LANES], sum: &mut [f32; LANES]) {
    for lane in 0..LANES {
        sum[lane] = a[lane].mul_add(b[lane], sum[lane]);
    }
}

/// One number per lane, in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Row(pub [f32; LANES]);

impl Row {
    /// 0 in all lanes.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// Loads the row from memory.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S) -> f32x16<S> {
        f32x16::simd_from(simd, self.0)
    }

    /// Stores lanes in memory.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, lanes: f32x16<S>) {
        lanes.store_slice(&mut self.0);
    }
}

/// Three coordinates per lane, in memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointRow(pub [Row; 3]);

impl PointRow {
    /// 0 in all lanes.
    pub const ZERO: Self = Self([Row::ZERO; 3]);

    /// Loads the points from memory.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S) -> V3<S> {
        V3(self.0[0].load(simd), self.0[1].load(simd), self.0[2].load(simd))
    }

    /// Stores points in memory.
    #[inline(always)]
    pub fn store<S: Simd>(&mut self, v: V3<S>) {
        self.0[0].store(v.0);
        self.0[1].store(v.1);
        self.0[2].store(v.2);
    }
}

/// Three coordinates per lane.
#[derive(Debug, Clone, Copy)]
pub struct V3<S: Simd>(pub f32x16<S>, pub f32x16<S>, pub f32x16<S>);

impl<S: Simd> V3<S> {
    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat(simd: S, v: [f32; 3]) -> Self {
        Self(f32x16::splat(simd, v[0]), f32x16::splat(simd, v[1]), f32x16::splat(simd, v[2]))
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> f32x16<S> {
        self.2.fused(o.2, self.1.fused(o.1, self.0 * o.0))
    }

    /// Difference.
    #[must_use]
    #[inline(always)]
    pub fn minus(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1, self.2 - o.2)
    }

    /// Sum.
    #[must_use]
    #[inline(always)]
    pub fn plus(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1, self.2 + o.2)
    }

    /// `self·k + c`.
    #[must_use]
    #[inline(always)]
    pub fn times_plus(self, k: f32x16<S>, c: Self) -> Self {
        Self(self.0.fused(k, c.0), self.1.fused(k, c.1), self.2.fused(k, c.2))
    }

    /// Shifts the coordinates by one lane: each lane gets those of the next lane; the last lane keeps its own.
    #[must_use]
    #[inline(always)]
    pub fn next_lane(self) -> Self {
        Self(next_lane(self.0), next_lane(self.1), next_lane(self.2))
    }
}

/// Shifts the values by one lane: each lane gets the value of the next lane; the last lane keeps its own.
#[inline(always)]
fn next_lane<S: Simd>(v: f32x16<S>) -> f32x16<S> {
    let last = v[LANES - 1];
    v.slide::<1>(f32x16::splat(v.simd, last))
}
