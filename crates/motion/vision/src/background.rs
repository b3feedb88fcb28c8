//! The background model: running mean and running mean absolute deviation of each pixel, in 16-bit fixed point.
//!
//! Grey levels have 7 fractional bits in means (`_q7`), 4 in differences (`_q4`), 9 in deviations (`_q9`). Rows are
//! processed by plain loops over slices of equal length, which the compiler vectorizes for the widest instructions of
//! the processor ([`dispatch!`]). The model stays in the illumination in which it was learnt. [`Illumination`] maps it
//! to the illumination of the present frame, and slow adaptation follows local changes.

#![expect(clippy::inline_always, reason = "code that is not inlined is not compiled for the wider instructions")]

use fearless_simd::{Level, Simd, dispatch};

use crate::illumination::Illumination;

/// Largest deviation, 12 grey levels. A pixel that flickers more is foreground in some frames, which is safe; with a
/// larger threshold it would detect nothing.
const MAX_DEVIATION_Q4: i16 = 12 << 4;
/// The largest expected value, 255 grey levels.
const WHITE_Q4: i16 = 255 << 4;
const WHITE_Q7: i16 = 255 << 7;

/// Thresholds for the difference of a pixel from the background.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Thresholds {
    /// Smallest difference, grey levels.
    pub(crate) min_difference: f64,
    /// Smallest difference as a multiple of the pixel's mean deviation.
    pub(crate) deviation_factor: f64,
    /// Range of the brightness in shadow relative to the background; empty if shadows are foreground.
    pub(crate) shadow_range: (f64, f64),
}

/// One plane of the model: grey, or one of three colours.
#[derive(Debug, Clone, Default)]
pub(crate) struct BackgroundPlane {
    mean_q7: Vec<i16>,
    deviation_q9: Vec<i16>,
}

/// [`Thresholds`] and [`Illumination`] in fixed point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelClassifier {
    gain_q13: i16,
    offset_q4: i16,
    min_difference_q4: i16,
    deviation_factor_q11: i16,
    shadow_from_q14: i16,
    shadow_to_q14: i16,
}

/// Classes besides 0 (background): possibly shadow, and certainly not shadow.
pub(crate) const SHADOW: u8 = 1;
pub(crate) const FOREGROUND: u8 = 3;

#[inline(always)]
fn high_product(a: i16, b: i16) -> i16 {
    ((i32::from(a) * i32::from(b)) >> 16) as i16
}

impl PixelClassifier {
    pub(crate) fn new(illumination: &Illumination, thresholds: &Thresholds) -> Self {
        let fixed = |x: f64, bits: i32| (x * f64::from(1 << bits)).round().clamp(-32_767.0, 32_767.0) as i16;
        Self {
            gain_q13: fixed(illumination.gain, 13),
            offset_q4: fixed(illumination.offset, 4),
            min_difference_q4: fixed(thresholds.min_difference, 4),
            deviation_factor_q11: fixed(thresholds.deviation_factor, 11),
            shadow_from_q14: fixed(thresholds.shadow_range.0, 14),
            shadow_to_q14: fixed(thresholds.shadow_range.1, 14),
        }
    }

    #[inline(always)]
    fn expected_q4(&self, mean_q7: i16) -> i16 {
        high_product(mean_q7, self.gain_q13).saturating_add(self.offset_q4).clamp(0, WHITE_Q4)
    }

    #[inline(always)]
    fn threshold_q4(&self, deviation_q9: i16) -> i16 {
        high_product(deviation_q9, self.deviation_factor_q11).max(self.min_difference_q4)
    }

    /// Combines the class of each pixel of a row with `class` (by `|`, so that planes accumulate).
    #[expect(clippy::needless_bitwise_bool, reason = "branches would prevent vectorization")]
    #[inline(always)]
    fn classify<S: Simd>(&self, _widest: S, row: &[u8], mean_q7: &[i16], deviation_q9: &[i16], class: &mut [u8]) {
        let n = class.len();
        let (row, mean_q7, deviation_q9) = (&row[..n], &mean_q7[..n], &deviation_q9[..n]);
        for i in 0..n {
            let expected = self.expected_q4(mean_q7[i]);
            let observed = i16::from(row[i]) << 4;
            let difference = observed - expected;
            let differs = difference.max(-difference) > self.threshold_q4(deviation_q9[i]);
            let from = high_product(expected << 2, self.shadow_from_q14);
            let to = high_product(expected << 2, self.shadow_to_q14);
            let is_shadow = (observed >= from) & (observed <= to);
            class[i] |= u8::from(differs) | (u8::from(differs & !is_shadow) << 1);
        }
    }

