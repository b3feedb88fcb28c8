//! Closed solids from code: outlines, and lathe, extrusion and loft of them.
//!
//! Lengths are metres. Every generator returns one closed part, its triangles counter-clockwise seen from outside.

mod extrude;
mod lathe;
mod loft;
mod mesh;
pub mod outline;
mod stl;

pub use extrude::extrude;
pub use lathe::{lathe, ring};
pub use loft::loft;
pub use mesh::Mesh;
pub use stl::binary_stl;

use elbowroom_spatial::Pose;
use std::f64::consts::FRAC_PI_2;

/// The frame at `at` whose z axis points along the parent's x; y stays y.
pub fn along_x(at: [f64; 3]) -> Pose {
    Pose::from_xyz_rpy(at, [0.0, FRAC_PI_2, 0.0])
}

/// The frame at `at` whose z axis points along the parent's −x; y stays y.
pub fn along_minus_x(at: [f64; 3]) -> Pose {
    Pose::from_xyz_rpy(at, [0.0, -FRAC_PI_2, 0.0])
}

/// The frame at `at` whose z axis points along the parent's y; x stays x.
pub fn along_y(at: [f64; 3]) -> Pose {
    Pose::from_xyz_rpy(at, [-FRAC_PI_2, 0.0, 0.0])
}

/// The frame at `at` whose z axis points along the parent's −y; x stays x, and y is the parent's z.
pub fn along_minus_y(at: [f64; 3]) -> Pose {
    Pose::from_xyz_rpy(at, [FRAC_PI_2, 0.0, 0.0])
}

/// The frame at `at` with the parent's axes.
pub fn upright(at: [f64; 3]) -> Pose {
    Pose::from_xyz_rpy(at, [0.0; 3])
}
