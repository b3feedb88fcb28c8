//! Boxes around an upright prism, which maps on covers use without further covers.

use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_vision::Point2;

/// Largest excess, as a fraction, of the area of a rectangle around the footprint for which the rectangle is used.
const LARGER_SHARE: f64 = 0.1;
/// Number of slabs of a footprint that is not a rectangle.
const SLABS: usize = 4;
/// Enlargement of boxes for rounding, m.
const ROUNDING_M: f64 = 1e-9;

/// Boxes that together contain a prism over a convex footprint (world x and y, m). Empty if the footprint has no area.
pub(super) fn prism_boxes(footprint_m: &[Point2], heights_m: [f64; 2]) -> Vec<(Shape, Pose)> {
    let Some(along) = rectangle_direction(footprint_m) else { return Vec::new() };
    let whole = Extent::of(footprint_m, along);
    let area = elbowroom_vision::polygon::area(footprint_m);
    let slabs = if whole.area() <= (1.0 + LARGER_SHARE) * area { 1 } else { SLABS };
    let border = |i: usize| whole.along[0] + (whole.along[1] - whole.along[0]) * i as f64 / slabs as f64;
    (0..slabs)
        .filter_map(|i| Extent::of_slab(footprint_m, along, [border(i), border(i + 1)]))
        .map(|e| e.cuboid(along, heights_m))
        .collect()
}

/// The direction of the side along which the rectangle around a polygon is smallest.
fn rectangle_direction(polygon: &[Point2]) -> Option<Point2> {
    let sides = (0..polygon.len()).map(|i| polygon[(i + 1) % polygon.len()] - polygon[i]);
    let directions = sides.filter(|side| side.length() > 0.0).map(|side| side * (1.0 / side.length()));
    let found = directions.min_by(|a, b| Extent::of(polygon, *a).area().total_cmp(&Extent::of(polygon, *b).area()))?;
    (Extent::of(polygon, found).area() > 0.0).then_some(found)
}

fn across(along: Point2) -> Point2 {
    Point2::new(-along.y, along.x)
}

/// The rectangle around points, along a direction and across it.
#[derive(Debug, Clone, Copy)]
struct Extent {
    along: [f64; 2],
    across: [f64; 2],
}

impl Extent {
    const EMPTY: Self = Self { along: [f64::INFINITY, f64::NEG_INFINITY], across: [f64::INFINITY, f64::NEG_INFINITY] };

    fn add(&mut self, p: Point2, direction: Point2) {
        for (range, value) in [(&mut self.along, direction.dot(p)), (&mut self.across, across(direction).dot(p))] {
            *range = [range[0].min(value), range[1].max(value)];
        }
    }

    fn of(points: &[Point2], direction: Point2) -> Self {
        points.iter().fold(Self::EMPTY, |mut extent, p| {
            extent.add(*p, direction);
            extent
        })
    }

    /// The rectangle around the part of a polygon between two lines across a direction.
    fn of_slab(polygon: &[Point2], direction: Point2, borders: [f64; 2]) -> Option<Self> {
        let mut extent = Self::EMPTY;
        for (i, &a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            let (from, to) = (direction.dot(a), direction.dot(b));
            if (borders[0] - ROUNDING_M..=borders[1] + ROUNDING_M).contains(&from) {
                extent.add(a, direction);
            }
            for border in borders.into_iter().filter(|border| (from - border) * (to - border) < 0.0) {
                extent.add(a + (b - a) * ((border - from) / (to - from)), direction);
            }
        }
        // Crossings of the borders lie on the borders.
        extent.along = borders;
        (extent.across[1] >= extent.across[0]).then_some(extent)
    }

    fn area(&self) -> f64 {
        (self.along[1] - self.along[0]) * (self.across[1] - self.across[0])
    }

    fn cuboid(&self, direction: Point2, heights_m: [f64; 2]) -> (Shape, Pose) {
        let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
        let half = |[low, high]: [f64; 2]| 0.5 * (high - low) + ROUNDING_M;
        let centre = direction * middle(self.along) + across(direction) * middle(self.across);
        let half_extents = Vec3::new(half(self.along), half(self.across), half(heights_m));
        let turned = Rotation::from_rpy(0.0, 0.0, direction.y.atan2(direction.x));
        let pose = Pose::new(turned, Vec3::new(centre.x, centre.y, middle(heights_m)));
        (Shape::Cuboid(Cuboid { half_extents }), pose)
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_proximity::project_point;
    use elbowroom_vision::polygon::convex_contains;
    use proptest::prelude::*;

    use super::*;

    fn contains(boxes: &[(Shape, Pose)], p: Vec3) -> bool {
        boxes.iter().any(|(shape, pose)| project_point(shape, pose, p).signed_distance <= 0.0)
    }

    #[test]
    fn a_rectangle_is_one_box() {
        let turned = |x: f64, y: f64| Point2::new(0.8 * x - 0.6 * y + 3.0, 0.6 * x + 0.8 * y - 1.0);
        let footprint = [turned(0.0, 0.0), turned(0.6, 0.0), turned(0.6, 0.4), turned(0.0, 0.4)];
        let boxes = prism_boxes(&footprint, [0.0, 2.0]);
        let [(Shape::Cuboid(cuboid), _)] = &boxes[..] else { panic!("{boxes:?}") };
        let mut sides = [cuboid.half_extents.x, cuboid.half_extents.y];
        sides.sort_by(f64::total_cmp);
        assert!(
            (sides[0] - 0.2).abs() < 1e-6
                && (sides[1] - 0.3).abs() < 1e-6
                && (cuboid.half_extents.z - 1.0).abs() < 1e-6
        );
        assert!(prism_boxes(&footprint[..1], [0.0, 1.0]).is_empty() && prism_boxes(&[], [0.0, 1.0]).is_empty());
    }

    proptest! {
        /// All points of the prism are inside the boxes, and the boxes are not much larger.
        #[test]
        fn boxes_contain_the_prism(corners in prop::collection::vec((-2.0..2.0_f64, -2.0..2.0_f64), 3..12), shares in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64), 40)) {
            let mut points: Vec<Point2> = corners.iter().map(|&(x, y)| Point2::new(x, y)).collect();
            let mut footprint = Vec::new();
            elbowroom_vision::polygon::convex_hull(&mut points, &mut footprint);
            prop_assume!(elbowroom_vision::polygon::area(&footprint) > 1e-3);
            let boxes = prism_boxes(&footprint, [0.2, 1.4]);
            for (u, v) in shares {
                let p = Point2::new(4.0 * u - 2.0, 4.0 * v - 2.0);
                if convex_contains(&footprint, p) {
                    prop_assert!(contains(&boxes, Vec3::new(p.x, p.y, 0.2 + 1.2 * u)));
                }
            }
            for corner in &footprint {
                prop_assert!(contains(&boxes, Vec3::new(corner.x, corner.y, 1.4)));
            }
            let area_of = |(shape, _): &(Shape, Pose)| match shape {
                Shape::Cuboid(c) => 4.0 * c.half_extents.x * c.half_extents.y,
                _ => f64::NAN,
            };
            let along = rectangle_direction(&footprint).unwrap();
            let boxes_area: f64 = boxes.iter().map(area_of).sum();
            prop_assert!(boxes_area <= Extent::of(&footprint, along).area() + 1e-6);
        }
    }
}
