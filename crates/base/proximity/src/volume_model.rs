//! The kind of enclosing volume that replaces a solid.

use elbowroom_spatial::Pose;
use rayon::prelude::*;

use crate::{Shape, fit};

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
    /// The volume of a tool, a load or an object: primitives unchanged, a mesh as by [`VolumeModel::of`].
    pub fn of_solid(self, shape: &Shape, in_frame: Pose) -> (Shape, Pose) {
        if matches!(shape, Shape::Mesh(_)) { self.of(shape, in_frame) } else { (shape.clone(), in_frame) }
    }

    /// The volumes of several solids, fitted on all cores.
    ///
    /// ```
    /// use elbowroom_proximity::{Shape, Sphere, VolumeModel};
    /// use elbowroom_spatial::Pose;
    /// let ball = Shape::Sphere(Sphere { radius: 0.1 });
    /// assert!(matches!(VolumeModel::Tightest.of_all(&[(&ball, Pose::IDENTITY)])[..], [(Shape::Sphere(_), _)]));
    /// ```
    pub fn of_all(self, solids: &[(&Shape, Pose)]) -> Vec<(Shape, Pose)> {
        solids.par_iter().with_max_len(1).map(|(shape, in_frame)| self.of(shape, *in_frame)).collect()
    }

    /// The volume of one solid. With every model, it encloses the solid.
    pub fn of(self, shape: &Shape, in_frame: Pose) -> (Shape, Pose) {
        let fitted = match (self, shape) {
            (Self::Capsule, Shape::Mesh(mesh)) => fit::capsule_of_mesh(mesh),
            (Self::Capsule, Shape::Hull(hull)) => fit::capsule(hull.vertices()),
            (Self::Box, Shape::Mesh(mesh)) => fit::cuboid_of_mesh(mesh),
            (Self::Box, Shape::Hull(hull)) => fit::cuboid(hull.vertices()),
            (Self::Hull, Shape::Mesh(mesh)) => {
                if let Some(hull) = mesh.hull() {
                    return (Shape::Hull(hull.clone().into()), in_frame);
                }
                fit::tightest_of_mesh(mesh)
            }
            (Self::Tightest, Shape::Mesh(mesh)) => fit::tightest_of_mesh(mesh),
            (Self::Tightest, Shape::Hull(hull)) => fit::tightest(hull.vertices()),
            _ => None,
        };
        // A solid that cannot be fitted, because all its points coincide, is used unchanged.
        fitted.map_or_else(|| (shape.clone(), in_frame), |f| (f.shape, in_frame * f.in_frame))
    }
}
