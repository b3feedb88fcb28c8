//! Convex polygons in a plane: lists of corners, counter-clockwise if y is to the left of x.
//!
//! The functions write to lists of the caller, so that nothing is allocated once these lists have grown.

use crate::Point2;

/// Sum of cross products, m² or pixels², below which a polygon has no area: the inverse would be infinite.
const MIN_CENTROID_WEIGHT: f64 = 1e-300;
/// Sine of the angle between edges below which they are parallel: their extensions do not meet.
const PARALLEL_SINE: f64 = 1e-9;

/// Corners of the regular octagon around the unit circle, which [`inflate`] adds to each corner.
const OCTAGON: [Point2; 8] = {
    // 1 / cos(π/8) times cosine and sine of odd multiples of 22.5°: edges touch the circle on the axes.
    const T: f64 = 0.414_213_562_373_095_1; // tan(π/8)
    const O: f64 = 1.0;
    [
        Point2::new(O, T),
        Point2::new(T, O),
        Point2::new(-T, O),
        Point2::new(-O, T),
        Point2::new(-O, -T),
        Point2::new(-T, -O),
        Point2::new(T, -O),
        Point2::new(O, -T),
    ]
};

/// Computes the convex hull of `points`, which are reordered, into `hull` (Andrew's monotone chain). Points that are
/// not finite are ignored.
///
/// ```
/// use elbowroom_vision::{Point2, polygon};
/// let mut points = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Point2::new(x, y)).to_vec();
/// let mut hull = Vec::new();
/// polygon::convex_hull(&mut points, &mut hull);
/// assert_eq!((hull.len(), polygon::area(&hull)), (4, 4.0));
/// ```
pub fn convex_hull(points: &mut Vec<Point2>, hull: &mut Vec<Point2>) {
    hull.clear();
    points.retain(|p| p.is_finite());
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        hull.extend_from_slice(points);
        return;
    }
    for &p in points.iter() {
        push_left_turn(hull, 0, p);
    }
    let lower = hull.len() - 1;
    for &p in points.iter().rev().skip(1) {
        push_left_turn(hull, lower, p);
    }
    hull.pop();
}

fn push_left_turn(hull: &mut Vec<Point2>, base: usize, p: Point2) {
    while hull.len() >= base + 2 {
        let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
        if (b - a).cross(p - b) > 0.0 {
            break;
        }
        hull.pop();
    }
    hull.push(p);
}

/// Area of a polygon; negative if it runs clockwise.
pub fn area(polygon: &[Point2]) -> f64 {
    let Some(&o) = polygon.first() else { return 0.0 };
    polygon.windows(2).map(|w| (w[0] - o).cross(w[1] - o)).sum::<f64>() / 2.0
}

/// The centroid of a polygon's area; the mean of the corners if the polygon has no area.
pub fn centroid(polygon: &[Point2]) -> Point2 {
    let Some(&o) = polygon.first() else { return Point2::default() };
    let (mut sum, mut weight) = (Point2::default(), 0.0);
    for w in polygon.windows(2) {
        let (a, b) = (w[0] - o, w[1] - o);
        let cross = a.cross(b);
        sum = sum + (a + b) * cross;
        weight += cross;
    }
    if weight.abs() > MIN_CENTROID_WEIGHT {
        return o + sum * (1.0 / (3.0 * weight));
    }
    polygon.iter().fold(Point2::default(), |s, &p| s + p) * (1.0 / polygon.len() as f64)
}

/// Whether `p` is inside or on the border of a convex polygon.
pub fn convex_contains(polygon: &[Point2], p: Point2) -> bool {
    polygon.len() > 2 && edges(polygon).all(|(a, b)| (b - a).cross(p - a) >= 0.0)
}

/// Whether `p` is inside a simple polygon, convex or not, of either orientation (crossing number).
pub fn contains(polygon: &[Point2], p: Point2) -> bool {
    let crosses =
        |(a, b): &(Point2, Point2)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    edges(polygon).filter(crosses).count() % 2 == 1
}

/// Whether a convex polygon and a simple one have a point in common.
pub fn touches(convex: &[Point2], simple: &[Point2]) -> bool {
    convex.iter().any(|&p| contains(simple, p))
        || simple.iter().any(|&p| convex_contains(convex, p))
        || edges(convex).any(|e| edges(simple).any(|f| segments_intersect(e, f)))
}

