//! Mesh files of any format. The content decides the format, then the extension.

use std::path::Path;

use elbowroom_spatial::Vec3;
use elbowroom_spatial::units::LengthUnit;

pub use crate::mesh_data::{LoadedMeshes, MeshData, UpAxis};
use crate::nodetree::NodeTree;
use crate::{Diagnostic, dae, gltf, input, obj, off, ply, stl, tds, urdf, vrml};

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// STL, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// COLLADA.
    Dae,
    /// glTF 2.0, JSON or GLB.
    Gltf,
    /// Stanford PLY.
    Ply,
    /// Object File Format.
    Off,
    /// 3D Studio.
    Tds,
    /// VRML 2.
    Vrml,
}

impl MeshFormat {
    /// Whether the format defines the unit of its numbers, so that the option `--unit` has no effect.
    pub fn states_its_unit(self) -> bool {
        matches!(self, Self::Dae | Self::Gltf | Self::Vrml)
    }
}

/// Loads a mesh file: STL, OBJ, DAE, glTF/GLB, PLY, OFF, 3DS or VRML 2. The content decides the format, then the extension.
///
/// `unit` is the unit for formats that define none (STL, OBJ, PLY, OFF, 3DS); `None` means metres. A COLLADA file is
/// rotated so that its up axis is +z. The result has one entry per object.
///
/// # Errors
/// [`Diagnostic`] if the file cannot be read, has another format, is damaged, or has no triangles.
///
/// ```
/// use elbowroom_formats::mesh;
/// use elbowroom_spatial::units::LengthUnit;
/// # let dir = tempfile::tempdir()?;
/// let path = dir.path().join("plate.obj");
/// std::fs::write(&path, "v 0 0 0\nv 500 0 0\nv 500 250 0\nv 0 250 0\nf 1 2 3 4\n")?;
/// let plate = mesh::load(&path, Some(LengthUnit::Millimetre))?;
/// assert_eq!(plate.meshes[0].triangles.len(), 2);
/// assert_eq!(plate.aabb().extent().x, 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn load(path: &Path, unit: Option<LengthUnit>) -> Result<LoadedMeshes, Diagnostic> {
    load_with(path, unit, UpAxis::ToZ)
}

/// Like [`load`], with a choice for the up axis.
///
/// # Errors
/// The errors of [`load`].
pub fn load_with(path: &Path, unit: Option<LengthUnit>, up: UpAxis) -> Result<LoadedMeshes, Diagnostic> {
    let bytes = input::read(path)?;
    let mut loaded = parse(&bytes, path, unit, up)?;
    if let Some(w) = unit_warning(loaded.aabb().extent()) {
        loaded.warnings.push(Diagnostic { file: path.to_owned(), ..w });
    }
    Ok(loaded)
}

/// Parses the content of a mesh file.
///
/// `file` is named in messages, and other files of a glTF or VRML model are relative to it. Its extension decides the format if the
/// content does not.
///
/// # Errors
/// The errors of [`load`].
pub fn parse(bytes: &[u8], file: &Path, unit: Option<LengthUnit>, up: UpAxis) -> Result<LoadedMeshes, Diagnostic> {
    let format = detect(bytes, file)?;
    let mut loaded = match format {
        MeshFormat::Stl => stl::parse(bytes, file),
        MeshFormat::Obj => obj::parse(bytes, file),
        MeshFormat::Dae => dae::parse(bytes, file, up),
        MeshFormat::Gltf => gltf::parse(bytes, file),
        MeshFormat::Ply => ply::parse(bytes, file),
        MeshFormat::Off => off::parse(bytes, file),
        MeshFormat::Tds => tds::parse(bytes, file).map(NodeTree::flatten),
        MeshFormat::Vrml => vrml::parse(bytes, file),
    }?;
    apply_unit(&mut loaded, format, file, unit);
    loaded.meshes.retain(|m| !m.triangles.is_empty());
    if loaded.meshes.is_empty() {
        return Err(Diagnostic::new(file, None, "has no triangles")
            .hint("export the model as a surface; points, lines and splines cannot collide"));
    }
    refuse_overflow(&loaded, file)?;
    Ok(loaded)
}

fn apply_unit(loaded: &mut LoadedMeshes, format: MeshFormat, file: &Path, unit: Option<LengthUnit>) {
    let Some(unit) = unit else { return };
    if format.states_its_unit() {
        let what = format!("states its own unit; the unit {} asked for is not applied", unit.symbol());
        loaded.warnings.push(Diagnostic::new(file, None, what));
        return;
    }
    let factor = unit.to_metres(1.0);
    loaded.meshes.iter_mut().for_each(|m| m.scale(Vec3::splat(factor)));
}

/// Refuses numbers that a transform or a unit has made infinite.
fn refuse_overflow(loaded: &LoadedMeshes, file: &Path) -> Result<(), Diagnostic> {
    for mesh in &loaded.meshes {
        if let Some(i) = mesh.vertices.iter().position(|v| !v.is_finite()) {
            return Err(Diagnostic::new(file, None, format!("vertex {i} of `{}` is infinitely far away", mesh.name))
                .hint("coordinates below 1e300, and a transform with finite numbers"));
        }
    }
    Ok(())
}

