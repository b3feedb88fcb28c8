//! Shapes and the questions between two of them: do they collide, how far apart are they, which way out.
//!
//! A [`Shape`] lies in its own frame and is placed by a [`Pose`](elbowroom_spatial::Pose). All lengths are metres.
//!
//! | question | function |
//! | --- | --- |
//! | distance, with witness points and a proven lower bound | [`separation`], [`separation_within`] |
//! | yes or no | [`collides`], [`within`] |
//! | nearest surface point, signed distance | [`project_point`] |
//! | how far and which way to separate | [`escape`] |
//! | a simple shape around points | [`fit`] |
//! | triangles for a picture | [`tessellate`] |
//!
//! How each pair is answered ("closed" means a formula or a finite exact method, error a few units in the last place):
//!
//! | | sphere | capsule | cylinder | box | half-space | hull | mesh |
//! | --- | --- | --- | --- | --- | --- | --- | --- |
//! | sphere | closed | closed | closed | closed | closed | closed | closed per triangle |
//! | capsule | | closed | Newton, 1e-13 | closed | closed | GJK | closed per triangle |
//! | cylinder | | | GJK | GJK | closed | GJK | GJK per triangle |
//! | box | | | | SAT + GJK | closed | GJK | GJK per triangle |
//! | hull | | | | | closed | GJK | GJK per triangle |
//! | mesh | | | | | closed | | closed per triangle pair |
//!
//! GJK's error is proven per answer: `lower_bound <= exact <= distance`. Nothing allocates but [`escape`], [`fit`],
//! [`tessellate`] and the making of hulls and meshes. Nothing panics; a NaN or an infinity in a pose or a dimension
//! answers as contact (distance 0), because what is unknown must not read as free.
//!
//! ```
//! use elbowroom_proximity::{Capsule, Cylinder, Shape, separation};
//! use elbowroom_spatial::{Pose, Vec3};
//! let forearm = Shape::Capsule(Capsule { half_length: 0.2, radius: 0.06 });
//! let column = Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.15 });
//! let forearm_in_world = Pose::from_translation(Vec3::new(1.5, 0.0, 0.6));
//! let column_in_world = Pose::from_translation(Vec3::new(0.9, 0.0, 0.6));
//! let gap = separation(&forearm, &forearm_in_world, &column, &column_in_world);
//! assert!((gap.distance - (0.6 - 0.06 - 0.15)).abs() < 1e-15);
//! ```

mod escape;
pub mod fit;
mod project;
mod separation;
mod shape;
pub mod tessellate;
mod triangle;

pub use escape::{Escape, escape};
pub use project::{SurfacePoint, project_point};
pub use separation::{Separation, collides, separation, separation_within, within};
pub use shape::{
    Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, HullError, MeshError, MeshReport, Shape, ShapeError, Sphere,
    TriMesh,
};
