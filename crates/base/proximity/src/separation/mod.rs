//! The distance query: one file per method; `query.rs` chooses the method for each pair of shapes.

mod capsule;
mod continuous_witness;
mod convex;
pub(crate) mod core;
mod gap;
pub(crate) mod gjk;
mod goal;
mod half_space;
mod mesh_continuous_witness;
mod mesh_convex;
mod pair_order;
pub(crate) mod projections;
mod query;
mod result;
mod segment;
mod separating_axes;
mod settings;
mod sphere;
mod support_features;
mod tied_triangles;

pub(crate) use convex::convex;
pub(crate) use gap::rounding;
pub(crate) use mesh_convex::{nearest_on_mesh, nearest_on_mesh_within, nearest_to_cylinder};
pub use query::{collides, separation, separation_within, within};
pub use result::Separation;
pub(crate) use separating_axes::best_axis;
pub use settings::{DistanceSettings, WitnessPoints};
