//! Why a shield could not be generated.

use elbowroom_spatial::Vec3;

use crate::NavigatorError;

/// Why a shield was refused.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ShieldError {
    /// The protected mesh bounds no solid, or a number is not usable.
    #[error(transparent)]
    Surface(#[from] NavigatorError),
    /// A point of the target is not on the surface.
    #[error("point {number} of the target, {point:?} m, is {:.3} mm off the surface; at most {:.3} mm are allowed", distance_m * 1e3, tolerance_m * 1e3)]
    OffSurface {
        /// Number of the point, from 1.
        number: usize,
        /// The point, in the frame of the mesh.
        point: Vec3,
        /// Its distance from the surface, metres.
        distance_m: f64,
        /// The allowed distance, metres.
        tolerance_m: f64,
    },
    /// The target crosses a gap of the surface, or leaves it over an edge.
    #[error("the target leaves the surface at {place:?} m, between its points {number} and {}; add points where it turns", number + 1)]
    LeavesSurface {
        /// Number of the point before, from 1.
        number: usize,
        /// Where, in the frame of the mesh.
        place: Vec3,
    },
    /// The target has too few points.
    #[error("the target needs at least {needed} points")]
    TooFewPoints {
        /// The least number.
        needed: usize,
    },
    /// The axis of a drill does not lead into the solid.
    #[error("the axis of the drill is {:.0}° off the direction into the solid, at most 75° are allowed", angle_rad.to_degrees())]
    DrillAxis {
        /// Angle between the axis and the direction into the solid, rad.
        angle_rad: f64,
    },
    /// The opening is so narrow beside its length that too many points are needed.
    #[error("the target is too large beside the width of its opening; choose a larger `width` or `tolerance`")]
    TooManyFeet,
    /// The opening swallows the whole solid, so nothing is left to protect.
    #[error("the opening swallows everything that is to be protected")]
    NothingLeft,
    /// The generated surface is not closed.
    #[error("the shield is not closed; choose another `tolerance`")]
    NotClosed,
    /// No part of the surface is inside the target.
    #[error("no part of the surface is inside the target")]
    EmptyArea,
    /// The tolerance asks for more triangles than are useful.
    #[error("a tolerance of {:.3} mm needs about {triangles} triangles, at most {} are allowed; choose a larger one", tolerance_m * 1e3, Self::MOST_TRIANGLES)]
    TooFine {
        /// The tolerance, metres.
        tolerance_m: f64,
        /// The estimated number.
        triangles: usize,
    },
}

impl ShieldError {
    /// Most triangles of a shield.
    pub const MOST_TRIANGLES: usize = 4_000_000;
}
