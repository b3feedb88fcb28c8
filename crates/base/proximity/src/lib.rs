//! Shapes, and proximity queries between two of them.
//!
//! The queries are collision, distance, penetration, contact points and continuous collision detection.
//!
//! A [`Shape`] is given in its own frame and placed by a [`Pose`](elbowroom_spatial::Pose). All lengths are metres.
//!
//! # How do I …
//!
//! | | |
//! | --- | --- |
//! | get the separation distance, witness points and a proven lower bound | [`separation`] |
//! | stop at a security margin or limit | [`separation_within`], [`DistanceSettings::limit`] |
//! | test for collision, or for a tolerance | [`collides`], [`within`] |
//! | warm-start the distance of two meshes | [`DistanceSettings::warm_start`] with [`Workspace::separation`] |
//! | reuse memory between queries | [`Workspace`], one per thread |
//! | count the work of a query | [`Workspace::stats`] |
//! | get the penetration depth and direction | [`penetration`] |
//! | get a contact point, its triangle and normals | [`contact::contact_point`] |
//! | project a point onto a surface, get the signed distance | [`project_point`] |
//! | cast a ray: the first point of a surface on it | [`ray_cast`] |
//! | test whether a line of sight is free | [`intersects_segment`] |
//! | detect collisions of moving shapes (continuous collision detection, time of impact) | [`ccd::time_of_impact`] |
//! | bound the time to collision | [`ccd::time_to_collision`] |
//! | cull faces by motion | [`motion_culling::FaceCulling`] |
//! | use the BVH of a mesh: triangle pairs, upper and lower bounds, levels of detail | [`advanced`] |
//! | find pairs of many shapes (broad phase) | not here: `elbowroom_scene`; bounding boxes: [`Shape::aabb`] |
//! | weld, orient or split a mesh | [`repair`] |
//! | fit a sphere, capsule or box around points | [`fit`] |
//! | triangulate a shape | [`tessellate`] |
//!
//! # Supported pairs
//!
//! The method of each pair ("closed" means a formula or a finite exact method, error a few units in the last place):
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
//! The error for sizes of about 1 m, as checked by the tests: 1e-14 m for spheres and half-spaces, 2e-14 m for
//! capsules against primitives, 1e-12 m for boxes and hulls, 1e-11 m for cylinders. Every answer has its own bound:
//! `lower_bound <= exact <= distance`.
//!
//! Only [`penetration`] of hulls and meshes, [`fit`], [`tessellate`] and the construction of hulls and meshes
//! allocate. Nothing panics. A NaN, an infinity or a length of 1e150 m in a pose or a dimension counts as contact
//! (distance 0), because unknown must not count as free.
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
//!
//! **Invariant.** For valid shapes at any poses, the exact distance is never below the reported lower bound and
//! never above the reported distance. Input that is not finite is always a contact.

pub mod advanced;
mod bvh;
pub mod ccd;
pub mod contact;
pub mod fit;
mod lanes;
mod mesh_group;
mod mesh_mesh;
pub mod motion_culling;
mod penetration;
mod point_projection;
mod ray_cast;
pub mod repair;
mod separation;
mod shape;
pub mod surroundings;
pub mod tessellate;
mod triangle;
mod volume_model;
mod witness_patch;

pub use mesh_mesh::{QueryStats, WarmStart, Workspace};
pub use penetration::{Penetration, penetration};
pub use point_projection::{PointProjection, project_point};
pub use ray_cast::{RayHit, intersects_segment, ray_cast};
pub use separation::{DistanceSettings, Separation, WitnessPoints, collides, separation, separation_within, within};
pub use shape::{
    Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, HullError, MeshError, MeshReport, Shape, ShapeError, ShapeKind,
    Sphere, TriMesh,
};
pub use volume_model::VolumeModel;
