//! What the map can be asked to block: convex solids, placed in the arm's base frame.

use std::sync::Arc;

use elbowroom_proximity::{ConvexHull, Cuboid, Shape, Sphere};
use elbowroom_spatial::{Pose, Vec3};

/// A convex solid in the arm's base frame, checked once.
///
/// ```
/// use elbowroom_cspace::Obstacle;
/// use elbowroom_spatial::{Pose, Vec3};
/// let head = Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?;
/// let crate_in_base = Pose::from_xyz_rpy([1.3, 0.4, 0.9], [0.0, 0.0, 0.5]);
/// let crate_ = Obstacle::cuboid(crate_in_base, Vec3::new(0.25, 0.2, 0.3))?;
/// assert!(Obstacle::sphere(Vec3::new(f64::NAN, 0.0, 0.0), 0.25).is_err());
/// # Ok::<(), elbowroom_cspace::ObstacleError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Obstacle {
    pub(crate) solid: Solid,
}

#[derive(Debug, Clone)]
pub(crate) enum Solid {
    Sphere { center: Vec3, radius: f64 },
    Cuboid { in_base: Pose, half_extents: Vec3 },
    Hull { in_base: Pose, hull: Arc<ConvexHull> },
}

/// Why something cannot be an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ObstacleError {
    /// A coordinate is NaN, infinite, or beyond [`Obstacle::FARTHEST_M`].
    #[error(
        "the obstacle's place has a number that is NaN, infinite or beyond 1e5 m: give metres in the arm's base frame"
    )]
    Place,
    /// A size is negative, NaN, infinite, or beyond [`Obstacle::FARTHEST_M`].
    #[error("the obstacle's size is {0} m: it must be a number from 0 to 1e5")]
    Size(f64),
}

impl Obstacle {
    /// Nothing may be farther away or larger than this, metres: beyond, single precision would need coarse margins.
    pub const FARTHEST_M: f64 = 1e5;

    /// A ball; centre in the arm's base frame, metres.
    ///
    /// # Errors
    /// A number that is not finite or too large, a negative radius.
    pub fn sphere(center: Vec3, radius: f64) -> Result<Self, ObstacleError> {
        place(&Pose::from_translation(center))?;
        size(radius)?;
        Ok(Self { solid: Solid::Sphere { center, radius } })
    }

    /// A box around its frame's origin; half edge lengths in metres.
    ///
    /// # Errors
    /// A number that is not finite or too large, a negative size.
    pub fn cuboid(in_base: Pose, half_extents: Vec3) -> Result<Self, ObstacleError> {
        place(&in_base)?;
        half_extents.to_array().into_iter().try_for_each(size)?;
        Ok(Self { solid: Solid::Cuboid { in_base, half_extents } })
    }

    /// A convex polyhedron.
    ///
    /// # Errors
    /// A number that is not finite or too large.
    pub fn hull(in_base: Pose, hull: Arc<ConvexHull>) -> Result<Self, ObstacleError> {
        place(&in_base)?;
        hull.vertices().iter().try_for_each(|v| size(v.length()))?;
        Ok(Self { solid: Solid::Hull { in_base, hull } })
    }

    /// The same solid for `elbowroom-proximity`, and its pose in the arm's base frame.
    pub fn shape(&self) -> (Shape, Pose) {
        match &self.solid {
            Solid::Sphere { center, radius } => {
                (Shape::Sphere(Sphere { radius: *radius }), Pose::from_translation(*center))
            }
            Solid::Cuboid { in_base, half_extents } => {
                (Shape::Cuboid(Cuboid { half_extents: *half_extents }), *in_base)
            }
            Solid::Hull { in_base, hull } => (Shape::Hull(Arc::clone(hull)), *in_base),
        }
    }

    /// Corners in the arm's base frame; the centre of a sphere.
    pub fn corners(&self) -> Vec<Vec3> {
        match &self.solid {
            Solid::Sphere { center, .. } => vec![*center],
            Solid::Cuboid { in_base, half_extents: h } => {
                let corner = |i: u8| {
                    let side = |bit: u8| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                    in_base.transform_point(Vec3::new(side(0) * h.x, side(1) * h.y, side(2) * h.z))
                };
                (0..8).map(corner).collect()
            }
            Solid::Hull { in_base, hull } => hull.vertices().iter().map(|&v| in_base.transform_point(v)).collect(),
        }
    }

    /// The smallest sphere about the solid's middle that holds it: centre in the arm's base frame, radius, metres.
    pub fn enclosing_sphere(&self) -> (Vec3, f64) {
        match &self.solid {
            Solid::Sphere { center, radius } => (*center, *radius),
            Solid::Cuboid { in_base, half_extents } => (in_base.translation, half_extents.length()),
            Solid::Hull { in_base, hull } => {
                let middle = (hull.aabb().min + hull.aabb().max) * 0.5;
                let radius = hull.vertices().iter().map(|v| v.distance(middle)).fold(0.0, f64::max);
                (in_base.transform_point(middle), radius)
            }
        }
    }
}

fn place(in_base: &Pose) -> Result<(), ObstacleError> {
    let near = in_base.is_finite() && in_base.translation.abs().max_element() <= Obstacle::FARTHEST_M;
    if near { Ok(()) } else { Err(ObstacleError::Place) }
}

fn size(value: f64) -> Result<(), ObstacleError> {
    if (0.0..=Obstacle::FARTHEST_M).contains(&value) { Ok(()) } else { Err(ObstacleError::Size(value)) }
}
