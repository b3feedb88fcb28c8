//! glTF 2.0, as JSON or GLB: the triangles of the scene, moved by its nodes; or the tree of its nodes.
//!
//! One entry per node with a mesh, its primitives together. Numbers are metres and the file's frame is kept: glTF
//! says +y is up, and nothing is turned. The crate `gltf` reads and validates the JSON; the numbers are fetched by
//! us, as its iterators trust the file. Skins and morphs stay in their rest shape. External buffers must be relative
//! paths below the file's directory.

mod accessor;
mod buffers;
mod tree;

use std::path::Path;

use elbowroom_spatial::{Rotation, Vec3};
use gltf::scene::Transform;
use gltf::{Document, Node};

use crate::mesh::{LoadedMeshes, MOST_ELEMENTS, MeshData};
use crate::nodetree::NodeTree;
use crate::ply::strip;
use crate::transform::Affine;
use crate::{FormatError, Warning, source};
use accessor::Reader;

const DEEPEST: usize = 200;
const MOST_VISITS: usize = 100_000;

/// Parses a glTF or GLB file.
///
/// # Errors
/// JSON or chunks that are damaged, references to nothing, buffers that are missing or too short, extensions that
/// compress the geometry, nodes in a circle.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, FormatError> {
    let mut meshes = Vec::new();
    let warnings = with_scene(bytes, file, |_, scene| {
        for visit in std::mem::take(&mut scene.visits) {
            if let Some(mut mesh) = visit.mesh {
                visit.to_scene.apply(&mut mesh);
                meshes.push(mesh);
            }
        }
        Ok(())
    })?;
    Ok(LoadedMeshes { meshes, warnings })
}

/// Parses a glTF or GLB file as a tree: every node of the scene with its frame, its mesh in this frame, and the
/// translation and rotation channels of the first animation that moves it. Scale, shear and mirror go into the meshes.
///
/// # Errors
/// As [`parse`], and animations whose numbers are not there.
pub fn parse_tree(bytes: &[u8], file: &Path) -> Result<NodeTree, FormatError> {
    let mut tree = NodeTree::new(source::stem(file));
    tree.warnings = with_scene(bytes, file, |document, scene| tree::build(document, scene, &mut tree))?;
    tree.check_finite(file)?;
    Ok(tree)
}

/// Reads the document, walks its scene, hands both over, and answers with the warnings.
fn with_scene(
    bytes: &[u8],
    file: &Path,
    then: impl FnOnce(&Document, &mut Scene<'_>) -> Result<(), FormatError>,
) -> Result<Vec<Warning>, FormatError> {
    source::check_content(bytes, file)?;
    let (json, binary) = buffers::split(bytes, file)?;
    let document = document(&json, file)?;
    refuse_compression(&document, file)?;
    let buffers = buffers::load(&document, binary, file)?;
    let reader = Reader { buffers: &buffers, file };
    let mut scene = Scene { reader, visits: Vec::new(), warnings: Vec::new(), elements: 0 };
    scene.walk(roots(&document))?;
    then(&document, &mut scene)?;
    Ok(scene.warnings)
}

fn document(json: &[u8], file: &Path) -> Result<Document, FormatError> {
    let mut root: gltf::json::Root = gltf::json::deserialize::from_slice(json).map_err(|e| {
        FormatError::new(file, e.line(), format!("the JSON is not glTF: {e}"))
            .hint("the model exported again as glTF 2.0")
    })?;
    prepare(&mut root, file)?;
    Document::from_json(root).map_err(|e| {
        let what = match e {
            gltf::Error::Validation(list) => {
                let shown: Vec<String> = list.iter().take(3).map(|(path, e)| format!("{path}: {e}")).collect();
                format!("the glTF is not valid: {}{}", shown.join("; "), if list.len() > 3 { "; …" } else { "" })
            }
            other => format!("the glTF is not valid: {other}"),
        };
        FormatError::new(file, None, what).hint("the model exported again as glTF 2.0, without extensions")
    })
}

/// Spares the library's validation two things: it panics at positions in an accessor that does not exist, and it
/// refuses positions without bounds, which many exporters leave out and nothing here needs.
fn prepare(root: &mut gltf::json::Root, file: &Path) -> Result<(), FormatError> {
    let key = gltf::json::validation::Checked::Valid(gltf::Semantic::Positions);
    for (m, mesh) in root.meshes.iter().enumerate() {
        for index in mesh.primitives.iter().filter_map(|p| p.attributes.get(&key)) {
            let Some(accessor) = root.accessors.get_mut(index.value()) else {
                let what = format!("mesh {m} has its POSITION in accessor {}, which does not exist", index.value());
                return Err(FormatError::new(file, None, what).hint("the number of an accessor, counted from 0"));
            };
            let zeros = || Some(vec![0.0; 3].into());
            accessor.min = accessor.min.take().or_else(zeros);
            accessor.max = accessor.max.take().or_else(zeros);
        }
    }
    Ok(())
}

fn refuse_compression(document: &Document, file: &Path) -> Result<(), FormatError> {
    let compressed = document.extensions_required().find(|e| e.contains("draco") || e.contains("meshopt"));
    compressed.map_or(Ok(()), |extension| {
        Err(FormatError::new(file, None, format!("the geometry is compressed ({extension})"))
            .hint("the model exported without mesh compression"))
    })
}

/// The nodes on top: of the default scene, else of the first, else those that are nobody's child.
fn roots(document: &Document) -> Vec<Node<'_>> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().collect();
    }
    let mut is_child = vec![false; document.nodes().len()];
    document.nodes().flat_map(|n| n.children().map(|c| c.index()).collect::<Vec<_>>()).for_each(|i| is_child[i] = true);
    document.nodes().filter(|n| !is_child[n.index()]).collect()
}

