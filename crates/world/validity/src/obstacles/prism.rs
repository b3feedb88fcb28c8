//! Upright convex prisms as a few boxes: for the shapes that a sensor sees, much faster than a cover of spheres.

use elbowroom_proximity::ConvexHull;
use elbowroom_spatial::{Pose, Rotation, Vec3};

/// Distance within which vertices are the same, m.
const SAME_M: f64 = 1e-9;
/// Largest number of sides of a prism; each side may need a box.
const MAX_SIDES: usize = 64;
/// Largest number of boxes.
const MAX_BOXES: usize = 64;

/// A box in the frame of the prism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlacedBox {
    pub half_extents: Vec3,
    pub in_prism: Pose,
}

/// Boxes whose union encloses a prism, and boxes inside it.
#[derive(Debug, Default)]
pub(super) struct PrismBoxes {
    pub outer: Vec<PlacedBox>,
    pub inner: Vec<PlacedBox>,
}

/// A convex polygon and its heights. Its longest side is along x of its frame; its corners are counter-clockwise.
struct Prism {
    corners: Vec<[f64; 2]>,
    heights: [f64; 2],
    /// Rotation of the polygon's frame about z.
    frame: Rotation,
}

impl PrismBoxes {
    /// The boxes of a hull that is a prism along its z; `None` for any other hull.
    ///
    /// The boxes protrude by `slack_m`, or more if there would be too many boxes.
    pub fn of(hull: &ConvexHull, slack_m: f64) -> Option<Self> {
        let prism = Prism::of(hull)?;
        let (cuts, _) = prism.cuts(slack_m);
        let mut boxes = Self::default();
        for x in cuts.windows(2).map(|pair| [pair[0], pair[1]]) {
            let [[low0, high0], [low1, high1]] = x.map(|x| prism.range(x));
            boxes.outer.push(prism.placed(x, [low0.min(low1), high0.max(high1)]));
            // The upper side of a convex polygon is above its chord, the lower side below.
            let within = [low0.max(low1), high0.min(high1)];
            if within[0] < within[1] {
                boxes.inner.push(prism.placed(x, within));
            }
        }
        Some(boxes)
    }
}

