//! Regions from taught points: the robot is driven to characteristic points, and their positions are recorded.
//!
//! Every function refuses points that do not determine its shape. The error names the points.

use elbowroom_spatial::{Rotation, Vec3};

use crate::Region;
use crate::taught_points::{PARALLEL_SINE, require_distinct, require_not_collinear, require_positive};

pub use crate::taught_points::{Dimension, PointTriple, TaughtPoint, TeachError};

/// Sine (of 5°) of the normal's elevation below which a base counts as upright; a taught base may lean to either
/// side.
const UPRIGHT_SINE: f64 = 0.087;

/// A sphere from its centre and one point on its surface (m).
///
/// # Errors
/// [`TeachError`] if the two points coincide.
///
/// ```
/// use elbowroom_monitor::teach;
/// use elbowroom_spatial::Vec3;
/// let ball = teach::sphere_from_center("ball", Vec3::ZERO, Vec3::X * 0.3)?;
/// assert_eq!(ball.shape.volume(), 4.0 / 3.0 * std::f64::consts::PI * 0.027);
/// assert!(teach::sphere_from_center("ball", Vec3::X, Vec3::X).is_err());
/// # Ok::<(), teach::TeachError>(())
/// ```
pub fn sphere_from_center(name: &str, center: Vec3, surface: Vec3) -> Result<Region, TeachError> {
    require_distinct([(TaughtPoint::Centre, center), (TaughtPoint::Surface, surface)])?;
    Ok(Region::sphere(name, center, center.distance(surface)))
}

/// A sphere from four points on its surface (m).
///
/// # Errors
/// [`TeachError`] if points coincide, three lie on a line or all four lie in a plane.
pub fn sphere_from_points(name: &str, points: [Vec3; 4]) -> Result<Region, TeachError> {
    let names = [TaughtPoint::First, TaughtPoint::Second, TaughtPoint::Third, TaughtPoint::Fourth];
    require_distinct(std::array::from_fn::<_, 4, _>(|i| (names[i], points[i])))?;
    let [a, b, c] = [points[1] - points[0], points[2] - points[0], points[3] - points[0]];
    require_not_collinear(a, b, PointTriple::Surface)?;
    let volume = a.dot(b.cross(c));
    if volume.abs() < PARALLEL_SINE * a.length() * b.length() * c.length() {
        return Err(TeachError::Coplanar);
    }
    // The centre x solves 2·a·x = |a|², likewise for b and c, measured from the first point.
    let x = (b.cross(c) * a.length_squared() + c.cross(a) * b.length_squared() + a.cross(b) * c.length_squared())
        / (2.0 * volume);
    Ok(Region::sphere(name, points[0] + x, x.length()))
}

/// A vertical cylinder from the centre of its base, a point on the base's rim and a point at the height of its top
/// (m).
///
/// The axis is perpendicular to the world's XY plane, as in Romanelli 2011, upwards or downwards.
///
/// # Errors
/// [`TeachError`] if points coincide, or the radius or height is zero.
pub fn cylinder(name: &str, base: Vec3, rim: Vec3, top: Vec3) -> Result<Region, TeachError> {
    require_distinct([(TaughtPoint::BaseCentre, base), (TaughtPoint::Rim, rim), (TaughtPoint::Top, top)])?;
    let radius = (rim.x - base.x).hypot(rim.y - base.y);
    let height = (top.z - base.z).abs();
    require_positive(Dimension::Radius, radius)?;
    require_positive(Dimension::Height, height)?;
    let bottom = Vec3::new(base.x, base.y, base.z.min(top.z));
    Ok(Region::cylinder(name, bottom, radius, height, Rotation::IDENTITY))
}

/// A plane from its origin, a point on its x axis and a point in its xy plane (m); the region lies below it.
///
/// # Errors
/// [`TeachError`] if points coincide or lie on a line.
pub fn plane(name: &str, origin: Vec3, on_x: Vec3, in_xy: Vec3) -> Result<Region, TeachError> {
    Region::plane(name, origin, on_x, in_xy)
}

/// A box parallel to the world's axes from two opposite corners (m).
///
/// # Errors
/// [`TeachError`] if an edge has zero length.
pub fn cuboid_from_corners(name: &str, from: Vec3, to: Vec3) -> Result<Region, TeachError> {
    require_distinct([(TaughtPoint::FirstCorner, from), (TaughtPoint::SecondCorner, to)])?;
    let size = (to - from).abs();
    require_positive(Dimension::LengthX, size.x)?;
    require_positive(Dimension::LengthY, size.y)?;
    require_positive(Dimension::LengthZ, size.z)?;
    Ok(Region::cuboid_from_corners(name, from, to))
}

