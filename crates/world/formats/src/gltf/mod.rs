//! glTF 2.0, as JSON or GLB: the triangles of the scene in world coordinates, or the tree of its nodes.
//!
//! The result has one entry per node with a mesh, with all primitives of the mesh. Numbers are metres, and the frame of
//! the file is kept: glTF defines +y as up, and nothing is rotated. Skins and morphs stay in their rest shape. External
//! buffers must be relative paths below the directory of the file. Files that require an extension are refused.

mod accessor;
mod animation;
mod buffers;
mod document;
mod scene;
mod tree;

use std::path::Path;

use crate::mesh_data::LoadedMeshes;
use crate::nodetree::NodeTree;
use crate::{Diagnostic, input};
use accessor::AccessorReader;
use scene::SceneReader;

/// Parses a glTF or GLB file.
///
/// # Errors
/// [`Diagnostic`] for damaged JSON or chunks, references to missing elements, missing or too short buffers, required
/// extensions, or nodes in a cycle.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    let mut meshes = Vec::new();
    let warnings = read_scene(bytes, file, |scene| {
        for node in std::mem::take(&mut scene.nodes) {
            if let Some(mut mesh) = node.mesh {
                node.to_scene.apply(&mut mesh);
                meshes.push(mesh);
            }
        }
        Ok(())
    })?;
    Ok(LoadedMeshes { meshes, warnings })
}

/// Parses a glTF or GLB file as a tree of nodes.
///
/// Every node of the scene has its frame, its mesh in this frame, and the translation and rotation channels of the first
/// animation that moves it. Scale, shear and mirror are applied to the meshes.
///
/// # Errors
/// The errors of [`parse`], and animations with missing numbers.
pub fn parse_tree(bytes: &[u8], file: &Path) -> Result<NodeTree, Diagnostic> {
    let mut tree = NodeTree::new(input::stem(file));
    tree.warnings = read_scene(bytes, file, |scene| tree::build(scene, &mut tree))?;
    tree.check_finite(file)?;
    Ok(tree)
}

/// Reads the scene of a file, passes it to the caller's function, and returns the warnings.
fn read_scene(
    bytes: &[u8],
    file: &Path,
    then: impl FnOnce(&mut SceneReader<'_>) -> Result<(), Diagnostic>,
) -> Result<Vec<Diagnostic>, Diagnostic> {
    input::check_content(bytes, file)?;
    let (json, binary) = buffers::split(bytes, file)?;
    let document = document::parse(&json, file)?;
    let buffers = buffers::load(&document, binary, file)?;
    let mut scene = SceneReader::new(AccessorReader { document: &document, buffers: &buffers, file });
    scene.read()?;
    then(&mut scene)?;
    Ok(scene.warnings)
}
