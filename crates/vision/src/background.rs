//! What the empty cell looks like, pixel by pixel: a running mean and a running mean deviation, in 16-bit fixed point.
//!
//! Grey levels carry 7 bits behind the point in means (`_q7`), 4 in differences (`_q4`), 9 in deviations (`_q9`); rows
//! are plain loops over slices of equal length, which the compiler turns into vector instructions, of the widest kind that
//! the processor has ([`dispatch!`]). The model stays in
//! the light in which it was learnt; [`Light`] takes it to the light of today, and slow adaptation does the rest.

#![expect(clippy::inline_always, reason = "code that is not inlined is not compiled for the wider instructions")]

use fearless_simd::{Level, Simd, dispatch};

use crate::light::Light;

/// Deviations beyond this are cut: 12 grey levels. A pixel that flickers more is foreground now and then, which is safe; one
/// that were allowed to would see nothing any more.
const MOST_DEVIATION_Q4: i16 = 12 << 4;
/// The brightest expectation, 255 grey levels.
const WHITE_Q4: i16 = 255 << 4;
const WHITE_Q7: i16 = 255 << 7;

/// How a pixel is told from the background.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Least difference that counts, grey levels.
    pub(crate) least: f64,
    /// Difference that counts in mean deviations.
    pub(crate) factor: f64,
    /// Brightness that a shadow leaves, from and to; an empty range where shadows count as objects.
    pub(crate) shadow: (f64, f64),
}

/// One plane (grey, or one of three colours) of the model.
#[derive(Debug, Clone, Default)]
pub(crate) struct Plane {
    mean_q7: Vec<i16>,
    deviation_q9: Vec<i16>,
}

/// [`Limits`] and [`Light`] in fixed point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kernel {
    gain_q13: i16,
    offset_q4: i16,
    least_q4: i16,
    factor_q11: i16,
    shadow_from_q14: i16,
    shadow_to_q14: i16,
}

/// What [`Kernel::classify`] writes: nothing, as dark as a shadow may be, certainly no shadow.
pub(crate) const SHADOW: u8 = 1;
pub(crate) const OBJECT: u8 = 3;

#[inline(always)]
fn high_product(a: i16, b: i16) -> i16 {
    ((i32::from(a) * i32::from(b)) >> 16) as i16
}

impl Kernel {
    pub(crate) fn new(light: &Light, limits: &Limits) -> Self {
        let fixed = |x: f64, bits: i32| (x * f64::from(1 << bits)).round().clamp(-32_767.0, 32_767.0) as i16;
        Self {
            gain_q13: fixed(light.gain, 13),
            offset_q4: fixed(light.offset, 4),
            least_q4: fixed(limits.least, 4),
            factor_q11: fixed(limits.factor, 11),
            shadow_from_q14: fixed(limits.shadow.0, 14),
            shadow_to_q14: fixed(limits.shadow.1, 14),
        }
    }

    #[inline(always)]
    fn expected_q4(&self, mean_q7: i16) -> i16 {
        high_product(mean_q7, self.gain_q13).saturating_add(self.offset_q4).clamp(0, WHITE_Q4)
    }

    #[inline(always)]
    fn limit_q4(&self, deviation_q9: i16) -> i16 {
        high_product(deviation_q9, self.factor_q11).max(self.least_q4)
    }

    /// Adds the class of each pixel of a row to `class` (by `|`, so that planes add up).
    #[expect(clippy::needless_bitwise_bool, reason = "branches would keep the loop from becoming vector instructions")]
    #[inline(always)]
    fn classify<S: Simd>(&self, _widest: S, row: &[u8], mean_q7: &[i16], deviation_q9: &[i16], class: &mut [u8]) {
        let n = class.len();
        let (row, mean_q7, deviation_q9) = (&row[..n], &mean_q7[..n], &deviation_q9[..n]);
        for i in 0..n {
            let expected = self.expected_q4(mean_q7[i]);
            let seen = i16::from(row[i]) << 4;
            let difference = seen - expected;
            let differs = difference.max(-difference) > self.limit_q4(deviation_q9[i]);
            let from = high_product(expected << 2, self.shadow_from_q14);
            let to = high_product(expected << 2, self.shadow_to_q14);
            let is_shade = (seen >= from) & (seen <= to);
            class[i] |= u8::from(differs) | (u8::from(differs & !is_shade) << 1);
        }
    }