impl Prism {
    fn of(hull: &ConvexHull) -> Option<Self> {
        let vertices = hull.vertices();
        let heights = vertices.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v.z), h.max(v.z)]);
        let at = |z: f64| vertices.iter().filter(move |v| (v.z - z).abs() <= SAME_M);
        let [lower, upper]: [Vec<&Vec3>; 2] = heights.map(|z| at(z).collect());
        let is_same = |a: &Vec3, b: &Vec3| (a.x - b.x).hypot(a.y - b.y) <= SAME_M;
        let has_twin = |v: &&Vec3, of: &[&Vec3]| of.iter().any(|o| is_same(v, o));
        let is_prism = heights[1] - heights[0] > 2.0 * SAME_M
            && (3..=MAX_SIDES).contains(&lower.len())
            && lower.len() == upper.len()
            && lower.len() + upper.len() == vertices.len()
            && lower.iter().all(|v| has_twin(v, &upper))
            && upper.iter().all(|v| has_twin(v, &lower));
        if is_prism { Self::over(&lower, heights) } else { None }
    }

    /// Returns `None` if a vertex lies within a face; a hull may have such vertices.
    fn over(lower: &[&Vec3], heights: [f64; 2]) -> Option<Self> {
        let middle = lower.iter().fold(Vec3::ZERO, |sum, v| sum + **v) / lower.len() as f64;
        let mut corners: Vec<Vec3> = lower.iter().map(|v| **v).collect();
        corners.sort_by(|a, b| {
            let angle = |v: &Vec3| (v.y - middle.y).atan2(v.x - middle.x);
            angle(a).total_cmp(&angle(b))
        });
        let sides = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| *b - *a);
        let longest = sides.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(Vec3::X);
        let frame = Rotation::from_axis_angle(Vec3::Z, longest.y.atan2(longest.x));
        let back = frame.inverse();
        let turned = |v: &Vec3| {
            let v = back * *v;
            [v.x, v.y]
        };
        let corners: Vec<[f64; 2]> = corners.iter().map(turned).collect();
        let next = |by: usize| corners.iter().cycle().skip(by);
        let mut turns = corners.iter().zip(next(1)).zip(next(2));
        let is_left = |((a, b), c): ((&[f64; 2], &[f64; 2]), &[f64; 2])| {
            let [ab, bc] = [[b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]];
            ab[0] * bc[1] - ab[1] * bc[0] >= -SAME_M * (ab[0].hypot(ab[1]) + bc[0].hypot(bc[1]))
        };
        turns.all(is_left).then_some(Self { corners, heights, frame })
    }

    /// Values of x between which one box each encloses the polygon, and the protrusion of these boxes (m).
    ///
    /// The protrusion is the slack, or more if there would be too many boxes.
    fn cuts(&self, slack_m: f64) -> (Vec<f64>, f64) {
        let mut at: Vec<f64> = self.corners.iter().map(|c| c[0]).collect();
        at.sort_by(f64::total_cmp);
        at.dedup_by(|a, b| (*a - *b).abs() <= SAME_M);
        // A step beside a slope protrudes by less than its height, and by less than its width.
        let slope = |x: &[f64]| {
            let [[low0, high0], [low1, high1]] = [self.range(x[0]), self.range(x[1])];
            (low1 - low0).abs().max((high1 - high0).abs()).min(x[1] - x[0])
        };
        let slopes: Vec<f64> = at.windows(2).map(slope).collect();
        let count = |slope: f64, slack_m: f64| (slope / slack_m).ceil().max(1.0);
        let mut slack_m = slack_m;
        while slopes.iter().map(|s| count(*s, slack_m)).sum::<f64>() >= MAX_BOXES.max(at.len()) as f64 {
            slack_m *= 1.5;
        }
        let mut cuts = at[..1].to_vec();
        for (x, slope) in at.windows(2).zip(slopes) {
            let count = count(slope, slack_m) as usize;
            cuts.extend((1..count).map(|i| x[0] + (x[1] - x[0]) * i as f64 / count as f64));
            cuts.push(x[1]);
        }
        (cuts, slack_m)
    }

    /// Smallest and largest y of the polygon at x.
    fn range(&self, x: f64) -> [f64; 2] {
        let sides = self.corners.iter().zip(self.corners.iter().cycle().skip(1));
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for (a, b) in sides {
            let (left, right) = if a[0] <= b[0] { (a, b) } else { (b, a) };
            if x < left[0] - SAME_M || x > right[0] + SAME_M {
                continue;
            }
            let width = right[0] - left[0];
            let ys = if width <= 2.0 * SAME_M {
                [left[1], right[1]]
            } else {
                let share = ((x - left[0]) / width).clamp(0.0, 1.0);
                [left[1] + share * (right[1] - left[1]); 2]
            };
            for y in ys {
                range = [range[0].min(y), range[1].max(y)];
            }
        }
        range
    }

    fn placed(&self, x: [f64; 2], y: [f64; 2]) -> PlacedBox {
        let [low, high] = [0, 1].map(|i| Vec3::new(x[i], y[i], self.heights[i]));
        PlacedBox {
            half_extents: (high - low) * 0.5,
            in_prism: Pose::new(self.frame, self.frame * ((low + high) * 0.5)),
        }
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_proximity::ConvexHull;
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    fn prism(corners: &[[f64; 2]], heights: [f64; 2]) -> ConvexHull {
        let points: Vec<Vec3> =
            heights.iter().flat_map(|z| corners.iter().map(|c| Vec3::new(c[0], c[1], *z))).collect();
        ConvexHull::from_points(&points).unwrap()
    }

    fn protrusion(b: &PlacedBox, p: Vec3) -> f64 {
        let local = b.in_prism.inverse().transform_point(p).abs() - b.half_extents;
        local.max_element()
    }

    /// Random convex polygons, including rotated rectangles: every point of the prism is in an outer box, every point of
    /// an inner box is in the prism, and no outer box protrudes by more than the slack.
    #[test]
    fn boxes_enclose_a_prism_closely() {
        let (mut random, slack_m) = (SplitMix(7), 0.005);
        for round in 0..300 {
            let [at_x, at_y] = [random.between(-3.0, 3.0), random.between(-3.0, 3.0)];
            let turn = random.between(0.0, 6.3);
            let corner =
                |x: f64, y: f64| [at_x + x * turn.cos() - y * turn.sin(), at_y + x * turn.sin() + y * turn.cos()];
            let (a, b) = (random.between(0.02, 1.0), random.between(0.02, 1.0));
            let corners: Vec<[f64; 2]> = match round % 3 {
                0 => [(a, b), (-a, b), (-a, -b), (a, -b)].map(|(x, y)| corner(x, y)).to_vec(),
                1 => {
                    let c = 0.3 * a.min(b);
                    let eight = [
                        (a, b - c),
                        (a - c, b),
                        (c - a, b),
                        (-a, b - c),
                        (-a, c - b),
                        (c - a, -b),
                        (a - c, -b),
                        (a, c - b),
                    ];
                    eight.map(|(x, y)| corner(x, y)).to_vec()
                }
                _ => {
                    let sides = 3 + random.index(9);
                    let angles = (0..sides)
                        .map(|i| std::f64::consts::TAU * (i as f64 + 0.7 * random.between(0.0, 1.0)) / sides as f64);
                    angles.collect::<Vec<f64>>().into_iter().map(|t| corner(a * t.cos(), b * t.sin())).collect()
                }
            };
            let heights = [random.between(-1.0, 0.0), random.between(0.1, 2.0)];
            let hull = prism(&corners, heights);
            let boxes = PrismBoxes::of(&hull, slack_m).expect("a prism");
            assert!(!boxes.inner.is_empty() && boxes.outer.len() < MAX_BOXES);
            let (_, protrudes_m) = Prism::of(&hull).unwrap().cuts(slack_m);
            assert!(protrudes_m < 0.1, "{protrudes_m}");
            for _ in 0..200 {
                // A point of the prism: a weighted mean of its vertices.
                let weights: Vec<f64> = hull.vertices().iter().map(|_| random.between(0.0, 1.0).powi(6)).collect();
                let total: f64 = weights.iter().sum();
                let inside = hull.vertices().iter().zip(&weights).fold(Vec3::ZERO, |p, (v, w)| p + *v * (w / total));
                assert!(boxes.outer.iter().any(|b| protrusion(b, inside) <= 1e-8), "{corners:?} {inside:?}");
            }
            for (boxes, most_m) in [(&boxes.outer, protrudes_m + 1e-8), (&boxes.inner, 1e-8)] {
                for b in boxes {
                    for k in 0..8 {
                        let sign = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
                        let h = b.half_extents;
                        let local = Vec3::new(sign(0) * h.x, sign(1) * h.y, sign(2) * h.z);
                        let p = b.in_prism.transform_point(local);
                        let beyond = beyond(&hull, p);
                        assert!(beyond <= most_m, "{beyond} m, round {round}: {corners:?}");
                    }
                }
            }
        }
    }

    /// Distance of a point beyond the faces of a hull, m.
    fn beyond(hull: &ConvexHull, p: Vec3) -> f64 {
        let v = hull.vertices();
        let beyond = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| v[i as usize]);
            let normal = (b - a).cross(c - a);
            normal.dot(p - a) / normal.length()
        };
        hull.triangles().iter().map(beyond).fold(f64::NEG_INFINITY, f64::max)
    }

    /// A corner in the middle of each cap would hide a wedge.
    #[test]
    fn a_prism_with_corners_in_its_caps_is_none() {
        let ring: Vec<[f64; 2]> =
            (0..6).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_3).map(|t| [t.cos(), t.sin()]).collect();
        let with = |middle: [f64; 2]| -> Vec<Vec3> {
            let corners: Vec<[f64; 2]> = ring.iter().copied().chain([middle]).collect();
            [0.0, 1.0]
                .iter()
                .flat_map(|z| corners.iter().map(|c| Vec3::new(c[0], c[1], *z)).collect::<Vec<_>>())
                .collect()
        };
        let vertices = with([0.01, -0.02]);
        let mut faces = Vec::new();
        for i in 0..6_u32 {
            let j = (i + 1) % 6;
            faces.extend([[6, j, i], [13, 7 + i, 7 + j], [i, j, 7 + j], [i, 7 + j, 7 + i]]);
        }
        let hull = ConvexHull::from_faces(vertices, faces).unwrap();
        assert!(PrismBoxes::of(&hull, 0.005).is_none());
        // A size that only results from a wrong unit: few boxes, and no memory for more.
        let huge = prism(&[[0.0, 0.0], [1e7, 0.0], [3e6, 2e6]], [0.0, 1.0]);
        assert!(PrismBoxes::of(&huge, 0.005).unwrap().outer.len() <= MAX_BOXES);
    }

    #[test]
    fn other_hulls_are_no_prisms() {
        let tip = [Vec3::X, Vec3::Y, -Vec3::X - Vec3::Y, Vec3::Z];
        assert!(PrismBoxes::of(&ConvexHull::from_points(&tip).unwrap(), 0.005).is_none());
        let frustum = [(1.0, 0.0), (0.5, 1.0)]
            .into_iter()
            .flat_map(|(s, z)| [(s, s), (-s, s), (-s, -s), (s, -s)].map(|(x, y)| Vec3::new(x, y, z)))
            .collect::<Vec<_>>();
        assert!(PrismBoxes::of(&ConvexHull::from_points(&frustum).unwrap(), 0.005).is_none());
    }
}
