//! Shadow or thing? A shadow dims the floor evenly: the floor's own pattern stays, dimmed by one ratio.
//!
//! The ratio alone would take every grey thing for a shadow. Around each pixel in question nine samples are compared
//! with the background times their common ratio, in each plane: where they do not follow the pattern, or where the
//! planes' ratios differ (a shadow has no colour), it is a thing.

use crate::Shadows;
use crate::background::{OBJECT, Plane, SHADOW};
use crate::light::Light;

/// Samples around a pixel: a cross.
const CROSS: [(isize, isize); 9] = [(0, 0), (-2, 0), (2, 0), (-4, 0), (4, 0), (0, -2), (0, 2), (0, -4), (0, 4)];

/// What a picture, its background and its light are, plane by plane.
pub(crate) struct Scene<'a> {
    pub(crate) pixels: &'a [u8],
    pub(crate) planes: &'a [Plane],
    pub(crate) lights: &'a [Light],
    pub(crate) width: usize,
    pub(crate) height: usize,
}

/// Turns classes into 1 (thing) and 0 (floor, dimmed or not). `foreground` has as many pixels as `class`.
pub(crate) fn resolve(scene: &Scene<'_>, class: &[u8], shadows: Option<&Shadows>, foreground: &mut [u8]) {
    for (out, &class) in foreground.iter_mut().zip(class) {
        *out = class >> 1;
    }
    let Some(shadows) = shadows else { return };
    for (y, row) in class.chunks_exact(scene.width).enumerate() {
        for_each_candidate(row, |x| {
            let i = y * scene.width + x;
            foreground[i] = u8::from(!is_shadow(scene, class, shadows, x, y));
        });
    }
}

/// Calls with the place of each [`SHADOW`]; eight empty pixels cost one comparison.
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

fn is_shadow(scene: &Scene<'_>, class: &[u8], shadows: &Shadows, x: usize, y: usize) -> bool {
    debug_assert_ne!(class[y * scene.width + x], OBJECT);
    let mut places = [0; CROSS.len()];
    let mut n = 0;
    for (dx, dy) in CROSS {
        let (Some(x), Some(y)) = (x.checked_add_signed(dx), y.checked_add_signed(dy)) else { continue };
        if x < scene.width && y < scene.height && class[y * scene.width + x] == SHADOW {
            places[n] = y * scene.width + x;
            n += 1;
        }
    }
    let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
    for p in 0..scene.planes.len() {
        let Some(ratio) = even_ratio(scene, p, &places[..n], shadows.texture as f32) else { return false };
        (least, most) = (least.min(ratio), most.max(ratio));
    }
    most - least <= shadows.tint as f32
}

/// The ratio of what is seen at the places to the background; `None` where the background's pattern is not followed.
fn even_ratio(scene: &Scene<'_>, plane: usize, places: &[usize], texture: f32) -> Option<f32> {
    let pixels = &scene.pixels[plane * scene.width * scene.height..];
    let (gain, offset) = (scene.lights[plane].gain as f32, scene.lights[plane].offset as f32);
    let mut pairs = [(0.0_f32, 0.0_f32); CROSS.len()];
    let (mut seen, mut expected) = (0.0, 0.0);
    for (pair, &i) in pairs.iter_mut().zip(places) {
        *pair = (f32::from(pixels[i]), gain * scene.planes[plane].mean(i) + offset);
        seen += pair.0;
        expected += pair.1;
    }
    let ratio = seen / expected.max(1.0);
    let pairs = &pairs[..places.len()];
    let misses: f32 = pairs.iter().map(|(f, e)| (f - ratio * e).abs()).sum();
    (misses <= texture * places.len() as f32).then_some(ratio)
}
