//! Validity of robot configurations and edges at vector speed: proven free, proven in collision, or not certain.
//!
//! A [`CoveredRobot`] encloses every link in a tree of spheres, built once from its shapes. A [`ValidityChecker`] moves
//! sixteen configurations at a time among the solids of an [`ObstacleSet`]. It has three answers ([`Validity`]): outer
//! spheres prove that a configuration is free, inner spheres prove that it is in collision, and an exact checker must
//! decide the rest. An edge is proven as a whole: between neighbouring configurations every sphere stays near its chord.
//!
//! ```
//! use elbowroom_proximity::{Shape, Sphere};
//! use elbowroom_spatial::{Pose, Vec3};
//! use elbowroom_validity::{CoveredRobot, ObstacleSet, Validity, ValidityChecker};
//! let arm = CoveredRobot::new(&elbowroom_robot::example::arm()?, Pose::IDENTITY)?;
//! let mut obstacles = ObstacleSet::default();
//! obstacles.add_shape(&Shape::Sphere(Sphere { radius: 0.25 }), &Pose::from_translation(Vec3::Z), 0.0);
//! let mut checker = ValidityChecker::new(&arm, &obstacles);
//! // Upright the forearm is in the ball; lowered to the side the arm is below it.
//! let (upright, left, right) = ([0.0; 3], [0.5, 1.5, 0.0], [-0.5, 1.5, 0.0]);
//! assert_eq!(checker.state(&upright)?, Validity::Hit);
//! assert_eq!(checker.state(&left)?, Validity::Free);
//! assert_eq!(checker.state(&[f64::NAN, 1.5, 0.0])?, Validity::Uncertain);
//! assert!(checker.edge_is_free(&left, &right)?);
//! assert!(!checker.edge_is_free(&left, &upright)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** If the robot and the obstacles are at their stated poses, [`Validity::Free`] never collides and
//! [`Validity::Hit`] always does. Numbers that prove nothing, including NaN, are always [`Validity::Uncertain`].

mod check;
mod cover;
mod cover_source;
mod error;
pub mod lanes;
mod model;
mod obstacles;
mod validity;

pub use check::{EDGES_AT_ONCE, NotCertain, ValidityChecker};
pub use cover::{Ball, SphereCover};
pub use cover_source::{BuiltCovers, CoverSource, covers, describe_cover};
pub use error::ValidityError;
pub use model::{AxisCylinder, CoveredLinkId, CoveredRobot};
pub use obstacles::ObstacleSet;
pub use validity::Validity;