    /// Adapts a row of the model to the image, except in `frozen` pixels and in pixels that differ from the model: a
    /// permanent shadow must not raise the deviation of the floor under it.
    #[inline(always)]
    fn adapt<S: Simd>(
        &self,
        _widest: S,
        row: &[u8],
        frozen: &[u8],
        mean_q7: &mut [i16],
        deviation_q9: &mut [i16],
        shift: u32,
    ) {
        let n = row.len();
        let (frozen, mean_q7, deviation_q9) = (&frozen[..n], &mut mean_q7[..n], &mut deviation_q9[..n]);
        let half = (1_i16 << shift) >> 1;
        for i in 0..n {
            let difference = (i16::from(row[i]) << 4) - self.expected_q4(mean_q7[i]);
            let size = difference.max(-difference);
            let may_adapt = -i16::from(frozen[i] == 0);
            let is_floor = -i16::from(size <= self.threshold_q4(deviation_q9[i]));
            let step = (difference << 3).saturating_add(half) >> shift;
            mean_q7[i] = (mean_q7[i].saturating_add(step & may_adapt & is_floor)).clamp(0, WHITE_Q7);
            let towards = (size.min(MAX_DEVIATION_Q4) << 5) - deviation_q9[i];
            deviation_q9[i] += (towards.saturating_add(half) >> shift) & may_adapt & is_floor;
        }
    }
}

impl BackgroundPlane {
    pub(crate) fn reset(&mut self, pixels: usize) {
        self.mean_q7.clear();
        self.mean_q7.resize(pixels, 0);
        self.deviation_q9.clear();
        self.deviation_q9.resize(pixels, 0);
    }

    /// The mean grey level of pixel `i` in the illumination in which the model was learnt.
    pub(crate) fn mean(&self, i: usize) -> f32 {
        f32::from(self.mean_q7[i]) / 128.0
    }

    /// The mean deviation of pixel `i` from its mean, grey levels.
    pub(crate) fn deviation(&self, i: usize) -> f32 {
        f32::from(self.deviation_q9[i]) / 512.0
    }

    /// Learns from an image of the empty cell; all images of a pixel have the same weight. `nth` is the number of
    /// images per pixel, including this one; pixels in `masked` are skipped.
    pub(crate) fn learn(&mut self, pixels: &[u8], nth: &[u16], masked: &[u8]) {
        let models = self.mean_q7.iter_mut().zip(&mut self.deviation_q9);
        let inputs = pixels.iter().zip(nth).zip(masked);
        for (((&observed, &nth), &masked), (mean, deviation)) in inputs.zip(models) {
            if masked != 0 {
                continue;
            }
            let weight_q16 = 65_536 / i32::from(nth.max(1));
            let difference = (i32::from(observed) << 7) - i32::from(*mean);
            *mean += ((difference * weight_q16 + 32_768) >> 16) as i16;
            if nth > 1 {
                let size_q9 = (difference.abs() << 2).min(i32::from(MAX_DEVIATION_Q4) << 5);
                *deviation += (((size_q9 - i32::from(*deviation)) * weight_q16 + 32_768) >> 16) as i16;
            }
        }
    }

    /// Combines the class of each pixel with `class`.
    pub(crate) fn classify(&self, classifier: &PixelClassifier, pixels: &[u8], class: &mut [u8]) {
        dispatch!(Level::new(), simd => classifier.classify(simd, pixels, &self.mean_q7, &self.deviation_q9, class));
    }

    /// Adapts a subset of the rows by 1 / 2^`shift` of the difference.
    pub(crate) fn adapt(
        &mut self,
        classifier: &PixelClassifier,
        pixels: &[u8],
        frozen: &[u8],
        rows: RowSubset,
        shift: u32,
    ) {
        let level = Level::new();
        for y in (rows.first..rows.height).step_by(rows.stride) {
            let row = y * rows.width..(y + 1) * rows.width;
            let model = (&mut self.mean_q7[row.clone()], &mut self.deviation_q9[row.clone()]);
            dispatch!(level, simd => classifier.adapt(simd, &pixels[row.clone()], &frozen[row.clone()], model.0, model.1, shift));
        }
    }
}

/// Iterates over every `stride`-th row, beginning with row `first`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RowSubset {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) first: usize,
    pub(crate) stride: usize,
}