/// A box of any orientation from three corners of its base (both edges start at the first corner) and a height (m).
///
/// The second edge is made perpendicular to the first. A positive height points up and a negative height points
/// down, in any order of the corners ([`height_direction`]).
///
/// # Errors
/// [`TeachError`] if the corners lie on a line or the height is zero.
///
/// ```
/// use elbowroom_monitor::teach;
/// use elbowroom_spatial::Vec3;
/// let [corner, x, y] = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// for (along, across) in [(x, y), (y, x)] {
///     let above = teach::cuboid_from_base("above", corner, along, across, 0.4)?;
///     assert_eq!((above.anchor * above.shape_in_anchor).translation.z, 0.2);
///     let below = teach::cuboid_from_base("below", corner, along, across, -0.4)?;
///     assert_eq!((below.anchor * below.shape_in_anchor).translation.z, -0.2);
/// }
/// # Ok::<(), teach::TeachError>(())
/// ```
pub fn cuboid_from_base(
    name: &str,
    corner: Vec3,
    along: Vec3,
    across: Vec3,
    height: f64,
) -> Result<Region, TeachError> {
    require_positive(Dimension::Height, height.abs())?;
    let direction = height_direction(corner, along, across, height)?.direction;
    let collinear = TeachError::Collinear(PointTriple::BaseCorners);
    let taught = Rotation::from_x_and_xy(along - corner, across - corner).ok_or(collinear.clone())?;
    let length = corner.distance(along);
    let width = taught.y_axis().dot(across - corner);
    require_positive(Dimension::Width, width)?;
    let center = corner + taught.x_axis() * (length / 2.0) + taught.y_axis() * (width / 2.0);
    // The anchor lies on the lower side with its z axis up. An upright base has no lower side: its anchor is on the
    // taught side.
    let lower = if direction.z < 0.0 { center + direction * height.abs() } else { center };
    let up = if direction.z < 0.0 { -direction } else { direction };
    let rotation = if taught.z_axis().dot(up) > 0.0 {
        taught
    } else {
        // The frame is rotated by half a turn about the first edge.
        Rotation::from_x_and_xy(taught.x_axis(), -taught.y_axis()).ok_or(collinear)?
    };
    Ok(Region::cuboid(name, lower, Vec3::new(length, width, height.abs()), rotation))
}

/// Direction of the height of a taught box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightDirection {
    /// Unit vector in the world, from the taught base into the box, perpendicular to the base.
    pub direction: Vec3,
    /// True if the base is upright within 5°. It has no upper side then, and the order of the corners decides.
    pub upright_base: bool,
}

