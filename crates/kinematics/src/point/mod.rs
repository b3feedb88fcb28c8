//! Any point of a robot's surface as the end of a chain (S4.6).
//!
//! Where a robot touches something, or is about to, is seldom its tip. A [`PointChain`] makes the point the origin of
//! the last frame of a chain of its own: the joints between the root and the point's link, no others. It knows where the
//! point and its outward normal are ([`PointChain::place`]), how they answer to each joint ([`PointChain::jacobian`],
//! [`PointChain::jacobian_with_normal`]), and which joint values bring the point to a target, with the normal in a given
//! direction if wanted ([`PointChain::solve`], [`PointChain::refine`]). Nothing allocates but [`PointChain::new`]; to go
//! on with another point of the same link there is [`PointChain::set_point`]. The Denavit-Hartenberg table of the new chain
//! is [`Table::extract_to`](crate::dh::Table::extract_to) (or [`DirectTable::extract_to`](crate::dh::DirectTable::extract_to))
//! with the point as the translation of its last frame.
//!
//! | target | equations | what to expect |
//! | --- | --- | --- |
//! | the point's position | 3 | on links behind three joints or more: what is in reach and within the limits. Behind one or two joints the point has a circle or a surface to move on, and only targets on it are met |
//! | position and direction of the normal | 5: the turn about the normal stays free | behind five joints or more the same; behind fewer, targets that the chain can do |
//!
//! Targets are met by the damped least squares of [`crate::inverse`], on three or five equations (or on as many as there
//! are joints, where these are fewer). The first start is the given `q`, so that the answer is near it where it can
//! be; where a descent ends in a local minimum the next starts come from a fixed low-discrepancy sequence. The same
//! question always gets the same answer, every answer is within the joint limits, and where there is none the nearest
//! place found is left in `q` and the distance that remains is told.
//!
//! The error of a normal `n` against the wanted one `m` is the angle between them, as a vector of two components in the
//! tangent plane of `n`: `e = θ·(t₁·d, t₂·d)`, `d` the unit vector from `n` towards `m` perpendicular to `n`. Its row of
//! the Jacobian is `(t₁·ṅ, t₂·ṅ)` with `ṅ = ω × n`; the gradient of `θ²` by it is exact at any angle.
//!
//! ```
//! use elbowroom_kinematics::point::{Options, PointChain, SurfacePoint};
//! use elbowroom_kinematics::{Chain, JointKind, Limits, dh::ClassicalRow};
//! use elbowroom_spatial::Vec3;
//! use std::f64::consts::FRAC_PI_2;
//!
//! let row = |joint: &str, a: f64, alpha: f64| ClassicalRow {
//!     joint: joint.into(), kind: JointKind::Revolute, a, alpha, d: 0.0, theta: 0.0, limits: Limits::symmetric(2.8),
//! };
//! let arm = Chain::from_dh("arm", &[row("waist", 0.0, FRAC_PI_2), row("shoulder", 0.4, 0.0), row("elbow", 0.3, 0.0)])?;
//!
//! // A spot on the forearm, 10 cm before its end, looking along z of its link.
//! let forearm = arm.link("link_3").unwrap();
//! let mut spot = PointChain::new(&arm, forearm, Vec3::new(-0.1, 0.0, 0.05), Some(Vec3::Z), Options::default())?;
//! let there = spot.place(&[0.3, -0.4, 1.1]);
//!
//! let mut q = [0.0, 0.5, 0.5]; // where the arm is now
//! let reached = spot.solve(&SurfacePoint { normal_in_root: None, ..there }, &mut q)?;
//! assert!(reached.position_error_m <= 1e-9);
//! assert!(spot.place(&q).point_in_root.distance(there.point_in_root) <= 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod chain;
mod goal;
mod solve;

pub use chain::PointChain;
use elbowroom_spatial::Vec3;

/// A place of a surface, in the root link's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Where it is, m.
    pub point_in_root: Vec3,
    /// Where the surface looks to; unit length. `None` where that is not known, or in a target does not matter.
    pub normal_in_root: Option<Vec3>,
}

/// How hard to try.
///
/// A descent goes on to 1e-9 m and 1e-9 rad where it can; the tolerances say what is accepted where it cannot: to turn a
/// normal that lies along an axis but for the rounding of its mesh takes joint motions without measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Largest accepted distance from the target, m.
    pub position_tolerance_m: f64,
    /// Largest accepted angle between the normal and the wanted one, rad.
    pub angle_tolerance_rad: f64,
    /// Most starting points tried, the given `q` among them.
    pub starts: usize,
    /// Most steps from one starting point.
    pub iterations: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { position_tolerance_m: 1e-6, angle_tolerance_rad: 1e-6, starts: 100, iterations: 60 }
    }
}

/// The target is met: what remains, and what it took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// Distance from the target, m.
    pub position_error_m: f64,
    /// Angle between the normal and the wanted one, rad; 0 where none was wanted.
    pub angle_error_rad: f64,
    /// Starting points tried beyond the given `q`.
    pub restarts: usize,
}

/// Why there is no point chain, or no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointError {
    /// No such link.
    #[error("link {link} is not of this chain, whose links are 0 to {last}; take it from Chain::link")]
    UnknownLink {
        /// The index asked for.
        link: usize,
        /// The largest there is.
        last: usize,
    },
    /// The target was not met from any start; it may be out of reach, outside the limits, or just not found.
    #[error(
        "the point was not brought to the target from {starts} starts: the nearest is {position_error_m:.2e} m and {angle_error_rad:.2e} rad away; nearer targets, wider joint limits or more starts may help"
    )]
    NotReached {
        /// Distance that remains, m.
        position_error_m: f64,
        /// Angle that remains between the normals, rad.
        angle_error_rad: f64,
        /// Starting points tried.
        starts: usize,
    },
    /// Point, normal, target or `q` is no input.
    #[error("{0}")]
    BadInput(&'static str),
}