struct Scene<'a> {
    reader: Reader<'a>,
    visits: Vec<Visit>,
    warnings: Vec<Warning>,
    elements: usize,
}

/// A node as the walk comes by.
struct Visit {
    /// Its index in the file.
    index: usize,
    /// Index of the visit to its parent.
    parent: Option<usize>,
    name: String,
    /// Its frame in the scene, with scale, shear and mirror.
    to_scene: Affine,
    /// In its own frame; `None` where there are no triangles.
    mesh: Option<MeshData>,
}

impl Scene<'_> {
    fn walk(&mut self, roots: Vec<Node<'_>>) -> Result<(), FormatError> {
        let file = self.reader.file;
        let mut waiting: Vec<_> = roots.into_iter().map(|n| (n, Affine::IDENTITY, None, 0)).rev().collect();
        while let Some((node, parent_to_scene, parent, depth)) = waiting.pop() {
            if depth > DEEPEST || self.visits.len() >= MOST_VISITS {
                let what = format!("node {}: nodes contain each other too deeply, or in a circle", node.index());
                return Err(FormatError::new(file, None, what).hint("nodes as a tree"));
            }
            let to_scene = parent_to_scene.after(&local(&node.transform()));
            let mut name = node.name().map(str::to_owned);
            let mut whole = None;
            if let Some(mesh) = node.mesh() {
                name = name.or_else(|| Some(mesh.name().map_or_else(|| source::stem(file), str::to_owned)));
                whole = self.object(name.clone().unwrap_or_default(), &mesh)?;
                if node.skin().is_some() && self.warnings.is_empty() {
                    self.warnings.push(Warning::new(file, None, "skinned meshes are read in their rest shape"));
                }
            }
            let name = name.unwrap_or_else(|| format!("node_{}", node.index()));
            let here = self.visits.len();
            self.visits.push(Visit { index: node.index(), parent, name, to_scene, mesh: whole });
            let first = waiting.len();
            waiting.extend(node.children().map(|c| (c, to_scene, Some(here), depth + 1)));
            waiting[first..].reverse();
        }
        Ok(())
    }

    fn object(&mut self, name: String, mesh: &gltf::Mesh<'_>) -> Result<Option<MeshData>, FormatError> {
        let mut whole = MeshData { name, ..MeshData::default() };
        for primitive in mesh.primitives() {
            self.primitive(mesh, &primitive, &mut whole)?;
        }
        Ok((!whole.triangles.is_empty()).then_some(whole))
    }

    fn primitive(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        whole: &mut MeshData,
    ) -> Result<(), FormatError> {
        use gltf::mesh::Mode;
        let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let positions = primitive.get(&gltf::Semantic::Positions).ok_or_else(|| {
            self.reader.error(&place, "has no POSITION").hint("the model exported with its positions, uncompressed")
        })?;
        let indices = primitive.indices();
        let corners = indices.as_ref().map_or(0, gltf::Accessor::count);
        self.elements = self.elements.saturating_add(positions.count()).saturating_add(corners);
        if self.elements > MOST_ELEMENTS {
            let what = format!("the scene unfolds into more than {MOST_ELEMENTS} vertices and corners");
            return Err(self.reader.error(&place, &what).hint("a coarser mesh, or fewer instances"));
        }
        let vertices = self.reader.points(&positions, &place)?;
        let offset = whole.vertices.len() as u32;
        let corners: Vec<u32> = match indices {
            Some(indices) => self.reader.indices(&indices, vertices.len(), &place)?,
            None => (0..vertices.len() as u32).collect(),
        };
        let corners: Vec<u32> = corners.into_iter().map(|i| i + offset).collect();
        whole.vertices.extend(vertices);
        match mode {
            Mode::TriangleStrip => strip(&corners, &mut whole.triangles),
            Mode::TriangleFan => {
                whole
                    .triangles
                    .extend(corners.get(1..).unwrap_or_default().windows(2).map(|w| [corners[0], w[0], w[1]]));
            }
            _ => whole.triangles.extend(corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]])),
        }
        Ok(())
    }
}

/// A node's transform in double precision.
fn local(transform: &Transform) -> Affine {
    match transform {
        Transform::Matrix { matrix } => {
            let mut rows = [[0.0; 4]; 3];
            for (r, row) in rows.iter_mut().enumerate() {
                for (c, cell) in row.iter_mut().enumerate() {
                    *cell = f64::from(matrix[c][r]);
                }
            }
            Affine(rows)
        }
        Transform::Decomposed { translation, rotation, scale } => {
            let turn = Rotation::from_quaternion_xyzw(rotation.map(f64::from)).unwrap_or(Rotation::IDENTITY);
            Affine::translation(translation.map(f64::from))
                .after(&Affine::rotation(turn.rows()))
                .after(&Affine::scale(scale.map(f64::from)))
        }
    }
}

/// A vector of three numbers as a point.
fn point(n: [f64; 3]) -> Vec3 {
    Vec3::from(n)
}