/// Whether two line segments have a point in common, their ends included.
pub fn segments_intersect((a, b): (Point2, Point2), (c, d): (Point2, Point2)) -> bool {
    let side = |p: Point2, q: Point2, r: Point2| (q - p).cross(r - p);
    // Of segments on one line all sides are 0, and their extents decide.
    let overlap = |of: fn(&Point2) -> f64| {
        let (a, b, c, d) = (of(&a), of(&b), of(&c), of(&d));
        a.min(b) <= c.max(d) && c.min(d) <= a.max(b)
    };
    overlap(|p| p.x) && overlap(|p| p.y) && side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

/// The edges of a polygon, from corner to corner and back to the first.
pub fn edges(polygon: &[Point2]) -> impl Iterator<Item = (Point2, Point2)> + '_ {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

/// Clips a convex polygon to the half-plane `normal · p <= offset` (Sutherland and Hodgman).
pub fn clip(polygon: &[Point2], normal: Point2, offset: f64, out: &mut Vec<Point2>) {
    out.clear();
    for (a, b) in edges(polygon) {
        let (at_a, at_b) = (normal.dot(a) - offset, normal.dot(b) - offset);
        if at_a <= 0.0 {
            out.push(a);
        }
        if (at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0) {
            out.push(a + (b - a) * (at_a / (at_a - at_b)));
        }
    }
}

/// The intersection of two convex polygons; `workspace` is scratch memory.
pub fn intersection(a: &[Point2], b: &[Point2], out: &mut Vec<Point2>, workspace: &mut Vec<Point2>) {
    out.clear();
    if a.len() < 3 || b.len() < 3 {
        return;
    }
    out.extend_from_slice(a);
    for (from, to) in edges(b) {
        let along = to - from;
        let outward = Point2::new(along.y, -along.x);
        std::mem::swap(out, workspace);
        clip(workspace, outward, outward.dot(from), out);
        if out.is_empty() {
            return;
        }
    }
}

/// Inflates a convex polygon: the result contains every point within `margin` of it, and little more (8 % of the margin
/// at the corners). `workspace` is scratch memory.
///
/// ```
/// use elbowroom_vision::{Point2, polygon};
/// let (mut inflated, mut workspace) = (Vec::new(), Vec::new());
/// polygon::inflate(&[Point2::new(1.0, 1.0)], 0.5, &mut inflated, &mut workspace);
/// assert_eq!(inflated.len(), 8);
/// assert!(polygon::convex_contains(&inflated, Point2::new(1.35, 1.35)));
/// ```
pub fn inflate(polygon: &[Point2], margin: f64, out: &mut Vec<Point2>, workspace: &mut Vec<Point2>) {
    workspace.clear();
    workspace.extend(polygon.iter().flat_map(|&p| OCTAGON.iter().map(move |&o| p + o * margin)));
    convex_hull(workspace, out);
}

/// Replaces edges by the extensions of their neighbours until at most `max_corners` corners are left, each time the
/// edge that adds the smallest area. The result contains the original polygon and has at least four corners.
pub fn simplify_outward(polygon: &mut Vec<Point2>, max_corners: usize) {
    while polygon.len() > max_corners.max(4) {
        let Some((edge, corner)) = edge_to_remove(polygon) else { return };
        let next = (edge + 1) % polygon.len();
        polygon[edge] = corner;
        polygon.remove(next);
    }
}

/// The edge whose removal adds the smallest area, and the corner that replaces it.
fn edge_to_remove(polygon: &[Point2]) -> Option<(usize, Point2)> {
    let n = polygon.len();
    let mut best: Option<(f64, usize, Point2)> = None;
    for i in 0..n {
        let [p, a, b, q] = [polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]];
        let (before, after) = (a - p, q - b);
        let turn = before.cross(after);
        // Extensions that meet behind the edge, or too far away for a defined intersection, cannot replace it.
        if turn <= PARALLEL_SINE * before.length() * after.length() {
            continue;
        }
        let corner = a + before * ((b - a).cross(after) / turn);
        let added = (b - a).cross(corner - a).abs();
        if corner.is_finite() && best.is_none_or(|(least, ..)| added < least) {
            best = Some((added, i, corner));
        }
    }
    best.map(|(_, i, corner)| (i, corner))
}

/// Lengths of the sides of the smallest-area rectangle around a convex polygon, longer side first.
///
/// One such rectangle has a side along an edge of the polygon (Freeman and Shapira, 1975).
pub fn min_area_rectangle(polygon: &[Point2]) -> (f64, f64) {
    let mut best = (f64::INFINITY, (0.0, 0.0));
    for (a, b) in edges(polygon) {
        let length = (b - a).length();
        if length > 0.0 {
            let along = (b - a) * (1.0 / length);
            let (w, h) = (extent(polygon, along), extent(polygon, Point2::new(-along.y, along.x)));
            if w * h < best.0 {
                best = (w * h, (w.max(h), w.min(h)));
            }
        }
    }
    best.1
}

fn extent(polygon: &[Point2], along: Point2) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in polygon {
        let s = along.dot(*p);
        (low, high) = (low.min(s), high.max(s));
    }
    high - low
}