/// Returns a warning if an extent (metres per axis) suggests a wrong unit. The warning names no file.
///
/// A robot is rarely larger than 20 m or smaller than 5 mm.
///
/// ```
/// use elbowroom_formats::mesh::unit_warning;
/// use elbowroom_spatial::Vec3;
/// assert!(unit_warning(Vec3::new(350.0, 120.0, 80.0)).is_some());
/// assert!(unit_warning(Vec3::new(0.35, 0.12, 0.08)).is_none());
/// ```
pub fn unit_warning(extent: Vec3) -> Option<Diagnostic> {
    let largest = extent.max_element();
    if largest > 20.0 {
        return Some(Diagnostic::new("", None, format!("is {largest:.4} m large: is its unit right?")).hint(
            "--unit mm (cm, in), or in a URDF <mesh filename=\"…\" scale=\"0.001 0.001 0.001\"/>; `elbowroom inspect` \
                 says which unit fits",
        ));
    }
    (largest < 0.005).then(|| {
        Diagnostic::new("", None, format!("is only {largest:.3e} m large: is its unit right?"))
            .hint("--unit m, or in a URDF a mesh without scale=\"0.001 0.001 0.001\", where a unit was applied twice")
    })
}

/// Detects the format of a file.
///
/// # Errors
/// [`Diagnostic`] for a file of another format. The message names the format, if it is known.
pub fn detect(bytes: &[u8], file: &Path) -> Result<MeshFormat, Diagnostic> {
    input::check_content(bytes, file)?;
    let decoded = input::text_bytes(&bytes[..bytes.len().min(4096) & !1], file).unwrap_or_default();
    let head = decoded.trim_ascii_start();
    if let Some(format) = by_magic(bytes, head) {
        return Ok(format);
    }
    if let Some((kind, hint)) = unsupported_format(head) {
        return Err(Diagnostic::new(file, None, format!("is {kind}")).hint(hint));
    }
    if head.starts_with(b"<") || bytes.starts_with(b"<\0") {
        if contains(&decoded, b"<sdf") {
            return Err(Diagnostic::new(file, 1, format!("{}, no mesh", urdf::SDF)).hint(urdf::SDF_HINT));
        }
        return if contains(&decoded, b"COLLADA") || extension_is(file, "dae") {
            Ok(MeshFormat::Dae)
        } else {
            Err(Diagnostic::new(file, 1, "is XML, but not COLLADA").hint(READABLE))
        };
    }
    by_extension(file).or_else(|| has_obj_vertices(head).then_some(MeshFormat::Obj)).ok_or_else(|| {
        let hint = input::planning_scene_hint(file).unwrap_or_else(|| READABLE.to_owned());
        Diagnostic::new(file, None, "is of no kind that can be read, by content or by extension").hint(hint)
    })
}

const READABLE: &str = "a mesh as STL, OBJ, DAE, glTF/GLB, PLY, OFF, 3DS or VRML 2";

fn by_magic(bytes: &[u8], head: &[u8]) -> Option<MeshFormat> {
    if bytes.starts_with(b"glTF") || (head.starts_with(b"{") && contains(head, b"\"")) {
        return Some(MeshFormat::Gltf);
    }
    if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
        return Some(MeshFormat::Ply);
    }
    if off::is_header(head) {
        return Some(MeshFormat::Off);
    }
    if vrml::is_header(head) {
        return Some(MeshFormat::Vrml);
    }
    if tds::is_header(bytes) {
        return Some(MeshFormat::Tds);
    }
    (stl::is_ascii(head) || stl::is_exact_binary(bytes)).then_some(MeshFormat::Stl)
}

fn unsupported_format(head: &[u8]) -> Option<(&'static str, &'static str)> {
    [
        (&b"#X3D"[..], "X3D", READABLE),
        (b"#Inventor", "an Open Inventor file", READABLE),
        (b"# .PCD", "a point cloud, not a mesh", "a mesh of the surface: collision checking needs triangles"),
        (b"VERSION .7", "a point cloud, not a mesh", "a mesh of the surface: collision checking needs triangles"),
        (b"# Octomap", "an octree, not a mesh", READABLE),
        (b"xof ", "a DirectX file", READABLE),
    ]
    .into_iter()
    .find(|(magic, ..)| head.starts_with(magic))
    .map(|(_, kind, hint)| (kind, hint))
    .or_else(|| {
        let xml = |root: &[u8]| head.starts_with(b"<") && contains(head, root);
        if xml(b"<robot") {
            return Some(("a robot description, not a mesh", "the URDF as a robot's model, and a mesh file here"));
        }
        xml(b"<X3D").then_some(("X3D", READABLE))
    })
}

fn by_extension(file: &Path) -> Option<MeshFormat> {
    [
        ("stl", MeshFormat::Stl),
        ("obj", MeshFormat::Obj),
        ("dae", MeshFormat::Dae),
        ("gltf", MeshFormat::Gltf),
        ("glb", MeshFormat::Gltf),
        ("ply", MeshFormat::Ply),
        ("off", MeshFormat::Off),
        ("3ds", MeshFormat::Tds),
        ("wrl", MeshFormat::Vrml),
        ("wrz", MeshFormat::Vrml),
    ]
    .into_iter()
    .find(|(extension, _)| extension_is(file, extension))
    .map(|(_, format)| format)
}

fn extension_is(file: &Path, extension: &str) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

fn has_obj_vertices(head: &[u8]) -> bool {
    head.split(|&b| b == b'\n').any(|l| l.starts_with(b"v ") || l.starts_with(b"v\t"))
}

fn contains(haystack: &[u8], needle: &[u8]) -> bool {
    haystack.windows(needle.len()).any(|w| w == needle)
}