/// The direction of the height in [`cuboid_from_base`]: perpendicular to the base, upwards (the world's +z) if the
/// height is positive, downwards if it is negative.
///
/// An upright base has no upper side. There a positive height points along the first edge (corner to `along`) × the
/// second (corner to `across`), and a negative height points in the opposite direction.
///
/// # Errors
/// [`TeachError`] if the corners coincide or lie on a line.
pub fn height_direction(corner: Vec3, along: Vec3, across: Vec3, height: f64) -> Result<HeightDirection, TeachError> {
    require_distinct([
        (TaughtPoint::FirstCorner, corner),
        (TaughtPoint::SecondCorner, along),
        (TaughtPoint::ThirdCorner, across),
    ])?;
    let triple = PointTriple::BaseCorners;
    require_not_collinear(along - corner, across - corner, triple)?;
    let normal = (along - corner).cross(across - corner).try_normalize().ok_or(TeachError::Collinear(triple))?;
    let upright_base = normal.z.abs() < UPRIGHT_SINE;
    let positive = if normal.z < 0.0 && !upright_base { -normal } else { normal };
    Ok(HeightDirection { direction: if height < 0.0 { -positive } else { positive }, upright_base })
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_proximity::{Shape, project_point};

    fn on_surface(region: &Region, p: Vec3) -> f64 {
        project_point(&region.shape, &(region.anchor * region.shape_in_anchor), p).signed_distance.abs()
    }

    #[test]
    fn four_points_make_the_sphere_through_them() {
        let center = Vec3::new(0.7, -0.2, 1.1);
        let points = [Vec3::X, Vec3::Y, -Vec3::Z, Vec3::new(-0.6, 0.0, 0.8)].map(|d| center + d * 0.35);
        let region = sphere_from_points("s", points).unwrap();
        assert!((region.anchor.translation - center).length() < 1e-12);
        for p in points {
            assert!(on_surface(&region, p) < 1e-12);
        }
    }

    #[test]
    fn a_tilted_box_has_its_taught_corners_on_its_surface() {
        let corners = [Vec3::new(1.0, 0.0, 0.2), Vec3::new(1.4, 0.3, 0.3), Vec3::new(0.8, 0.4, 0.1)];
        for height in [0.5, -0.5] {
            let region = cuboid_from_base("b", corners[0], corners[1], corners[2], height).unwrap();
            assert!(on_surface(&region, corners[0]) < 1e-12 && on_surface(&region, corners[1]) < 1e-12);
        }
    }

    #[test]
    fn the_order_of_corners_does_not_flip_a_box() {
        // The base is level, or leans by up to 80 degrees in several directions.
        for k in 0..40 {
            let (lean, round) = (f64::from(k % 8) * 11.0_f64.to_radians(), f64::from(k) * 0.7);
            let turn = Rotation::from_axis_angle(Vec3::new(round.cos(), round.sin(), 0.0), lean);
            let corner = Vec3::new(0.6, -0.2, 0.3);
            let (x, y) = (turn.x_axis() * 0.4, turn.y_axis() * 0.3);
            let center = corner + (x + y) * 0.5;
            for (along, across) in [(x, y), (y, x)] {
                for height in [0.25, -0.25] {
                    let region = cuboid_from_base("b", corner, corner + along, corner + across, height).unwrap();
                    let centre = (region.anchor * region.shape_in_anchor).translation;
                    // The upward normal is the turned z axis: it leans by less than a right angle.
                    let expected = center + turn.z_axis() * (height / 2.0);
                    assert!(centre.distance(expected) < 1e-12, "{lean} {height} {centre:?} {expected:?}");
                    for p in [corner, corner + along, corner + across] {
                        assert!(on_surface(&region, p) < 1e-12);
                    }
                    assert!(region.anchor.rotation.z_axis().z > 0.0, "its z axis points up");
                }
            }
        }
    }

    #[test]
    fn the_order_of_corners_decides_for_an_upright_base() {
        let side = |along, across, height| height_direction(Vec3::ZERO, along, across, height).unwrap();
        for lean in [-0.06, 0.0, 0.06] {
            let up = Vec3::new(0.0, lean, 1.0);
            let (one, other) = (side(Vec3::X, up, 1.0), side(up, Vec3::X, 1.0));
            assert!(one.upright_base && other.upright_base);
            assert!(one.direction.y < -0.9 && other.direction.y > 0.9, "{one:?} {other:?}");
            assert!(side(Vec3::X, up, -1.0).direction.y > 0.9);
            let region = cuboid_from_base("b", Vec3::ZERO, Vec3::X, up, 1.0).unwrap();
            assert!(((region.anchor * region.shape_in_anchor).translation.y + 0.5).abs() < 0.1);
        }
        assert!(!side(Vec3::X, Vec3::new(0.0, 0.2, 1.0), 1.0).upright_base);
    }

    #[test]
    fn a_cylinder_taught_from_the_top_is_the_same() {
        let up = cylinder("c", Vec3::ZERO, Vec3::X * 0.2, Vec3::Z).unwrap();
        let down = cylinder("c", Vec3::Z, Vec3::new(0.2, 0.0, 1.0), Vec3::ZERO).unwrap();
        assert_eq!(up.anchor, down.anchor);
        assert!(matches!(up.shape, Shape::Cylinder(c) if c.radius == 0.2 && c.half_length == 0.5));
    }

    #[test]
    fn degenerate_points_are_refused_with_the_reason() {
        let [o, x, y] = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let cases = [
            (sphere_from_center("s", o, o), "same point"),
            (sphere_from_points("s", [o, x, x * 2.0, y]), "on a line"),
            (sphere_from_points("s", [o, x, y, x + y]), "in a plane"),
            (cylinder("c", o, Vec3::Z, x + Vec3::Z), "radius"),
            (cylinder("c", o, x, y), "height"),
            (plane("p", o, x, x * 3.0), "on a line"),
            (plane("p", o, x, Vec3::splat(f64::NAN)), "not a finite point"),
            (cuboid_from_corners("b", o, Vec3::new(1.0, 1.0, 0.0)), "along z"),
            (cuboid_from_base("b", o, x, -x, 1.0), "on a line"),
            (cuboid_from_base("b", o, x, y, 0.0), "height"),
        ];
        for (result, expected) in cases {
            let message = result.unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
