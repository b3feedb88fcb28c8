//! Validation of taught points: finds missing and degenerate points, and computes the frames that points determine.

use std::fmt;

use elbowroom_spatial::{Rotation, Vec3};

/// Distance (m) below which two points are the same: a robot repeats to about 0.05 mm.
const SAME_POINT_M: f64 = 1e-4;
/// Sine of the angle between two directions below which they are parallel.
pub(crate) const PARALLEL_SINE: f64 = 1e-3;

/// A taught point, by its role.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TaughtPoint {
    /// Centre of a sphere.
    Centre,
    /// Point on the surface of a sphere.
    Surface,
    /// First of four points on the surface of a sphere.
    First,
    /// Second of four points on the surface of a sphere.
    Second,
    /// Third of four points on the surface of a sphere.
    Third,
    /// Fourth of four points on the surface of a sphere.
    Fourth,
    /// Centre of the base of a cylinder.
    BaseCentre,
    /// Point on the rim of the base of a cylinder.
    Rim,
    /// Point at the height of the top of a cylinder.
    Top,
    /// First corner of a box.
    FirstCorner,
    /// Second corner of a box.
    SecondCorner,
    /// Third corner of a box.
    ThirdCorner,
    /// Origin of a plane.
    Origin,
    /// Point on the x axis of a plane.
    OnX,
    /// Point in the xy plane of a plane.
    InXy,
}

impl fmt::Display for TaughtPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Centre => "the centre",
            Self::Surface => "the surface point",
            Self::First => "the first point",
            Self::Second => "the second point",
            Self::Third => "the third point",
            Self::Fourth => "the fourth point",
            Self::BaseCentre => "the base centre",
            Self::Rim => "the rim point",
            Self::Top => "the top point",
            Self::FirstCorner => "the first corner",
            Self::SecondCorner => "the second corner",
            Self::ThirdCorner => "the third corner",
            Self::Origin => "the origin",
            Self::OnX => "the point on x",
            Self::InXy => "the point in the xy plane",
        })
    }
}

/// Three taught points that must not lie on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointTriple {
    /// The first three of four points on the surface of a sphere.
    Surface,
    /// The three corners of the base of a box.
    BaseCorners,
    /// The three points of a plane.
    Plane,
}

impl fmt::Display for PointTriple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Surface => "the first three surface points",
            Self::BaseCorners => "the three base corners",
            Self::Plane => "the plane's three points",
        })
    }
}

/// A dimension of a taught solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Radius of a cylinder.
    Radius,
    /// Height of a cylinder or box.
    Height,
    /// Second edge of the base of a box.
    Width,
    /// Edge of a box along x of the world.
    LengthX,
    /// Edge of a box along y of the world.
    LengthY,
    /// Edge of a box along z of the world.
    LengthZ,
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Radius => "radius",
            Self::Height => "height",
            Self::Width => "width",
            Self::LengthX => "length along x",
            Self::LengthY => "length along y",
            Self::LengthZ => "length along z",
        })
    }
}

/// Why taught points were refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TeachError {
    /// Two points coincide.
    #[error("{a} and {b} are the same point (within 0.1 mm); teach {b} elsewhere")]
    SamePoint {
        /// First point.
        a: TaughtPoint,
        /// Second point.
        b: TaughtPoint,
    },
    /// Three points lie on a line.
    #[error("{0} lie on a line; teach one of them beside it")]
    Collinear(PointTriple),
    /// Four points lie in a plane.
    #[error("the four surface points lie in a plane; teach one of them off it")]
    Coplanar,
    /// A dimension is not larger than 0.1 mm.
    #[error("the {dimension} would be {value_m} m; it must be larger than 0.1 mm")]
    Size {
        /// The dimension.
        dimension: Dimension,
        /// Its value, m.
        value_m: f64,
    },
    /// A coordinate is not finite.
    #[error("{0} is not a finite point")]
    NotFinite(TaughtPoint),
}

/// Rotation of the plane through `origin` with x towards `on_x` and `in_xy` on the side of positive y.
pub(crate) fn plane_rotation(origin: Vec3, on_x: Vec3, in_xy: Vec3) -> Result<Rotation, TeachError> {
    require_distinct([(TaughtPoint::Origin, origin), (TaughtPoint::OnX, on_x), (TaughtPoint::InXy, in_xy)])?;
    require_not_collinear(on_x - origin, in_xy - origin, PointTriple::Plane)?;
    Rotation::from_x_and_xy(on_x - origin, in_xy - origin).ok_or(TeachError::Collinear(PointTriple::Plane))
}

/// Refuses points that are not finite, and points that coincide.
pub(crate) fn require_distinct<const N: usize>(points: [(TaughtPoint, Vec3); N]) -> Result<(), TeachError> {
    for (i, (b, p)) in points.iter().enumerate() {
        if !p.is_finite() {
            return Err(TeachError::NotFinite(*b));
        }
        if let Some((a, _)) = points[..i].iter().find(|(_, o)| o.distance(*p) < SAME_POINT_M) {
            return Err(TeachError::SamePoint { a: *a, b: *b });
        }
    }
    Ok(())
}

/// Refuses parallel edges `u` and `v` of three points.
pub(crate) fn require_not_collinear(u: Vec3, v: Vec3, points: PointTriple) -> Result<(), TeachError> {
    if u.cross(v).length() < PARALLEL_SINE * u.length() * v.length() {
        Err(TeachError::Collinear(points))
    } else {
        Ok(())
    }
}

/// Refuses dimensions that are not larger than `SAME_POINT_M`.
pub(crate) fn require_positive(dimension: Dimension, value_m: f64) -> Result<(), TeachError> {
    if value_m > SAME_POINT_M { Ok(()) } else { Err(TeachError::Size { dimension, value_m }) }
}
