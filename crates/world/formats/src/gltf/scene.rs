//! The nodes of a scene, visited from the top.

use elbowroom_spatial::{Rotation, Vec3};

use super::accessor::AccessorReader;
use super::document::{Mesh, Node, Primitive};
use crate::affine::Affine;
use crate::mesh_data::{MAX_ELEMENTS, MeshData};
use crate::{Diagnostic, input, polygon};

const MAX_DEPTH: usize = 200;
const MAX_VISITS: usize = 100_000;

/// Last primitive mode with points or lines.
const LINE_STRIP: u32 = 3;
/// Primitive modes with triangles.
const TRIANGLES: u32 = 4;
const TRIANGLE_STRIP: u32 = 5;
const TRIANGLE_FAN: u32 = 6;

/// Reads the scene of a document.
pub(super) struct SceneReader<'a> {
    pub(super) reader: AccessorReader<'a>,
    /// Visited nodes, parents before their children.
    pub(super) nodes: Vec<SceneNode>,
    pub(super) warnings: Vec<Diagnostic>,
    /// Number of vertices, corners and keys read so far.
    pub(super) elements: usize,
}

/// A visited node.
pub(super) struct SceneNode {
    /// Index in the document.
    pub(super) index: usize,
    /// Index of the parent in [`SceneReader::nodes`].
    pub(super) parent: Option<usize>,
    pub(super) name: String,
    /// Frame in the scene, with scale, shear and mirror.
    pub(super) to_scene: Affine,
    /// Mesh in the node's own frame; `None` if it has no triangles.
    pub(super) mesh: Option<MeshData>,
}

impl<'a> SceneReader<'a> {
    pub(super) fn new(reader: AccessorReader<'a>) -> Self {
        Self { reader, nodes: Vec::new(), warnings: Vec::new(), elements: 0 }
    }

    /// Visits all nodes of the scene.
    pub(super) fn read(&mut self) -> Result<(), Diagnostic> {
        let mut stack: Vec<_> = self.roots()?.into_iter().map(|n| (n, Affine::IDENTITY, None, 0)).rev().collect();
        while let Some((index, parent_to_scene, parent, depth)) = stack.pop() {
            let file = self.reader.file;
            let node = self.node(index)?;
            if depth > MAX_DEPTH || self.nodes.len() >= MAX_VISITS {
                let what = format!("node {index}: nodes contain each other too deeply, or in a cycle");
                return Err(Diagnostic::new(file, None, what).hint("nodes as a tree"));
            }
            let to_scene = parent_to_scene.after(&local(node));
            let mut name = node.name.clone();
            let mut merged = None;
            if let Some(mesh_index) = node.mesh {
                let mesh = self.reader.document.meshes.get(mesh_index).ok_or_else(|| {
                    Diagnostic::new(file, None, format!("node {index} has the mesh {mesh_index}, which does not exist"))
                        .hint("the number of a mesh, counted from 0")
                })?;
                name = name.or_else(|| Some(mesh.name.clone().unwrap_or_else(|| input::stem(file))));
                merged = self.mesh(name.clone().unwrap_or_default(), mesh_index, mesh)?;
                if node.skin.is_some() && self.warnings.is_empty() {
                    self.warnings.push(Diagnostic::new(file, None, "skinned meshes are read in their rest shape"));
                }
            }
            let name = name.unwrap_or_else(|| format!("node_{index}"));
            let here = self.nodes.len();
            self.nodes.push(SceneNode { index, parent, name, to_scene, mesh: merged });
            stack.extend(node.children.iter().rev().map(|&c| (c, to_scene, Some(here), depth + 1)));
        }
        Ok(())
    }

