//! Readers and writers of files: robots, meshes, planning scenes, tables, images. Hostile input is refused here.
//!
//! | file | module | notes |
//! | --- | --- | --- |
//! | URDF, SRDF | [`robot`], [`urdf`], [`srdf`] | line numbers in every message; `package://` searched beside the file and upward; written too |
//! | 3DS, glTF, VRML as robots | [`robot`], [`nodetree`], [`joints`] | joints from tracks or from a file |
//! | STL | [`stl`] | binary and ASCII; written as binary |
//! | OBJ | [`obj`] | polygons, objects, groups |
//! | COLLADA | [`dae`] | units, up axis, nested and instanced nodes |
//! | glTF, GLB | [`gltf`] | node transforms, sparse accessors, strips and fans |
//! | PLY | [`ply`] | ASCII, both binary byte orders |
//! | OFF | [`off`] | ASCII |
//! | PCD | [`pcd`] | points; ASCII, binary, compressed |
//! | 3DS | [`tds`] | objects, hierarchy, pivots, tracks; written too |
//! | VRML 2 | [`vrml`] | transforms, `USE`, `Inline`, solids |
//! | joint states, trajectories | [`joint_states`] | CSV; columns in any order, errors with file and line |
//! | tables of numbers | [`number_table`] | CSV with a header |
//! | planning scenes | [`planning_scene`] | of `MoveIt`: `.scene` text and YAML |
//! | planning problems | [`problem_set`] | JSON in the layout of `MotionBenchMaker` |
//! | TOML | [`toml_tables`] | the line of every key and value; typed access |
//! | PNG | [`png`] | grey, RGB, alpha, palettes, 8 and 16 bits, interlaced; written too |
//! | PNM | [`pnm`] | PBM, PGM, PPM, in text and in bytes |
//!
//! All models are in metres and radians. A file either becomes a valid model, with a [`Diagnostic`] per warning, or is
//! refused with a [`Diagnostic`] that names the file, the line, the fault and what to write instead. Readers do not
//! recurse on the input and limit the number of instances. They compare counts with the remaining bytes before they
//! reserve memory.
//!
//! The readers of meshes are part of this crate instead of libraries: they keep double precision, line numbers for
//! messages, and one entry per object, and they check every count of a hostile file.
//!
//! ```
//! use elbowroom_formats::{mesh, robot};
//! # let dir = tempfile::tempdir()?;
//! # let (arm, plate) = (dir.path().join("arm.urdf"), dir.path().join("plate.off"));
//! # std::fs::write(&arm, r#"<robot name="slide"><link name="rail"/><link name="cart"/>
//! #   <joint name="x" type="prismatic"><parent link="rail"/><child link="cart"/>
//! #   <limit lower="0" upper="2" velocity="1" effort="0"/></joint></robot>"#)?;
//! # std::fs::write(&plate, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")?;
//! let loaded = robot::load(&arm, &robot::LoadOptions::default())?;
//! assert_eq!(loaded.robot.chain.dof(), 1);
//! for warning in &loaded.warnings {
//!     println!("{warning}");
//! }
//! assert_eq!(mesh::load(&plate, None)?.meshes[0].triangles.len(), 1);
//! // A count that the file cannot hold is refused before memory is reserved.
//! std::fs::write(&plate, "OFF\n4000000000 1 0\n0 0 0\n")?;
//! let error = mesh::load(&plate, None).unwrap_err();
//! assert!(error.to_string().contains("plate.off"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Invariant.** Whatever bytes a file has, reading it never panics and never reserves memory out of proportion to its
//! size. The result is always a valid model or a [`Diagnostic`].

mod affine;
mod csv;
mod cycles;
pub mod dae;
pub mod frame_files;
pub mod gltf;
pub mod image;
mod input;
pub mod joint_states;
pub mod joints;
mod location;
pub mod mesh;
mod mesh_data;
mod moveit_msgs;
mod names;
pub mod nodetree;
pub mod number_table;
pub mod obj;
pub mod off;
pub mod pcd;
pub mod planning_scene;
pub mod ply;
pub mod png;
mod png_stream;
pub mod pnm;
mod polygon;
pub mod problem_set;
pub mod recording;
mod resolve;
pub mod robot;
pub mod srdf;
pub mod stl;
pub mod suggest;
pub mod tds;
mod tokens;
pub mod toml_tables;
pub mod urdf;
pub mod vrml;
mod warning_list;
mod whole_file;
mod xml;
mod yaml;

pub use elbowroom_diagnostic::Diagnostic;
pub use input::{planning_scene_hint, read_file};
pub use joint_states::{JointStateOptions, JointStateRobot, JointStates};
pub use mesh::{LoadedMeshes, MeshData, unit_warning};
pub use nodetree::NodeTree;
pub use number_table::{NumberTable, TimedRow};
pub use png_stream::PngStream;
pub use robot::{LoadOptions, LoadedRobot};
pub use whole_file::WholeFile;
