//! Continuous collision detection (CCD): the first time at which two moving shapes touch, proven for all times, not
//! sampled.
//!
//! [`time_of_impact`] accepts any two shapes and their motions: at rest (a [`Pose`](elbowroom_spatial::Pose)),
//! straight, about an axis or along a screw ([`ConstantTwist`]), or any [`RigidMotion`] that can bound its own
//! speed.
//!
//! - `None` means that the shapes are apart during the whole motion, including its ends; shapes never pass through
//!   thin plates unnoticed.
//! - `Some` means that they are within the tolerance at [`TimeOfImpact::time`] and were apart before.
//!
//! A contact is always reported; a pass within the tolerance may be reported as a contact.
//!
//! Method: conservative advancement (Mirtich, 1996). README.md in this folder derives the bounds.
//!
//! ```
//! use elbowroom_proximity::ccd::{CcdOptions, ConstantTwist, time_of_impact};
//! use elbowroom_proximity::{Cuboid, Shape, Sphere};
//! use elbowroom_spatial::{Pose, Vec3};
//! let bullet = Shape::Sphere(Sphere { radius: 0.004 });
//! let sheet = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.0005, 1.0, 1.0) });
//! let flight = ConstantTwist::linear(Pose::from_translation(Vec3::X * -3.0), Vec3::X * 8.0);
//! let hit = time_of_impact(&bullet, &flight, &sheet, &Pose::IDENTITY, &CcdOptions::default()).unwrap();
//! assert!((hit.time - 2.9955 / 8.0).abs() < 1e-4 / 8.0 && hit.separation <= 1e-4);
//! assert!((hit.normal.unwrap() + Vec3::X).length() < 1e-12); // from the sheet to the bullet
//! let past = ConstantTwist::linear(Pose::from_translation(Vec3::new(-3.0, 1.01, 0.0)), Vec3::X * 8.0);
//! assert!(time_of_impact(&bullet, &past, &sheet, &Pose::IDENTITY, &CcdOptions::default()).is_none());
//! ```

mod closing_bound;
mod conservative_advancement;
mod constant_twist;
mod enclosing_points;
mod options;
mod rigid_motion;
mod separating_slab;
mod time_of_impact;
mod time_to_collision;

pub use conservative_advancement::{time_of_impact, time_of_impact_with};
pub use constant_twist::ConstantTwist;
pub use options::CcdOptions;
pub use rigid_motion::RigidMotion;
pub use time_of_impact::TimeOfImpact;
pub use time_to_collision::{MovingShape, TimeToCollision, contact_free_fraction, time_to_collision};
