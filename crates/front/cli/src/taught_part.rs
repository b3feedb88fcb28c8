//! What the points taught so far determine of a region: a robot is compared with it before all points are there.

use elbowroom::monitor::Region;
use elbowroom::proximity::{Capsule, Shape};
use elbowroom::spatial::{Pose, Rotation, Vec3};

use crate::taught_fence::TaughtFence;
use crate::taught_region::{TaughtRegion, TaughtSolid};
use crate::taught_shape::TaughtShape;

/// Radius of points and lines, thickness of surfaces, m: distances are too small by at most this.
const THIN_M: f64 = 1e-5;

/// A part of a region as a region of its own.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TaughtPart {
    /// Its table.
    pub(crate) toml: String,
    /// Its name for the person who teaches.
    pub(crate) what: &'static str,
}

/// The part of a region that these points determine; `None` without points, or if they do not determine a part.
pub(crate) fn part(taught: &TaughtRegion<'_>, points: &[Vec3]) -> Option<TaughtPart> {
    let name = taught.name;
    let shape = |region: Region| taught.table(&TaughtSolid::Shape(Box::new(region)));
    let of = |what: &'static str, toml: String| Some(TaughtPart { toml, what });
    let point = |p: Vec3| shape(Region::sphere(name, p, THIN_M));
    match (taught.shape.shape, points) {
        (_, []) => None,
        (TaughtShape::Fence, points) => fence(taught, points),
        (TaughtShape::Sphere4, [.., last]) => of("the last point", point(*last)),
        (_, [p]) => of("the point", point(*p)),
        (TaughtShape::Plane | TaughtShape::Box3, [a, b]) => of("the line of both points", shape(line(name, *a, *b)?)),
        (TaughtShape::Cylinder, [base, rim]) => {
            let radius_m = (rim.x - base.x).hypot(rim.y - base.y);
            let disc = Region::cylinder(name, *base, radius_m, THIN_M, Rotation::IDENTITY);
            if radius_m > THIN_M { of("the base", shape(disc)) } else { None }
        }
        _ => None,
    }
}

/// The walls between the corners so far.
fn fence(taught: &TaughtRegion<'_>, points: &[Vec3]) -> Option<TaughtPart> {
    let (name, height_m) = (taught.name, taught.height_m()?);
    let shape = |region: Region| taught.table(&TaughtSolid::Shape(Box::new(region)));
    let part = match points {
        [corner] => {
            let post = Region::cylinder(name, *corner, THIN_M, height_m, Rotation::IDENTITY);
            TaughtPart { toml: shape(post), what: "the upright line on the corner" }
        }
        [a, b] => {
            let (along, floor_m) = (*b - *a, a.z.min(b.z));
            let length_m = along.x.hypot(along.y);
            if length_m < THIN_M {
                return None;
            }
            let middle = (*a + *b) * 0.5;
            let turned = Rotation::from_rpy(0.0, 0.0, along.y.atan2(along.x));
            let base = Vec3::new(middle.x, middle.y, floor_m);
            let wall = Region::cuboid(name, base, Vec3::new(length_m, THIN_M, height_m), turned);
            TaughtPart { toml: shape(wall), what: "the wall" }
        }
        points => {
            let keys = TaughtFence::new(points, height_m).keys_without_last_wall(taught.units);
            TaughtPart { toml: taught.fence_table(&keys), what: "the walls so far" }
        }
    };
    // Walls that cross, or turn back, are told when the fence is closed.
    taught.problem(&part.toml, "the points".as_ref()).is_none().then_some(part)
}

/// The line between two points; `None` if they are one.
fn line(name: &str, from: Vec3, to: Vec3) -> Option<Region> {
    let length_m = from.distance(to);
    let capsule = Capsule { half_length: 0.5 * length_m, radius: THIN_M };
    let pose = Pose::new(Rotation::from_z((to - from).try_normalize()?), (from + to) * 0.5);
    (length_m > THIN_M).then(|| Region::solid(name, Shape::Capsule(capsule), pose))
}

#[cfg(test)]
mod tests {
    use elbowroom::cell::{Cell, Units};
    use elbowroom::proximity::{Sphere, separation};
    use elbowroom::spatial::units::{AngleUnit, LengthUnit};

    use super::*;
    use crate::taught_shape::TaughtShapeArgs;

    const POINTS: [Vec3; 3] = [Vec3::new(0.3, -0.2, 0.1), Vec3::new(1.1, 0.4, 0.1), Vec3::new(0.5, 1.4, 0.3)];

