//! A shape of any kind.

use std::fmt;
use std::sync::Arc;

use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::{Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Sphere, TriMesh, hull};

/// A solid in its own frame.
///
/// ```
/// use elbowroom_proximity::{Cylinder, Shape};
/// use elbowroom_spatial::{Pose, Vec3};
/// let column = Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.15 });
/// let bounds = column.aabb(&Pose::from_translation(Vec3::new(0.9, 0.0, 0.6)));
/// assert!((bounds.min - Vec3::new(0.75, -0.15, 0.0)).length() < 1e-15);
/// assert!(Shape::Cylinder(Cylinder { half_length: 0.6, radius: -1.0 }).validate().is_err());
/// ```
#[derive(Debug, Clone)]
pub enum Shape {
    /// A ball.
    Sphere(Sphere),
    /// A segment with a radius.
    Capsule(Capsule),
    /// A cylinder with flat ends.
    Cylinder(Cylinder),
    /// A box.
    Cuboid(Cuboid),
    /// The half-space below a plane.
    HalfSpace(HalfSpace),
    /// A convex polyhedron.
    Hull(Arc<ConvexHull>),
    /// A triangle mesh, which is solid if it is closed.
    Mesh(Arc<TriMesh>),
}

/// Kind of a [`Shape`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ShapeKind {
    /// [`Shape::Sphere`].
    Sphere,
    /// [`Shape::Capsule`].
    Capsule,
    /// [`Shape::Cylinder`].
    Cylinder,
    /// [`Shape::Cuboid`].
    Cuboid,
    /// [`Shape::HalfSpace`].
    HalfSpace,
    /// [`Shape::Hull`].
    Hull,
    /// [`Shape::Mesh`].
    Mesh,
}

impl ShapeKind {
    /// The word for messages: `sphere`, `capsule`, `cylinder`, `box`, `plane`, `hull`, `mesh`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Capsule => "capsule",
            Self::Cylinder => "cylinder",
            Self::Cuboid => "box",
            Self::HalfSpace => "plane",
            Self::Hull => "hull",
            Self::Mesh => "mesh",
        }
    }
}

impl fmt::Display for ShapeKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Why a shape cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A dimension is negative, NaN or infinite.
    #[error("{shape}: {dimension} is {value}, it must be a finite number of metres, 0 or more")]
    Dimension {
        /// Kind of shape.
        shape: ShapeKind,
        /// Name of the dimension.
        dimension: &'static str,
        /// Value of the dimension, metres.
        value: f64,
    },
}

impl Shape {
    /// The kind of the shape.
    pub fn kind(&self) -> ShapeKind {
        match self {
            Self::Sphere(_) => ShapeKind::Sphere,
            Self::Capsule(_) => ShapeKind::Capsule,
            Self::Cylinder(_) => ShapeKind::Cylinder,
            Self::Cuboid(_) => ShapeKind::Cuboid,
            Self::HalfSpace(_) => ShapeKind::HalfSpace,
            Self::Hull(_) => ShapeKind::Hull,
            Self::Mesh(_) => ShapeKind::Mesh,
        }
    }

    /// The smallest axis-aligned box in the world around the shape. For a half-space the box is unbounded, except along
    /// a normal that is parallel to an axis.
    pub fn aabb(&self, in_world: &Pose) -> Aabb {
        let r = in_world.rotation;
        let around = |half: Vec3| Aabb::from_center(in_world.translation, half);
        match self {
            Self::Sphere(s) => around(Vec3::splat(s.radius)),
            Self::Capsule(c) => around(r.z_axis().abs() * c.half_length + Vec3::splat(c.radius)),
            Self::Cylinder(c) => around(cylinder_half_extents(c, r.z_axis())),
            Self::Cuboid(c) => around(r.abs_mul(c.half_extents)),
            Self::HalfSpace(_) => half_space_aabb(in_world),
            Self::Hull(h) => Aabb::from_points(h.vertices().iter().map(|&v| in_world.transform_point(v))),
            Self::Mesh(m) => m.aabb().transformed(in_world),
        }
    }

    /// The support point: the point farthest along `dir`, both in the local frame. For a mesh it is the support point of
    /// its convex hull. A half-space has a support point only along its normal; for other directions its origin is
    /// returned.
    pub fn support(&self, dir: Vec3) -> Vec3 {
        match self {
            Self::Sphere(s) => s.support(dir),
            Self::Capsule(c) => c.support(dir),
            Self::Cylinder(c) => c.support(dir),
            Self::Cuboid(c) => c.support(dir),
            Self::HalfSpace(_) => Vec3::ZERO,
            Self::Hull(h) => h.support(dir),
            Self::Mesh(m) => hull::farthest(m.vertices(), dir),
        }
    }

    /// Volume in cubic metres: 0 for an open mesh, infinite for a half-space.
    pub fn volume(&self) -> f64 {
        match self {
            Self::Sphere(s) => s.volume(),
            Self::Capsule(c) => c.volume(),
            Self::Cylinder(c) => c.volume(),
            Self::Cuboid(c) => c.volume(),
            Self::HalfSpace(_) => f64::INFINITY,
            Self::Hull(h) => h.volume(),
            Self::Mesh(m) => m.report().volume,
        }
    }

    /// Checks the dimensions. Hulls and meshes are checked when they are created.
    ///
    /// # Errors
    /// [`ShapeError`] if a dimension is negative or not finite.
    pub fn validate(&self) -> Result<(), ShapeError> {
        let (list, used) = self.dimensions();
        for &(dimension, value) in &list[..used] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(ShapeError::Dimension { shape: self.kind(), dimension, value });
            }
        }
        Ok(())
    }

    fn dimensions(&self) -> ([(&'static str, f64); 3], usize) {
        let none = ("", 0.0);
        match self {
            Self::Sphere(s) => ([("radius", s.radius), none, none], 1),
            Self::Capsule(Capsule { half_length, radius }) | Self::Cylinder(Cylinder { half_length, radius }) => {
                ([("half_length", *half_length), ("radius", *radius), none], 2)
            }
            Self::Cuboid(c) => {
                let h = c.half_extents;
                ([("half_extents.x", h.x), ("half_extents.y", h.y), ("half_extents.z", h.z)], 3)
            }
            Self::HalfSpace(_) | Self::Hull(_) | Self::Mesh(_) => ([none; 3], 0),
        }
    }
}

fn cylinder_half_extents(c: &Cylinder, axis: Vec3) -> Vec3 {
    let rim = |a: f64| (1.0 - a * a).max(0.0).sqrt() * c.radius + a.abs() * c.half_length;
    Vec3::new(rim(axis.x), rim(axis.y), rim(axis.z))
}

fn half_space_aabb(in_world: &Pose) -> Aabb {
    let (normal, origin) = (in_world.rotation.z_axis(), in_world.translation);
    let bound = |n: f64, o: f64| match n {
        1.0 => (f64::NEG_INFINITY, o),
        -1.0 => (o, f64::INFINITY),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    };
    let (x, y, z) = (bound(normal.x, origin.x), bound(normal.y, origin.y), bound(normal.z, origin.z));
    Aabb { min: Vec3::new(x.0, y.0, z.0), max: Vec3::new(x.1, y.1, z.1) }
}
