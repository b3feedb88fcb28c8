//! 3DS, the format of 3D Studio: objects, their frames, hierarchy and animation.
//!
//! | chunk | content that is read |
//! | --- | --- |
//! | `0100` | master scale: all lengths are divided by it, as assimp does |
//! | `4000`, `4100`, `4110`, `4120` | objects with vertices and faces; materials, smoothing and mapping are ignored |
//! | `4160` | an object's local axes and origin |
//! | `B002` … `B007` | nodes: objects, dummies (`$$$DUMMY`), cameras, lights and their targets |
//! | `B010`, `B011`, `B030` | name, instance name, parent, number (default: counted from 0) |
//! | `B013` | pivot: the position of the node's origin in the object's frame |
//! | `B020` … `B022`, `B024` | tracks: position, left-handed rotation (from key to key, in the parent's frame), scale, roll |
//!
//! # Frames
//!
//! Vertices are stored in world coordinates at the time of saving; `4160` is the object's frame at that time. So a vertex
//! in the node's frame is `T(-pivot) · M⁻¹ · v`, and the node's frame in its parent's frame is `T(position) · R · S` of
//! the first keys. Scale is applied to the meshes, so that every frame of the tree is rigid and has its origin at the
//! pivot.
//!
//! A file without tracks is read in the form that assimp writes. Its vertices are in the object's frame, given by `4160`
//! with rows and columns exchanged. A node without a frame has the frame of the nearest object below it.
//!
//! A 3DS file states no unit: numbers are metres.

mod assemble;
mod camera_target;
mod chunk;
mod content;
mod keyframer;
mod object;
mod track;
mod writer;

use std::path::Path;

use crate::nodetree::NodeTree;
use crate::warning_list::WarningList;
use crate::{Diagnostic, input};

pub use writer::write;

/// Parses a 3DS file. `file` is named in messages, and its stem is the name of the tree.
///
/// # Errors
/// [`Diagnostic`] for another format, chunks longer than their parent, faces with missing vertices, or numbers that are
/// not finite.
///
/// ```
/// use elbowroom_formats::nodetree::{Node, NodeTree};
/// use elbowroom_formats::{MeshData, tds};
/// use elbowroom_spatial::{Pose, Vec3};
/// let mut tree = NodeTree::new("flag");
/// let pole = tree.push(Node::new("pole", None, Pose::IDENTITY));
/// let mut flag = Node::new("flag", Some(pole), Pose::from_xyz_rpy([0.0, 0.0, 2.0], [0.0; 3]));
/// let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Z];
/// flag.meshes.push(MeshData { name: "flag".into(), vertices, triangles: vec![[0, 1, 2]] });
/// tree.push(flag);
/// let bytes = tds::write(&tree, "flag.3ds".as_ref())?;
/// let again = tds::parse(&bytes, "flag.3ds".as_ref())?;
/// assert_eq!(again.nodes[1].meshes, tree.nodes[1].meshes);
/// assert_eq!(again.nodes[1].parent, Some(pole));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<NodeTree, Diagnostic> {
    input::check_content(bytes, file)?;
    let mut warnings = WarningList::default();
    let content = content::read(bytes, file, &mut warnings)?;
    let mut tree = assemble::tree(content, file, &mut warnings)?;
    tree.check_finite(file)?;
    tree.warnings = warnings.finish(file);
    Ok(tree)
}

/// Whether these bytes are the beginning of a 3DS file: its id with a plausible length.
pub(crate) fn is_header(bytes: &[u8]) -> bool {
    // `MM` also begins big-endian TIFF and some binary STL: the length or the first inner chunk must match too.
    bytes.len() >= 6 && bytes.starts_with(&[0x4d, 0x4d]) && {
        let length = u32::from_le_bytes([bytes[2], bytes[3], bytes[4], bytes[5]]) as usize;
        let inner = bytes.get(6..8).map(|b| u16::from_le_bytes([b[0], b[1]]));
        length == bytes.len() || matches!(inner, None | Some(0x0002 | 0x3d3d | 0xb000))
    }
}
