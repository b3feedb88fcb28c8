//! Shadow detection: a shadow dims the floor by a common ratio and keeps its texture and colour.
//!
//! The ratio alone would accept every grey object. Therefore nine samples around each candidate pixel are compared, in
//! each plane, with the background times their common ratio. If they do not follow the texture, or if the ratios of the
//! planes differ, the pixel is foreground.

use crate::ShadowSettings;
use crate::background::{BackgroundPlane, SHADOW};
use crate::illumination::Illumination;

/// Samples around a pixel: a cross.
const CROSS: [(isize, isize); 9] = [(0, 0), (-2, 0), (2, 0), (-4, 0), (4, 0), (0, -2), (0, 2), (0, -4), (0, 4)];

/// An image, its background model and its illumination, plane by plane.
pub(crate) struct ShadowInput<'a> {
    pub(crate) pixels: &'a [u8],
    pub(crate) planes: &'a [BackgroundPlane],
    pub(crate) illumination: &'a [Illumination],
    pub(crate) width: usize,
    pub(crate) height: usize,
}

/// Converts classes to 1 (foreground) and 0 (floor, in shadow or not). `foreground` has as many pixels as `class`.
pub(crate) fn resolve(input: &ShadowInput<'_>, class: &[u8], settings: Option<&ShadowSettings>, foreground: &mut [u8]) {
    for (out, &class) in foreground.iter_mut().zip(class) {
        *out = class >> 1;
    }
    let Some(settings) = settings else { return };
    for (y, row) in class.chunks_exact(input.width).enumerate() {
        for_each_candidate(row, |x| {
            let i = y * input.width + x;
            foreground[i] = u8::from(!is_shadow(input, class, settings, x, y));
        });
    }
}

/// Calls `found` with the column of each [`SHADOW`] pixel; eight background pixels cost one comparison.
fn for_each_candidate(row: &[u8], mut found: impl FnMut(usize)) {
    let (chunks, rest) = row.as_chunks::<8>();
    for (c, chunk) in chunks.iter().enumerate() {
        if u64::from_ne_bytes(*chunk) != 0 {
            chunk.iter().enumerate().filter(|(_, class)| **class == SHADOW).for_each(|(i, _)| found(8 * c + i));
        }
    }
    let from = row.len() - rest.len();
    rest.iter().enumerate().filter(|(_, class)| **class == SHADOW).for_each(|(i, _)| found(from + i));
}

fn is_shadow(input: &ShadowInput<'_>, class: &[u8], settings: &ShadowSettings, x: usize, y: usize) -> bool {
    let mut samples = [0; CROSS.len()];
    let mut n = 0;
    for (dx, dy) in CROSS {
        let (Some(x), Some(y)) = (x.checked_add_signed(dx), y.checked_add_signed(dy)) else { continue };
        if x < input.width && y < input.height && class[y * input.width + x] == SHADOW {
            samples[n] = y * input.width + x;
            n += 1;
        }
    }
    let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
    for p in 0..input.planes.len() {
        let max_error = settings.max_texture_error as f32;
        let Some(ratio) = common_ratio(input, p, &samples[..n], max_error) else { return false };
        (least, most) = (least.min(ratio), most.max(ratio));
    }
    most - least <= settings.max_tint as f32
}

/// The ratio of the image to the background at the samples; `None` if the texture differs.
fn common_ratio(input: &ShadowInput<'_>, plane: usize, samples: &[usize], max_error: f32) -> Option<f32> {
    let pixels = &input.pixels[plane * input.width * input.height..];
    let (gain, offset) = (input.illumination[plane].gain as f32, input.illumination[plane].offset as f32);
    let mut pairs = [(0.0_f32, 0.0_f32); CROSS.len()];
    let (mut observed, mut expected) = (0.0, 0.0);
    for (pair, &i) in pairs.iter_mut().zip(samples) {
        *pair = (f32::from(pixels[i]), gain * input.planes[plane].mean(i) + offset);
        observed += pair.0;
        expected += pair.1;
    }
    let ratio = observed / expected.max(1.0);
    let pairs = &pairs[..samples.len()];
    let error: f32 = pairs.iter().map(|(f, e)| (f - ratio * e).abs()).sum();
    (error <= max_error * samples.len() as f32).then_some(ratio)
}
