//! 3DS, the files of 3D Studio: objects, their frames, and how they hang together and move.
//!
//! | chunk | what is read |
//! | --- | --- |
//! | `0100` | master scale: all lengths are divided by it, as assimp does |
//! | `4000`, `4100`, `4110`, `4120` | objects with vertices and faces; materials, smoothing and mapping are passed over |
//! | `4160` | an object's local axes and origin |
//! | `B002` … `B007` | nodes: objects, dummies (`$$$DUMMY`), cameras, lights and their targets |
//! | `B010`, `B011`, `B030` | name, instance name, parent, number; where no node has a number they count from 0 |
//! | `B013` | pivot: the point of the object's frame that the node's origin is put to |
//! | `B020`, `B021`, `B022`, `B024` | tracks of position, rotation (relative to the key before, in the parent's frame, against the right hand), scale, roll |
//!
//! # Frames
//!
//! Vertices stand in the file in world coordinates, as the object stood when it was saved; `4160` is the object's frame
//! at that moment. So a vertex in the node's frame is `T(-pivot) · M⁻¹ · v`, and the node's frame in its parent's is
//! `T(position) · R · S` of the first keys. Scale goes into the meshes, so that every frame of the tree is rigid and has
//! its origin at the pivot. A file without any track at all is taken as assimp writes it: vertices in the object's frame
//! instead, placed by a `4160` with rows for columns; nodes without a place of their own then stand where the nearest
//! object below them does.
//!
//! There is no unit in a 3DS file: numbers are taken as metres.

mod chunk;
mod keyframer;
mod look;
mod object;
mod place;
mod track;
mod write;

use std::path::Path;

use crate::error::Warnings;
use crate::nodetree::NodeTree;
use crate::{FormatError, source};

pub use write::write;

/// Parses a 3DS file; `file` is named in messages and gives the tree its name.
///
/// # Errors
/// A file that is none, chunks longer than what holds them, faces with corners that do not exist, numbers that are no
/// place.
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
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
pub fn parse(bytes: &[u8], file: &Path) -> Result<NodeTree, FormatError> {
    source::check_content(bytes, file)?;
    let mut warnings = Warnings::default();
    let scene = read(bytes, file, &mut warnings)?;
    let mut tree = place::tree(scene, file, &mut warnings)?;
    tree.check_finite(file)?;
    tree.warnings = warnings.finish(file);
    Ok(tree)
}

/// Whether these bytes begin a 3DS file: its number, and a length that is nothing else's.
pub(crate) fn is_header(bytes: &[u8]) -> bool {
    // Little-endian TIFF begins with II, binary STL with 80 bytes of text: `MM` and a length up to the end is ours.
    bytes.len() >= 6 && bytes.starts_with(&[0x4d, 0x4d]) && {
        let length = u32::from_le_bytes([bytes[2], bytes[3], bytes[4], bytes[5]]) as usize;
        let inner = bytes.get(6..8).map(|b| u16::from_le_bytes([b[0], b[1]]));
        length == bytes.len() || matches!(inner, None | Some(0x0002 | 0x3d3d | 0xb000))
    }
}

/// What stands in the file, before it is put together.
struct Scene {
    objects: Vec<object::Object>,
    nodes: Vec<keyframer::FileNode>,
    master_scale: f64,
}

fn read(bytes: &[u8], file: &Path, warnings: &mut Warnings) -> Result<Scene, FormatError> {
    let mut scene = Scene { objects: Vec::new(), nodes: Vec::new(), master_scale: 1.0 };
    let main = chunk::main(bytes, file)?;
    for part in main.children(file) {
        let part = part?;
        match part.id {
            0x3d3d => {
                for child in part.children(file) {
                    let child = child?;
                    match child.id {
                        0x4000 => scene.objects.extend(object::read(&child, file)?),
                        0x0100 => scene.master_scale = f64::from(child.cursor(file).f32()?),
                        _ => {}
                    }
                }
            }
            0xb000 => {
                for child in part.children(file) {
                    scene.nodes.extend(keyframer::read(&child?, file, warnings)?);
                }
            }
            _ => {}
        }
    }
    Ok(scene)
}
