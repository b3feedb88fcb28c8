//! The obstacle models of the joint-space paper for any robot: simpler solids that enclose an obstacle.

use std::f64::consts::PI;
use std::sync::Arc;

use elbowroom_proximity::{ConvexHull, Cuboid, Shape, Sphere, within};
use elbowroom_spatial::{Pose, Vec3};

use super::enclosure::Enclosure;
use super::sector_bounds::SectorBounds;
use crate::ObstacleModel;
use crate::sphere_lattice::SphereLattice;

/// Widest wedge of a slice, radians.
const MAX_WEDGE_RAD: f64 = PI / 12.0;

impl ObstacleModel {
    /// Computes solids of this model that together enclose an obstacle, placed in the world. `base` is the frame of the
    /// base axis: `box` is aligned with it, and `slices` are wedges about its z axis.
    ///
    /// Half spaces are returned unchanged.
    ///
    /// ```
    /// use elbowroom_cspace::ObstacleModel;
    /// use elbowroom_proximity::{Cuboid, Shape};
    /// use elbowroom_spatial::{Pose, Vec3};
    /// let beam = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 0.8, 0.1) });
    /// let beam_in_world = Pose::from_xyz_rpy([1.2, 0.0, 0.8], [0.0; 3]);
    /// let volume = |model: ObstacleModel| -> f64 {
    ///     model.solids(&beam, &beam_in_world, &Pose::IDENTITY).iter().map(|(shape, _)| shape.volume()).sum()
    /// };
    /// assert!(volume(ObstacleModel::Exact) < volume(ObstacleModel::Spheres(8)));
    /// assert!(volume(ObstacleModel::Spheres(8)) < volume(ObstacleModel::Sphere));
    /// ```
    pub fn solids(self, shape: &Shape, in_world: &Pose, base: &Pose) -> Vec<(Shape, Pose)> {
        let itself = || vec![(shape.clone(), *in_world)];
        if self == Self::Exact || matches!(shape, Shape::HalfSpace(_)) {
            return itself();
        }
        let in_base = base.inverse() * *in_world;
        let found = match self {
            Self::Exact => None,
            Self::Sphere => Some(vec![enclosing_sphere(shape)]),
            Self::Spheres(count) => Some(spheres(shape, count)),
            Self::Box => {
                let bounds = shape.aabb(&in_base);
                let cuboid = Shape::Cuboid(Cuboid { half_extents: bounds.extent() * 0.5 });
                return vec![(cuboid, *base * Pose::from_translation(bounds.center()))];
            }
            Self::Slices => {
                return wedges(shape, &in_base).map_or_else(itself, |w| w.into_iter().map(|s| (s, *base)).collect());
            }
        };
        found
            .map_or_else(itself, |f| f.into_iter().map(|(s, at)| (s, *in_world * Pose::from_translation(at))).collect())
    }
}

/// A sphere around the centre of a shape's bounding box, in the shape's frame.
fn enclosing_sphere(shape: &Shape) -> (Shape, Vec3) {
    if let Shape::Sphere(_) = shape {
        return (shape.clone(), Vec3::ZERO);
    }
    let center = shape.aabb(&Pose::IDENTITY).center();
    let radius = match Enclosure::new(shape, Pose::from_translation(-center)) {
        Some(e) => e.margin + e.points.iter().map(|p| p.length()).fold(0.0, f64::max),
        None => f64::INFINITY,
    };
    (Shape::Sphere(Sphere { radius: radius * (1.0 + 1e-12) }), center)
}

/// Spheres around the parts of the shape's bounding box that the shape intersects.
fn spheres(shape: &Shape, count: u32) -> Vec<(Shape, Vec3)> {
    if count <= 1 || matches!(shape, Shape::Sphere(_)) {
        return vec![enclosing_sphere(shape)];
    }
    let whole = shape.aabb(&Pose::IDENTITY);
    let mut parts = SphereLattice::new(whole.extent() * 0.5, count);
    parts.retain(|centre, half| {
        let part = Shape::Cuboid(Cuboid { half_extents: half });
        let at = Pose::from_translation(whole.center() + centre);
        // The tolerance ensures that no surface falls between two parts.
        within(&part, &at, shape, &Pose::IDENTITY, 1e-9 * half.length())
    });
    let ball = |(centre, radius): (Vec3, f64)| {
        (Shape::Sphere(Sphere { radius: radius * (1.0 + 1e-9) }), whole.center() + centre)
    };
    parts.spheres().into_iter().map(ball).collect()
}

/// Bounds of angle, radius and height about the base frame's z axis, as convex wedges; `None` if a wedge has no volume.
fn wedges(shape: &Shape, in_base: &Pose) -> Option<Vec<Shape>> {
    let SectorBounds { first, width, near, far, low, high } = SectorBounds::new(shape, in_base)?;
    let count = (width / MAX_WEDGE_RAD).ceil().max(1.0);
    let step = width / count;
    let outer = far / (0.5 * step).cos() * (1.0 + 1e-9);
    let wedge = |i: usize| {
        let ends = [first + step * i as f64, first + step * (i + 1) as f64];
        let corner = |a: f64, r: f64, z: f64| Vec3::new(r * a.cos(), r * a.sin(), z);
        let corners: Vec<Vec3> = ends
            .into_iter()
            .flat_map(|a| [near, outer].into_iter().flat_map(move |r| [low, high].map(|z| corner(a, r, z))))
            .collect();
        ConvexHull::from_points(&corners).ok().map(|hull| Shape::Hull(Arc::new(hull)))
    };
    (0..count as usize).map(wedge).collect()
}
