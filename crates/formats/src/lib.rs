//! Files to models, and back. Hostile input ends here.
//!
//! | file | module | notes |
//! | --- | --- | --- |
//! | URDF, SRDF | [`robot`], [`urdf`], [`srdf`] | lines in every message; `package://` looked for beside the file and upward; written too |
//! | 3DS, glTF as robots | [`robot`], [`nodetree`], [`joints`] | joints from tracks or from a file |
//! | STL | [`stl`] | binary and ASCII; written as binary |
//! | OBJ | [`obj`] | polygons, objects, groups |
//! | COLLADA | [`dae`] | units, up axis, nested and instanced nodes |
//! | glTF, GLB | [`gltf`] | node transforms, sparse accessors, strips and fans |
//! | PLY | [`ply`] | ASCII, both binary byte orders |
//! | OFF | [`off`] | ASCII |
//! | 3DS | [`tds`] | objects, hierarchy, pivots, tracks; written too |
//!
//! Everything comes out in metres and radians. A file either becomes a sound model, with [`Warning`]s where its user
//! should know something, or a [`FormatError`] that names the file, the line, what is wrong and what to write
//! instead. No reader panics, recurses on the input, or allocates more than in proportion to the file: counts are
//! compared with the bytes that are there before anything is reserved, and instances are limited.
//!
//! The readers of meshes are ours and not libraries': they keep double precision, lines for messages, and one entry
//! per object, and they check every count of a hostile file.
//!
//! ```no_run
//! use elbowroom_formats::{mesh, robot};
//! let loaded = robot::load("arm.urdf".as_ref(), &robot::LoadOptions::default())?;
//! for warning in &loaded.warnings {
//!     eprintln!("{warning}");
//! }
//! let table = mesh::load("table.stl".as_ref(), None)?;
//! # Ok::<(), elbowroom_formats::FormatError>(())
//! ```

pub mod dae;
mod error;
pub mod gltf;
pub mod joints;
pub mod mesh;
mod names;
pub mod nodetree;
pub mod obj;
pub mod off;
pub mod ply;
mod polygon;
mod resolve;
pub mod robot;
mod scan;
mod source;
pub mod srdf;
pub mod stl;
pub mod tds;
mod transform;
pub mod urdf;
mod xml;

pub use error::{FormatError, Warning};
pub use mesh::{LoadedMeshes, MeshData, units_suspicion};
pub use nodetree::NodeTree;
pub use robot::{LoadOptions, LoadedRobot};
