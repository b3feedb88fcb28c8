//! How a solid is replaced by an enclosing volume.

use elbowroom_spatial::Pose;

use crate::{ConvexHull, Shape, fit};

/// The kind of volume that replaces a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VolumeModel {
    /// The smaller of the enclosing capsule and the enclosing box, per solid.
    #[default]
    Tightest,
    /// The enclosing capsule.
    Capsule,
    /// The enclosing box.
    Box,
    /// The convex hull.
    Hull,
    /// The solid itself.
    Exact,
}

impl VolumeModel {
    /// The volume of a tool, a load or an object: primitives as they are, a mesh as [`VolumeModel::of`].
    pub fn of_solid(self, shape: &Shape, in_frame: Pose) -> (Shape, Pose) {
        if matches!(shape, Shape::Mesh(_)) { self.of(shape, in_frame) } else { (shape.clone(), in_frame) }
    }

    /// The volume of one solid; every model encloses the solid.
    pub fn of(self, shape: &Shape, in_frame: Pose) -> (Shape, Pose) {
        let points = match shape {
            Shape::Mesh(mesh) if self != Self::Exact => mesh.vertices(),
            Shape::Hull(hull) if !matches!(self, Self::Exact | Self::Hull) => hull.vertices(),
            _ => return (shape.clone(), in_frame),
        };
        let fitted = match self {
            Self::Capsule => fit::capsule(points),
            Self::Box => fit::cuboid(points),
            Self::Hull => {
                if let Ok(hull) = ConvexHull::from_points(points) {
                    return (Shape::Hull(hull.into()), in_frame);
                }
                fit::tightest(points)
            }
            Self::Tightest | Self::Exact => fit::tightest(points),
        };
        // A solid that cannot be fitted, as all its points coincide, is used as it is.
        fitted.map_or_else(|| (shape.clone(), in_frame), |f| (f.shape, in_frame * f.in_frame))
    }
}
