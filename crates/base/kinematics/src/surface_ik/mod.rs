//! Inverse kinematics of any point of a robot's surface, which is the end of the chain in Reichenbach and Kovačić
//! 2003.
//!
//! The point of a robot that touches something is seldom its tip. A [`PointChain`] makes the point the origin of the
//! last frame of its own chain, which has only the joints between the root and the point's link. It computes:
//!
//! - the point and its outward normal ([`PointChain::place`]);
//! - their Jacobians ([`PointChain::jacobian`], [`PointChain::jacobian_with_normal`]);
//! - joint values that bring the point to a target, with the normal in a given direction if required
//!   ([`PointChain::solve`], [`PointChain::refine`]).
//!
//! Only [`PointChain::new`] allocates; [`PointChain::set_point`] changes to another point of the same link. The
//! Denavit-Hartenberg table of the new chain is
//! [`GeneralizedTable::extract_to`](crate::dh::GeneralizedTable::extract_to) (or
//! [`DirectTable::extract_to`](crate::dh::DirectTable::extract_to)) with the point as the translation of its last
//! frame.
//!
//! | target | equations | result |
//! | --- | --- | --- |
//! | the point's position | 3 | on links behind three joints or more: met where it is in reach and within the limits. Behind one or two joints the point moves on a circle or a surface, and only targets on it are met |
//! | position and direction of the normal | 5: the turn about the normal stays free | behind five joints or more the same; behind fewer, only targets within the chain's freedom are met |
//!
//! Targets are met by the damped least squares of [`crate::inverse`], on three or five equations (on as many as
//! there are joints, if these are fewer). The first start is the given `q`, so that the solution is near it if
//! possible. If a search ends in a local minimum, the next starts come from a fixed low-discrepancy sequence. The
//! same input always gives the same answer, and every solution is within the joint limits. If no solution is found,
//! `q` is set to the nearest configuration found, and the error returns the remaining distance.
//!
//! The error of a normal `n` against the required normal `m` is the angle between them, as a vector of two
//! components in the tangent plane of `n`: `e = θ·(t₁·d, t₂·d)`, where `d` is the unit vector from `n` towards `m`
//! perpendicular to `n`. Its row of the Jacobian is `(t₁·ṅ, t₂·ṅ)` with `ṅ = ω × n`; the gradient of `θ²` from it is
//! exact at any angle.
//!
//! ```
//! use elbowroom_kinematics::surface_ik::{OrientedPoint, PointChain, SurfaceIkOptions};
//! use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
//! use elbowroom_spatial::Vec3;
//! use std::f64::consts::FRAC_PI_2;
//!
//! let row = |joint: &str, a: f64, alpha: f64| ClassicalRow {
//!     joint: joint.into(), kind: JointKind::Revolute, a, alpha, d: 0.0, theta: 0.0, limits: Limits::symmetric(2.8),
//! };
//! let arm = Chain::from_dh("arm", &[row("waist", 0.0, FRAC_PI_2), row("shoulder", 0.4, 0.0), row("elbow", 0.3, 0.0)])?;
//!
//! // A point on the forearm, 10 cm before its end, with its normal along z of its link.
//! let forearm = arm.link("link_3").unwrap();
//! let options = SurfaceIkOptions::default();
//! let mut point = PointChain::new(&arm, forearm, Vec3::new(-0.1, 0.0, 0.05), Some(Vec3::Z), options)?;
//! let target = point.place(&[0.3, -0.4, 1.1]);
//!
//! let mut q = [0.0, 0.5, 0.5]; // the present configuration
//! let solution = point.solve(&OrientedPoint { normal_in_root: None, ..target }, &mut q)?;
//! assert!(solution.position_error_m <= 1e-9);
//! assert!(point.place(&q).point_in_root.distance(target.point_in_root) <= 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod goal;
mod options;
mod oriented_point;
mod point_chain;
mod solve;

pub use error::PointError;
pub use options::{SurfaceIkOptions, SurfaceIkSolution};
pub use oriented_point::OrientedPoint;
pub use point_chain::PointChain;
