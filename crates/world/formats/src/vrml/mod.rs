//! VRML 2 (VRML97, ISO/IEC 14772-1): the triangles of the scene, or the tree of its nodes.
//!
//! Numbers are metres, and the frame of the file is kept: VRML defines +y as up, and nothing is rotated. Every `Transform`
//! and `Inline` is a node of the tree, and so is a `Group` with a name; a node has the name after its `DEF`.
//!
//! | nodes | what is read |
//! | --- | --- |
//! | `Transform` | translation, rotation, scale, scaleOrientation, center |
//! | `Group`, `Anchor`, `Billboard`, `Collision` | all children; the `proxy` of a `Collision` if it has none |
//! | `Switch` | the child of `whichChoice`; a warning if it shows none |
//! | `LOD` | the first level, which is the finest |
//! | `Inline` | a file below the folder of the file that names it; a missing one is an error |
//! | `IndexedFaceSet`, `ElevationGrid` | polygons as triangles |
//! | `Box` | exact |
//! | `Sphere`, `Cylinder`, `Cone` | enclosed by triangles, at most 0.1 mm outside, or 0.1 % of the radius if that is more |
//! | `IndexedLineSet`, `PointSet`, `Text` | nothing, with a warning: they have no surface |
//! | `Script`, `ROUTE` | nothing, with a warning: every node stays at rest |
//! | `PROTO`, `EXTERNPROTO` | nothing, with a warning; a node of a prototype where a surface may be is an error |
//!
//! Lights, sensors, sounds, viewpoints and appearances are skipped. Nodes and fields that the standard does not have are
//! skipped with a warning if they hold no surface, and refused if they do; so is `Extrusion`. VRML 1.0 is refused.

mod document;
mod encoding;
mod face_set;
mod inline;
mod lexer;
mod node_kinds;
mod parser;
mod scene;
mod shapes;
mod solids;
mod values;

use std::path::Path;

use elbowroom_spatial::Pose;

use crate::mesh_data::LoadedMeshes;
use crate::nodetree::{Node, NodeTree};
use crate::{Diagnostic, input};
use scene::SceneReader;

pub(crate) use encoding::is_header;

/// Parses a VRML 2 file. Files that it inlines are relative to `file`.
///
/// # Errors
/// [`Diagnostic`] for another version, text that is not VRML, points that do not exist, numbers that are not finite,
/// inlined files that are missing, and nodes whose surface would be lost.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    let mut reader = SceneReader::new();
    let mut meshes = Vec::new();
    for node in reader.read(bytes, file)? {
        if let Some(mut mesh) = node.mesh {
            node.to_scene.apply(&mut mesh);
            meshes.push(mesh);
        }
    }
    Ok(LoadedMeshes { meshes, warnings: reader.warnings.finish(file) })
}

/// Parses a VRML 2 file as a tree of nodes. Scale, shear and mirror are applied to the meshes.
///
/// # Errors
/// The errors of [`parse`].
///
/// ```
/// use elbowroom_formats::vrml;
/// let text = "#VRML V2.0 utf8
///     DEF base Transform { children [
///       Shape { geometry Box { size 0.4 0.1 0.4 } }
///       DEF arm Transform { translation 0 0.5 0 children Shape { geometry Cylinder { radius 0.05 height 0.8 } } }
///     ] }";
/// let tree = vrml::parse_tree(text.as_bytes(), "arm.wrl".as_ref())?;
/// assert_eq!((tree.nodes[1].name.as_str(), tree.nodes[1].parent), ("arm", Some(0)));
/// assert!((tree.aabb().max.y - 0.9).abs() < 1e-12);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
pub fn parse_tree(bytes: &[u8], file: &Path) -> Result<NodeTree, Diagnostic> {
    let mut reader = SceneReader::new();
    let mut tree = NodeTree::new(input::stem(file));
    let mut frames: Vec<Pose> = Vec::new();
    for node in reader.read(bytes, file)? {
        let parent = node.parent.map_or(Pose::IDENTITY, |p| frames[p]);
        let (placed, frame) = Node::placed(node.name, node.parent, &parent, &node.to_scene, node.mesh);
        tree.push(placed);
        frames.push(frame);
    }
    tree.warnings = reader.warnings.finish(file);
    tree.check_finite(file)?;
    Ok(tree)
}
