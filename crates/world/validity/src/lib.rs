//! Validity of robot configurations and edges at vector speed: proven free, proven in collision, or not certain.
//!
//! A [`CoveredRobot`] encloses every link in a tree of spheres, built once from its shapes. A [`ValidityChecker`] moves sixteen
//! configurations at a time among the solids of an [`ObstacleSet`] and answers in three values ([`Validity`]): the outer spheres
//! prove that a configuration is free, inner spheres that it is in collision, and what neither proves is for an exact checker.
//! An edge is proven as a whole: between neighbouring configurations every sphere stays near its chord.

mod check;
mod cover;
mod cover_source;
mod error;
pub mod lanes;
mod model;
mod obstacles;
mod validity;

pub use check::{NotCertain, ValidityChecker};
pub use cover::{Ball, SphereCover};
pub use cover_source::{BuiltCovers, CoverSource, covers, describe_cover};
pub use error::ValidityError;
pub use model::{AxisCylinder, CoveredLinkId, CoveredRobot};
pub use obstacles::ObstacleSet;
pub use validity::Validity;