    fn node(&self, index: usize) -> Result<&'a Node, Diagnostic> {
        self.reader.document.nodes.get(index).ok_or_else(|| {
            Diagnostic::new(self.reader.file, None, format!("the scene refers to node {index}, which does not exist"))
                .hint("the number of a node, counted from 0")
        })
    }

    /// The top nodes: of the default scene, else of the first scene, else all nodes that are not a child.
    fn roots(&self) -> Result<Vec<usize>, Diagnostic> {
        let document = self.reader.document;
        let index = document.scene.unwrap_or(0);
        match document.scenes.get(index) {
            Some(scene) => Ok(scene.nodes.clone()),
            None if document.scene.is_some() => {
                let what = format!("shows scene {index}, which does not exist");
                Err(Diagnostic::new(self.reader.file, None, what).hint("the number of a scene, counted from 0"))
            }
            None => {
                let mut is_child = vec![false; document.nodes.len()];
                for &child in document.nodes.iter().flat_map(|n| &n.children) {
                    self.node(child)?;
                    is_child[child] = true;
                }
                Ok((0..document.nodes.len()).filter(|&i| !is_child[i]).collect())
            }
        }
    }

    fn mesh(&mut self, name: String, index: usize, mesh: &Mesh) -> Result<Option<MeshData>, Diagnostic> {
        let mut merged = MeshData { name, ..MeshData::default() };
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            self.primitive(&format!("mesh {index}, primitive {i}"), primitive, &mut merged)?;
        }
        Ok((!merged.triangles.is_empty()).then_some(merged))
    }

    fn primitive(&mut self, place: &str, primitive: &Primitive, merged: &mut MeshData) -> Result<(), Diagnostic> {
        let mode = primitive.mode;
        match mode {
            ..=LINE_STRIP => return Ok(()),
            TRIANGLES | TRIANGLE_STRIP | TRIANGLE_FAN => {}
            _ => {
                let what = format!("has the mode {mode}, which does not exist");
                return Err(self.reader.error(place, &what).hint("4 (triangles), 5 (a strip) or 6 (a fan)"));
            }
        }
        let positions = primitive.attributes.position.ok_or_else(|| {
            self.reader.error(place, "has no POSITION").hint("the model exported with its positions, uncompressed")
        })?;
        let positions = self.reader.accessor(positions, place, "POSITION")?;
        let indices = primitive.indices.map(|i| self.reader.accessor(i, place, "indices")).transpose()?;
        let corners = indices.map_or(0, |i| i.count);
        self.elements = self.elements.saturating_add(positions.count).saturating_add(corners);
        if self.elements > MAX_ELEMENTS {
            let what = format!("the scene expands to more than {MAX_ELEMENTS} vertices and corners");
            return Err(self.reader.error(place, &what).hint("a coarser mesh, or fewer instances"));
        }
        let vertices = self.reader.points(positions, place)?;
        let offset = merged.vertices.len() as u32;
        let corners: Vec<u32> = match indices {
            Some(indices) => self.reader.indices(indices, vertices.len(), place)?,
            None => (0..vertices.len() as u32).collect(),
        };
        let corners: Vec<u32> = corners.into_iter().map(|i| i + offset).collect();
        merged.vertices.extend(vertices);
        match mode {
            TRIANGLE_STRIP => polygon::strip(&corners, &mut merged.triangles),
            TRIANGLE_FAN => polygon::fan(&corners, &mut merged.triangles),
            _ => merged.triangles.extend(corners.as_chunks::<3>().0),
        }
        Ok(())
    }
}

/// The transform of a node to its parent.
fn local(node: &Node) -> Affine {
    if let Some(matrix) = node.matrix {
        return from_matrix(&matrix);
    }
    let (translation, rotation, scale) = decomposed(node);
    Affine::translation(translation.to_array()).after(&Affine::rotation(rotation.rows())).after(&Affine::scale(scale))
}

fn from_matrix(columns: &[f32; 16]) -> Affine {
    Affine([0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| f64::from(columns[4 * column + row]))))
}

/// Translation, rotation and scale of a node. The shear of a matrix is dropped.
pub(super) fn decomposed(node: &Node) -> (Vec3, Rotation, [f64; 3]) {
    if let Some(matrix) = node.matrix {
        let map = from_matrix(&matrix);
        let mut scale = [0, 1, 2].map(|c| map.column(c).length());
        if map.is_mirror() {
            scale[2] = -scale[2];
        }
        let [x, y, z] = [0, 1, 2].map(|c| map.column(c) * (1.0 / scale[c]));
        return (map.column(3), Rotation::from_columns(x, y, z).unwrap_or(Rotation::IDENTITY), scale);
    }
    let translation = Vec3::from(node.translation.unwrap_or_default().map(f64::from));
    let rotation = node.rotation.and_then(|q| Rotation::from_quaternion_xyzw(q.map(f64::from)));
    let scale = node.scale.unwrap_or([1.0; 3]).map(f64::from);
    (translation, rotation.unwrap_or(Rotation::IDENTITY), scale)
}
