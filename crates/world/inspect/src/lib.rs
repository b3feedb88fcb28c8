//! Contents of a robot model or mesh file.
//!
//! An inspection lists joints and limits, meshes and their faults, DH tables, resolution levels, the allowed collision
//! matrix, and suspected unit errors. It needs no cell. `elbowroom_report` renders the images.
//!
//! ```
//! use elbowroom_inspect::{InspectOptions, Inspection};
//! # let dir = tempfile::tempdir()?;
//! # let path = dir.path().join("slide.urdf");
//! # std::fs::write(&path, r#"<robot name="slide"><link name="rail"/><link name="cart"/>
//! #   <joint name="x" type="prismatic"><parent link="rail"/><child link="cart"/>
//! #   <limit lower="0" upper="2" velocity="1" effort="0"/></joint></robot>"#)?;
//! let inspection = Inspection::of(&path, &InspectOptions::default())?;
//! assert_eq!(inspection.links, ["rail", "cart"]);
//! assert!(inspection.dh.residual.unwrap() < 1e-12);
//! println!("{inspection}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** Whatever looks wrong in a model (units, open meshes, links that touch), an inspection only reports it:
//! it never repairs the model and never changes the file.

mod box_levels;
mod deviation;
mod dh;
mod dh_tables;
mod edges;
mod enclosing_volume;
mod inspection;
mod pairs;
mod pose_solutions;
mod protrusion;
mod quadric;
mod resolution_levels;
mod rows;
mod simplify;
mod surface_point;
mod table;
mod text;
mod units;

pub use box_levels::{BoxLevel, box_levels};
pub use dh::{ClassicalDh, DhConvention, DhRow, DhRow4, DirectDh, DirectRow, ModifiedDh};
pub use dh_tables::DhTables;
pub use enclosing_volume::EnclosingVolume;
pub use inspection::{InspectOptions, Inspection, ModelKind, srdf};
pub use pairs::{PairRow, ReasonKind};
pub use pose_solutions::{PoseSolution, PoseSolutions};
pub use resolution_levels::{BoxRow, CapsuleRow, HullRow, LinkLevels, ObbRow, TrianglesRow};
pub use rows::{JointRow, MeshRow};
pub use surface_point::SurfacePoint;
pub use units::{SuspectQuantity, SuspectUnit, UnitLabel, suspect_units};
