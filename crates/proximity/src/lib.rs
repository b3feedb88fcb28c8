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
//! | where two surfaces meet: point, triangle, normals | [`contact`] |
//! | when two moving shapes first touch | [`impact`] |
//! | which faces a motion can bring into contact | [`facing`] |
//! | corners, sides and parts of a drawn mesh put right | [`repair`] |
//! | a simple shape around points | [`fit`] |
//! | triangles for a picture | [`tessellate`] |
//!
//! How each pair is answered ("closed" means a formula or a finite exact method, error a few units in the last place):
//!
//! | | sphere | capsule | cylinder | box | half-space | hull | mesh |
//! | --- | --- | --- | --- | --- | --- | --- | --- |
//! | sphere | closed | closed | closed | closed | closed | closed | closed per triangle |
//! | capsule | | closed | Newton | closed | closed | GJK | closed per triangle |
//! | cylinder | | | projections | projections | closed | GJK | projections per triangle |
//! | box | | | | projections | closed | GJK | projections per triangle |
//! | hull | | | | | closed | GJK | GJK per triangle |
//! | mesh | | | | | closed | | closed per triangle pair |
//!
//! Error for sizes of about 1 m, as the tests check it: 1e-14 m for spheres and half-spaces, 2e-14 m for capsules against
//! primitives, 1e-12 m for boxes and hulls, 1e-11 m for cylinders. It is also told per answer: `lower_bound <= exact <=
//! distance`. Nothing allocates but [`escape`] of hulls and meshes, [`fit`],
//! [`tessellate`] and the making of hulls and meshes. Nothing panics; a NaN, an infinity or a length of 1e150 m in a pose
//! or a dimension answers as contact (distance 0), because what is unknown must not read as free.
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

pub mod contact;
mod escape;
pub mod facing;
pub mod fit;
pub mod impact;
pub mod mesh;
mod patch;
mod project;
pub mod repair;
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
