//! A person guides the arm: the tool follows a hand controller, glides along surfaces and never enters them.
//!
//! | | |
//! | --- | --- |
//! | [`SurfaceNavigator`] | one tick: moves a tool towards a desired pose, around [`ProtectedSurface`]s |
//! | [`GuidedArm`] | moves a whole arm with its tool; the arm never touches anything |
//! | [`NavigatorSettings`] | gap, speed, acceleration |
//! | [`Guide`] | keeps the hand on a line, in a plane, in a cone or in a tube, or the shaft at a point of entry |
//! | [`force`] | a tool with a mass, fields that repel it, and what the hand feels |
//! | [`generate_shield`] | a surface that protects a solid and is opened along a target |
//! | [`project_onto_constraints`] | the admissible velocity nearest to a desired one, or displacement |
//!
//! The method is that of the god-object of haptics (Zilles and Salisbury, 1995; Ortega, Redon and Coquillart, 2007)
//! with velocity dampers (Faverjon and Tournassoud, 1987) for every local minimum of the distance, so that the velocity
//! is continuous in valleys too. README.md in this folder derives the bounds.
//!
//! A monitor of interference regions scales the motion afterwards and never depends on this crate.
//!
//! ```
//! use elbowroom_proximity::{Cuboid, Shape, contact::triangle_surface};
//! use elbowroom_shared_control::{NavigatorSettings, ProtectedSurface, SurfaceNavigator};
//! use elbowroom_spatial::{Pose, Vec3};
//! let solid = |size: Vec3| triangle_surface(&Shape::Cuboid(Cuboid { half_extents: size * 0.5 }), 1e-4).unwrap();
//! let (tool, table) = (solid(Vec3::splat(0.02)), solid(Vec3::new(1.0, 1.0, 0.1)));
//! let table = ProtectedSurface::new(table, Pose::from_translation(Vec3::Z * -0.05))?;
//! let start = Pose::from_translation(Vec3::Z * 0.05);
//! let mut navigator = SurfaceNavigator::new(tool, vec![table], start, NavigatorSettings::default())?;
//! // The hand pushes into the table and to the side: the tool glides along the table.
//! let desired = Pose::from_translation(Vec3::new(0.1, 0.0, -0.1));
//! for _ in 0..2000 {
//!     navigator.step(&desired, 0.001);
//! }
//! let tool = navigator.tool_in_world().translation;
//! assert!((tool - Vec3::new(0.1, 0.0, 0.0105)).length() < 1e-4);
//! # Ok::<(), elbowroom_shared_control::NavigatorError>(())
//! ```
//!
//! **Invariant.** After every step, and at all times between two steps, the distance between the tool and every
//! protected surface is at least [`NavigatorSettings::least_gap_m`], whatever the desired pose.

mod constraint_projection;
mod constraint_set;
mod error;
pub mod force;
mod guide;
mod guided_arm;
mod navigation_step;
mod navigator_settings;
mod protected_surface;
mod remote_center;
mod shield;
mod surface_clearance;
mod surface_navigator;

pub use constraint_projection::{Contradiction, LinearConstraint, project_onto_constraints};
pub use error::NavigatorError;
pub use guide::Guide;
pub use guided_arm::{ArmLimit, GuidedArm, GuidedStep};
pub use navigation_step::{Limit, NavigationStep};
pub use navigator_settings::NavigatorSettings;
pub use protected_surface::ProtectedSurface;
pub use remote_center::RemoteCenter;
pub use shield::{Passage, Shield, ShieldError, ShieldSettings, ShieldTarget, generate_shield, line_on_surface};
pub use surface_navigator::SurfaceNavigator;
