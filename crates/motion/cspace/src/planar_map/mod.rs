//! The map of a planar arm: blocked intervals of θ3, row by row, in the arm's plane. Fast and conservative.
//!
//! For one θ1 the arm moves in a plane. A cell is blocked if any configuration in its box touches the obstacle. The
//! builder applies the three half widths of the box one after the other:
//!
//! 1. θ1 sweeps the plane through a wedge. The obstacle, grown by a link's radius and cut by the wedge, projects to a
//!    convex outline in the plane: the link's axis meets it if and only if the link touches for some θ1 of the cell.
//! 2. θ2 rotates the whole arm about the shoulder: instead, the outline is rotated about the shoulder, to both sides.
//! 3. θ3 at fixed θ2 rotates the forearm about the elbow: the angles at which the forearm meets the outline form one
//!    interval, the angles of the wrist's sphere one or more arcs; cells that an interval touches are blocked.
//!
//! The upper arm blocks whole rows. The half plane behind the base axis (`r < 0`) is a second wedge, opposite to the
//! first one.
//!
//! | file | contents |
//! | --- | --- |
//! | `builder.rs` | [`PlanarMapBuilder`]: one obstacle, all planes |
//! | `sphere.rs` | spheres: outlines are disks |
//! | `convex.rs`, `context.rs` | boxes and convex polyhedra: outlines plane by plane |
//! | `plane_solid.rs`, `wedge_support.rs` | support functions of solids in one plane, and of the part inside the wedge |
//! | `normals.rs`, `outline.rs`, `half_planes.rs` | convex outlines as lines in given directions |
//! | `rows.rs`, `row_culling.rs`, `forearm.rs`, `wrist.rs` | from outlines to the intervals of sixteen rows |
//! | `span_writer.rs`, `arc_intervals.rs`, `upper_arm.rs` | from intervals to spans of cells |
//! | `simd_math.rs`, `precision.rs` | vector arithmetic and its margins |
//!
//! Each function that calls `dispatch!` is a kernel: its body is compiled once per instruction set. Kernels are few and
//! contain only loops over vectors; all other code is compiled once.

#![allow(
    clippy::inline_always,
    reason = "code that is not inlined into a dispatched kernel is compiled without its instruction set"
)]

mod arc_intervals;
mod arm_grid;
mod builder;
mod context;
mod convex;
mod corner_tests;
mod forearm;
mod half_planes;
mod line_distances;
mod normals;
mod outline;
mod plane_solid;
mod precision;
#[cfg(test)]
mod precision_audit;
mod row_culling;
mod rows;
pub(crate) mod simd_math;
mod span_writer;
mod sphere;
mod upper_arm;
mod wedge_support;
mod wrist;

pub use builder::{PlanarMapBuilder, PlanarMapError};