    /// The distance of a place from the part that the first points of a shape determine, m, with its name.
    fn distance(shape: TaughtShape, count: usize, units: Units, p: Vec3) -> Option<(f64, &'static str)> {
        let height = matches!(shape, TaughtShape::Fence | TaughtShape::Box3).then(|| 2.0 / units.length.to_metres(1.0));
        let args = TaughtShapeArgs { shape, flange: false, height, inside: false, warning: 0.0 };
        let taught = TaughtRegion { name: "part of it", shape: &args, units, is_temporary: true };
        let found = part(&taught, &POINTS[..count])?;
        let (length, angle) = (units.length.symbol(), units.angle.symbol());
        let head = format!("version = 1\nunits = {{ length = \"{length}\", angle = \"{angle}\" }}\n");
        let cell = Cell::parse("part.toml", &(head + &found.toml)).unwrap_or_else(|e| panic!("{e}: {}", found.toml));
        let region = &cell.regions[0].region;
        let point = Shape::Sphere(Sphere { radius: 0.0 });
        let at = region.anchor * region.shape_in_anchor;
        Some((separation(&point, &Pose::from_translation(p), &region.shape, &at).distance, found.what))
    }

    fn to_segment(p: Vec3, a: Vec3, b: Vec3) -> f64 {
        let part = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + (b - a) * part)
    }

    #[test]
    fn parts_are_where_their_points_are() {
        let [a, b, c] = POINTS;
        let flat = |p: Vec3| Vec3::new(p.x, p.y, 0.0);
        let places = [Vec3::new(2.0, 1.0, 0.5), Vec3::new(-1.0, 0.3, 1.0), Vec3::new(0.6, -0.9, 1.7)];
        let units = [(LengthUnit::Millimetre, AngleUnit::Degree), (LengthUnit::Metre, AngleUnit::Radian)];
        for ((length, angle), p) in units.into_iter().flat_map(|units| places.map(|p| (units, p))) {
            let units = Units { length, angle };
            let check = |shape: TaughtShape, count: usize, exact: f64, what: &str| {
                let (found, name) = distance(shape, count, units, p).unwrap_or_else(|| panic!("{shape:?} {count}"));
                assert!((exact - found).abs() < 3e-5 && name == what, "{shape:?} {count}: {found} {exact} {name}");
            };
            for shape in [TaughtShape::Sphere, TaughtShape::Box, TaughtShape::Plane, TaughtShape::Cylinder] {
                check(shape, 1, p.distance(a), "the point");
            }
            check(TaughtShape::Sphere4, 1, p.distance(a), "the last point");
            check(TaughtShape::Sphere4, 3, p.distance(c), "the last point");
            check(TaughtShape::Plane, 2, to_segment(p, a, b), "the line of both points");
            check(TaughtShape::Box3, 2, to_segment(p, a, b), "the line of both points");
            let radius = (b.x - a.x).hypot(b.y - a.y);
            let beside = ((p.x - a.x).hypot(p.y - a.y) - radius).max(0.0);
            check(TaughtShape::Cylinder, 2, beside.hypot(p.z - a.z), "the base");
            // All places are at the height of the walls.
            check(TaughtShape::Fence, 1, flat(p).distance(flat(a)), "the upright line on the corner");
            let wall = |a, b| to_segment(flat(p), flat(a), flat(b));
            check(TaughtShape::Fence, 2, wall(a, b), "the wall");
            // The walls are on the outer side: nearer by their thickness there, at a corner by its diagonal.
            let (found, name) = distance(TaughtShape::Fence, 3, units, p).unwrap();
            let exact = wall(a, b).min(wall(b, c));
            assert!(found <= exact + 1e-5 && found >= exact - 0.0708 && name == "the walls so far", "{found} {exact}");
        }
    }

    #[test]
    fn points_that_determine_nothing_have_no_part() {
        let units = Units { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
        assert_eq!(distance(TaughtShape::Sphere, 0, units, Vec3::ZERO), None);
        let args = TaughtShapeArgs {
            shape: TaughtShape::Fence,
            flange: false,
            height: Some(500.0),
            inside: false,
            warning: 0.0,
        };
        let fence = TaughtRegion { name: "f", shape: &args, units, is_temporary: true };
        assert_eq!(part(&fence, &[Vec3::X, Vec3::X]), None);
        assert_eq!(part(&fence, &[Vec3::ZERO, Vec3::X, Vec3::X * 2.0]), None);
        let args = TaughtShapeArgs { shape: TaughtShape::Box3, ..args };
        let edge = TaughtRegion { shape: &args, ..fence };
        assert_eq!(part(&edge, &[Vec3::X, Vec3::X]), None);
    }
}
