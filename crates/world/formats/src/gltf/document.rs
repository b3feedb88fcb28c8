//! The parts of the JSON of a glTF that are read. Unknown properties are ignored; references are checked on use.

use std::path::Path;

use serde::Deserialize;

use crate::Diagnostic;
use crate::tokens::show;

/// The root object.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    /// Present in every glTF file.
    asset: Asset,
    #[serde(default)]
    extensions_required: Vec<String>,
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffer_views: Vec<BufferView>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) animations: Vec<Animation>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Asset {
    version: String,
}

/// Properties of glTF files of all versions.
#[derive(Debug, Deserialize)]
struct Versioned {
    asset: Asset,
}

impl Asset {
    fn check(&self, file: &Path) -> Result<(), Diagnostic> {
        if self.version.split('.').next() == Some("2") {
            return Ok(());
        }
        let what = format!("is glTF of version {}; only 2 is read", show(self.version.as_bytes()));
        Err(Diagnostic::new(file, None, what).hint("the model exported as glTF 2.0"))
    }
}

/// Top nodes of a scene.
#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    /// Matrix in column-major order, which replaces translation, rotation and scale.
    pub(super) matrix: Option<[f32; 16]>,
    pub(super) translation: Option<[f32; 3]>,
    /// Unit quaternion x, y, z, w.
    pub(super) rotation: Option<[f32; 4]>,
    pub(super) scale: Option<[f32; 3]>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Mesh {
    pub(super) name: Option<String>,
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    #[serde(default = "triangles")]
    pub(super) mode: u32,
}

/// The default mode of a primitive.
fn triangles() -> u32 {
    4
}

#[derive(Debug, Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub(super) position: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) count: usize,
    #[serde(rename = "type")]
    pub(super) element_type: String,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sparse {
    pub(super) count: usize,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: usize,
    pub(super) byte_length: usize,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    pub(super) byte_length: usize,
}

#[derive(Debug, Deserialize)]
pub(super) struct Animation {
    pub(super) channels: Vec<Channel>,
    pub(super) samplers: Vec<Sampler>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Channel {
    pub(super) sampler: usize,
    pub(super) target: Target,
}

#[derive(Debug, Deserialize)]
pub(super) struct Target {
    pub(super) node: Option<usize>,
    /// Animated property; only `translation` and `rotation` are read.
    pub(super) path: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct Sampler {
    pub(super) input: usize,
    pub(super) output: usize,
    #[serde(default)]
    pub(super) interpolation: Interpolation,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub(super) enum Interpolation {
    #[default]
    Linear,
    Step,
    CubicSpline,
}

/// Parses the JSON; refuses files that require an extension.
pub(super) fn parse(json: &[u8], file: &Path) -> Result<Document, Diagnostic> {
    let document: Document = serde_json::from_slice(json).map_err(|e| {
        if let Some(other) = serde_json::from_slice(json).ok().and_then(|v: Versioned| v.asset.check(file).err()) {
            return other;
        }
        Diagnostic::new(file, e.line(), format!("the JSON is not glTF: {e}"))
            .hint("the model exported again as glTF 2.0")
    })?;
    document.asset.check(file)?;
    match &document.extensions_required[..] {
        [] => Ok(document),
        required => {
            let is_compression = |e: &&String| e.contains("draco") || e.contains("meshopt");
            Err(match required.iter().find(is_compression) {
                Some(extension) => Diagnostic::new(file, None, format!("the geometry is compressed ({extension})"))
                    .hint("the model exported without mesh compression"),
                None => Diagnostic::new(file, None, format!("requires extensions: {}", required.join(", ")))
                    .hint("the model exported again as glTF 2.0, without extensions"),
            })
        }
    }
}