    /// Moves a row of the model towards what is seen, except where something is `held` and where what is seen is not the
    /// floor: a shadow that stays must not make the floor under it look noisy, and so blind.
    #[inline(always)]
    fn adapt<S: Simd>(
        &self,
        _widest: S,
        row: &[u8],
        held: &[u8],
        mean_q7: &mut [i16],
        deviation_q9: &mut [i16],
        shift: u32,
    ) {
        let n = row.len();
        let (held, mean_q7, deviation_q9) = (&held[..n], &mut mean_q7[..n], &mut deviation_q9[..n]);
        let half = (1_i16 << shift) >> 1;
        for i in 0..n {
            let difference = (i16::from(row[i]) << 4) - self.expected_q4(mean_q7[i]);
            let size = difference.max(-difference);
            let free = -i16::from(held[i] == 0);
            let alike = -i16::from(size <= self.limit_q4(deviation_q9[i]));
            let step = (difference << 3).saturating_add(half) >> shift;
            mean_q7[i] = (mean_q7[i].saturating_add(step & free & alike)).clamp(0, WHITE_Q7);
            let towards = (size.min(MOST_DEVIATION_Q4) << 5) - deviation_q9[i];
            deviation_q9[i] += (towards.saturating_add(half) >> shift) & free & alike;
        }
    }
}

impl Plane {
    pub(crate) fn forget(&mut self, pixels: usize) {
        self.mean_q7.clear();
        self.mean_q7.resize(pixels, 0);
        self.deviation_q9.clear();
        self.deviation_q9.resize(pixels, 0);
    }

    /// The mean grey level of pixel `i`, in the light in which the model was learnt.
    pub(crate) fn mean(&self, i: usize) -> f32 {
        f32::from(self.mean_q7[i]) / 128.0
    }

    /// Takes in a picture of the empty cell; each pixel's pictures count alike. `nth` is the number of pictures taken in
    /// per pixel, this one included; pixels with a `hidden` other than 0 are left out.
    pub(crate) fn learn(&mut self, pixels: &[u8], nth: &[u16], hidden: &[u8]) {
        let models = self.mean_q7.iter_mut().zip(&mut self.deviation_q9);
        let inputs = pixels.iter().zip(nth).zip(hidden);
        for (((&seen, &nth), &hidden), (mean, deviation)) in inputs.zip(models) {
            if hidden != 0 {
                continue;
            }
            let weight_q16 = 65_536 / i32::from(nth.max(1));
            let difference = (i32::from(seen) << 7) - i32::from(*mean);
            *mean += ((difference * weight_q16 + 32_768) >> 16) as i16;
            if nth > 1 {
                let size_q9 = (difference.abs() << 2).min(i32::from(MOST_DEVIATION_Q4) << 5);
                *deviation += (((size_q9 - i32::from(*deviation)) * weight_q16 + 32_768) >> 16) as i16;
            }
        }
    }

    /// Adds the class of each pixel to `class`.
    pub(crate) fn classify(&self, kernel: &Kernel, pixels: &[u8], class: &mut [u8]) {
        dispatch!(Level::new(), simd => kernel.classify(simd, pixels, &self.mean_q7, &self.deviation_q9, class));
    }

    /// Adapts some rows: each of them moves by 1 / 2^`shift` of the difference.
    pub(crate) fn adapt(&mut self, kernel: &Kernel, pixels: &[u8], held: &[u8], rows: Rows, shift: u32) {
        let level = Level::new();
        for y in (rows.first..rows.height).step_by(rows.each) {
            let row = y * rows.width..(y + 1) * rows.width;
            let model = (&mut self.mean_q7[row.clone()], &mut self.deviation_q9[row.clone()]);
            dispatch!(level, simd => kernel.adapt(simd, &pixels[row.clone()], &held[row.clone()], model.0, model.1, shift));
        }
    }
}

/// Every `each`-th row from row `first` on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) first: usize,
    pub(crate) each: usize,
}
