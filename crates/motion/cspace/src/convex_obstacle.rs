//! Convex obstacles in the arm's base frame.

use std::sync::Arc;

use elbowroom_proximity::{ConvexHull, Cuboid, Shape, Sphere};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::cuboid;

/// A convex solid in the arm's base frame, validated at construction.
///
/// ```
/// use elbowroom_cspace::ConvexObstacle;
/// use elbowroom_spatial::{Pose, Vec3};
/// let sphere = ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?;
/// let cuboid_in_base = Pose::from_xyz_rpy([1.3, 0.4, 0.9], [0.0, 0.0, 0.5]);
/// let cuboid = ConvexObstacle::cuboid(cuboid_in_base, Vec3::new(0.25, 0.2, 0.3))?;
/// assert!(ConvexObstacle::sphere(Vec3::new(f64::NAN, 0.0, 0.0), 0.25).is_err());
/// # Ok::<(), elbowroom_cspace::ConvexObstacleError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ConvexObstacle {
    pub(crate) solid: ConvexShape,
}

#[derive(Debug, Clone)]
pub(crate) enum ConvexShape {
    Sphere { center: Vec3, radius: f64 },
    Cuboid { in_base: Pose, half_extents: Vec3 },
    Hull { in_base: Pose, hull: Arc<ConvexHull> },
}

/// Why a solid cannot be an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ConvexObstacleError {
    /// A coordinate is NaN, infinite, or beyond [`ConvexObstacle::MAX_COORDINATE_M`].
    #[error(
        "the obstacle's place has a number that is NaN, infinite or beyond 1e5 m: give metres in the arm's base frame"
    )]
    Place,
    /// A size is negative, NaN, infinite, or beyond [`ConvexObstacle::MAX_COORDINATE_M`].
    #[error("the obstacle's size is {0} m: it must be a number from 0 to 1e5")]
    Size(f64),
}

impl ConvexObstacle {
    /// Limit of coordinates and sizes, metres: beyond it, single precision would need coarse margins.
    pub const MAX_COORDINATE_M: f64 = 1e5;

    /// Creates a sphere; centre in the arm's base frame, metres.
    ///
    /// # Errors
    /// A number is not finite or too large, or the radius is negative.
    pub fn sphere(center: Vec3, radius: f64) -> Result<Self, ConvexObstacleError> {
        validate_pose(&Pose::from_translation(center))?;
        validate_size(radius)?;
        Ok(Self { solid: ConvexShape::Sphere { center, radius } })
    }

    /// Creates a box around its frame's origin; half edge lengths in metres.
    ///
    /// # Errors
    /// A number is not finite or too large, or a size is negative.
    pub fn cuboid(in_base: Pose, half_extents: Vec3) -> Result<Self, ConvexObstacleError> {
        validate_pose(&in_base)?;
        half_extents.to_array().into_iter().try_for_each(validate_size)?;
        Ok(Self { solid: ConvexShape::Cuboid { in_base, half_extents } })
    }

    /// Creates a convex polyhedron.
    ///
    /// # Errors
    /// A number is not finite or too large.
    pub fn hull(in_base: Pose, hull: Arc<ConvexHull>) -> Result<Self, ConvexObstacleError> {
        validate_pose(&in_base)?;
        hull.vertices().iter().try_for_each(|v| validate_size(v.length()))?;
        Ok(Self { solid: ConvexShape::Hull { in_base, hull } })
    }

    /// The solid as a shape of `elbowroom-proximity`, and its pose in the arm's base frame.
    pub fn shape(&self) -> (Shape, Pose) {
        match &self.solid {
            ConvexShape::Sphere { center, radius } => {
                (Shape::Sphere(Sphere { radius: *radius }), Pose::from_translation(*center))
            }
            ConvexShape::Cuboid { in_base, half_extents } => {
                (Shape::Cuboid(Cuboid { half_extents: *half_extents }), *in_base)
            }
            ConvexShape::Hull { in_base, hull } => (Shape::Hull(Arc::clone(hull)), *in_base),
        }
    }

    /// The axis-aligned bounding box in the arm's base frame.
    pub(crate) fn bounds(&self) -> Aabb {
        let (shape, in_base) = self.shape();
        shape.aabb(&in_base)
    }

    /// Corners in the arm's base frame; for a sphere its centre.
    pub fn corners(&self) -> Vec<Vec3> {
        match &self.solid {
            ConvexShape::Sphere { center, .. } => vec![*center],
            ConvexShape::Cuboid { in_base, half_extents } => {
                cuboid::corners(*half_extents).iter().map(|&corner| in_base.transform_point(corner)).collect()
            }
            ConvexShape::Hull { in_base, hull } => {
                hull.vertices().iter().map(|&v| in_base.transform_point(v)).collect()
            }
        }
    }

    /// The smallest sphere around the solid's centre that contains it: centre in the arm's base frame, and radius,
    /// metres.
    pub fn enclosing_sphere(&self) -> (Vec3, f64) {
        match &self.solid {
            ConvexShape::Sphere { center, radius } => (*center, *radius),
            ConvexShape::Cuboid { in_base, half_extents } => (in_base.translation, half_extents.length()),
            ConvexShape::Hull { in_base, hull } => {
                let middle = (hull.aabb().min + hull.aabb().max) * 0.5;
                let radius = hull.vertices().iter().map(|v| v.distance(middle)).fold(0.0, f64::max);
                (in_base.transform_point(middle), radius)
            }
        }
    }
}

fn validate_pose(in_base: &Pose) -> Result<(), ConvexObstacleError> {
    let near = in_base.is_finite() && in_base.translation.abs().max_element() <= ConvexObstacle::MAX_COORDINATE_M;
    if near { Ok(()) } else { Err(ConvexObstacleError::Place) }
}

fn validate_size(value: f64) -> Result<(), ConvexObstacleError> {
    if (0.0..=ConvexObstacle::MAX_COORDINATE_M).contains(&value) {
        Ok(())
    } else {
        Err(ConvexObstacleError::Size(value))
    }
}
