//! Closed outlines in a plane, counter-clockwise.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Corners `[u, v]`, metres.
pub type Outline = Vec<[f64; 2]>;

/// A circle about the origin.
pub fn circle(radius: f64, segments: usize) -> Outline {
    (0..segments).map(|i| polar([0.0, 0.0], radius, TAU * i as f64 / segments as f64)).collect()
}

/// A rectangle about the origin with rounded corners, `arc` edges each.
pub fn rounded_rectangle(width: f64, height: f64, radius: f64, arc: usize) -> Outline {
    let (u, v) = (width / 2.0 - radius, height / 2.0 - radius);
    let centers = [[u, v], [-u, v], [-u, -v], [u, -v]];
    let corner = |(i, center): (usize, [f64; 2])| {
        let start = FRAC_PI_2 * i as f64;
        (0..=arc).map(move |j| polar(center, radius, start + FRAC_PI_2 * j as f64 / arc as f64))
    };
    centers.into_iter().enumerate().flat_map(corner).collect()
}

/// The area inside a belt around two circles: `r0` at the origin and `r1` at `[0, length]`; its sides are drawn in by
/// `waist` half-way between.
pub fn tapered_slot(r0: f64, r1: f64, length: f64, waist: f64, arc: usize) -> Outline {
    const SIDE: usize = 8;
    let lean = ((r0 - r1) / length).asin();
    let arc_points = |center: [f64; 2], radius: f64, from: f64, to: f64| -> Outline {
        (0..=arc).map(|i| polar(center, radius, from + (to - from) * i as f64 / arc as f64)).collect()
    };
    let top = arc_points([0.0, length], r1, lean, PI - lean);
    let bottom = arc_points([0.0, 0.0], r0, PI - lean, TAU + lean);
    let side = |from: [f64; 2], to: [f64; 2]| -> Outline {
        let point = |i: usize| {
            let t = i as f64 / SIDE as f64;
            let u = from[0] + (to[0] - from[0]) * t;
            [u - waist * (PI * t).sin().powi(2) * u.signum(), from[1] + (to[1] - from[1]) * t]
        };
        (1..SIDE).map(point).collect()
    };
    let left = side(top[arc], bottom[0]);
    let right = side(bottom[arc], top[0]);
    [top, left, bottom, right].concat()
}

/// The outline moved inward by `distance`, corner by corner; it must be smooth compared with that distance.
pub fn inset(outline: &[[f64; 2]], distance: f64) -> Outline {
    let n = outline.len();
    (0..n).map(|i| inset_corner(outline[(i + n - 1) % n], outline[i], outline[(i + 1) % n], distance)).collect()
}

fn inset_corner(before: [f64; 2], here: [f64; 2], after: [f64; 2], distance: f64) -> [f64; 2] {
    let [a, b] = [inward(before, here), inward(here, after)];
    // The bisector, scaled for the mitre: |a + b|² / 2 = 1 + a·b.
    let scale = distance / (1.0 + a[0] * b[0] + a[1] * b[1]);
    [here[0] + (a[0] + b[0]) * scale, here[1] + (a[1] + b[1]) * scale]
}

/// The unit normal on the left of an edge: inside, for a counter-clockwise outline.
fn inward(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let [u, v] = [to[0] - from[0], to[1] - from[1]];
    let length = u.hypot(v);
    [-v / length, u / length]
}

fn polar(center: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()]
}
