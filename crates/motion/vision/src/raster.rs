//! Rasterization of convex polygons.

use crate::Point2;

/// Writes `value` into every pixel of the plane that the convex polygon touches.
pub(crate) fn fill_convex(plane: &mut [u8], width: usize, polygon_px: &[Point2], value: u8) {
    for_each_row(plane.len(), width, polygon_px, |range| plane[range].fill(value));
}

/// Whether any pixel that the convex polygon touches is not 0.
pub(crate) fn any_in_convex(plane: &[u8], width: usize, polygon_px: &[Point2]) -> bool {
    let mut any = false;
    for_each_row(plane.len(), width, polygon_px, |range| any |= plane[range].iter().any(|&pixel| pixel != 0));
    any
}

/// Calls `visit` with the pixels of each row that the polygon touches, as indices in a plane of `pixels` pixels.
fn for_each_row(pixels: usize, width: usize, polygon_px: &[Point2], mut visit: impl FnMut(std::ops::Range<usize>)) {
    if width == 0 || polygon_px.iter().any(|p| !p.is_finite()) {
        return;
    }
    let low = polygon_px.iter().fold(f64::INFINITY, |s, p| s.min(p.y));
    let high = polygon_px.iter().fold(f64::NEG_INFINITY, |s, p| s.max(p.y));
    let first = low.floor().max(0.0) as usize;
    let end = (high.ceil().max(0.0) as usize).min(pixels / width);
    for y in first..end {
        let (left, right) = extent(polygon_px, y as f64, y as f64 + 1.0);
        let begin = left.floor().max(0.0) as usize;
        let stop = (right.ceil().max(0.0) as usize).min(width);
        if begin < stop {
            visit(y * width + begin..y * width + stop);
        }
    }
}

/// Smallest and largest x of a convex polygon between two values of y.
fn extent(polygon_px: &[Point2], from: f64, to: f64) -> (f64, f64) {
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut take = |x: f64| (left, right) = (left.min(x), right.max(x));
    for (a, b) in crate::polygon::edges(polygon_px) {
        let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
        if high.y < from || low.y > to {
            continue;
        }
        let at = |y: f64| {
            let t = if high.y > low.y { ((y - low.y) / (high.y - low.y)).clamp(0.0, 1.0) } else { 0.0 };
            low.x + t * (high.x - low.x)
        };
        take(at(from.max(low.y)));
        take(at(to.min(high.y)));
        if low.y == high.y {
            take(high.x);
        }
    }
    (left, right)
}
