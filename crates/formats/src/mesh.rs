//! Mesh files of any kind: by content first, extension second.

use std::path::Path;

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::units::LengthUnit;
use elbowroom_spatial::{Aabb, Vec3};

use crate::nodetree::NodeTree;
use crate::{FormatError, Warning, dae, gltf, obj, off, ply, source, stl, tds};

/// The most vertices or triangles that a file may unfold into, instances counted.
pub(crate) const MOST_ELEMENTS: usize = 20_000_000;

/// Triangles of one object.
///
/// Every index is below `vertices.len()` and every coordinate is finite; degenerate and duplicate triangles stay.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeshData {
    /// The object's name in the file, or the file's stem.
    pub name: String,
    /// Corners in metres, in the file's own frame.
    pub vertices: Vec<Vec3>,
    /// Corners of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl MeshData {
    /// The box around all corners; empty where there are none.
    pub fn aabb(&self) -> Aabb {
        Aabb::from_points(self.vertices.iter().copied())
    }

    /// Multiplies every corner by a factor per axis; a mirror image keeps its outside outside.
    ///
    /// ```
    /// use elbowroom_formats::MeshData;
    /// use elbowroom_spatial::Vec3;
    /// let mut mesh = MeshData {
    ///     name: "flag".into(),
    ///     vertices: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
    ///     triangles: vec![[0, 1, 2]],
    /// };
    /// mesh.scale(Vec3::new(-1.0, 1.0, 1.0));
    /// assert_eq!(mesh.triangles, [[0, 2, 1]]);
    /// ```
    pub fn scale(&mut self, factors: Vec3) {
        self.vertices.iter_mut().for_each(|v| *v = v.scale(factors));
        if factors.x * factors.y * factors.z < 0.0 {
            self.flip();
        }
    }

    pub(crate) fn flip(&mut self) {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }

    /// The mesh as a solid of the proximity room.
    ///
    /// # Errors
    /// Where the proximity room refuses the mesh; `file` is named in the message.
    pub fn into_trimesh(self, file: &Path) -> Result<TriMesh, FormatError> {
        let name = self.name;
        TriMesh::new(self.vertices, self.triangles)
            .map_err(|e| FormatError::new(file, None, format!("the object `{name}` is no solid: {e}")))
    }
}

/// What a mesh file holds.
#[derive(Debug, Clone, Default)]
pub struct LoadedMeshes {
    /// One entry per object, whatever its materials; never empty, and none without triangles.
    pub meshes: Vec<MeshData>,
    /// What its user should know.
    pub warnings: Vec<Warning>,
}

impl LoadedMeshes {
    /// The box around everything.
    pub fn aabb(&self) -> Aabb {
        self.meshes.iter().fold(Aabb::EMPTY, |all, m| all.union(&m.aabb()))
    }
}

/// What to do with the up axis that a COLLADA file states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpAxis {
    /// Turn the mesh so that up is +z, as a file opened on its own should stand.
    ToZ,
    /// Leave the numbers as they are, as rviz and `MoveIt` do for meshes of a URDF.
    Ignore,
}

/// A file format that this room reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
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
}

impl Format {
    /// Whether the format itself fixes the unit of its numbers, so that a user's `--unit` has no say.
    pub fn states_its_unit(self) -> bool {
        matches!(self, Self::Dae | Self::Gltf)
    }
}

/// Loads a mesh file: STL, OBJ, DAE, glTF/GLB, PLY, OFF or 3DS, told apart by content first and extension second.
///
/// `unit` is the unit of formats that state none (STL, OBJ, PLY, OFF, 3DS); `None` means metres. A COLLADA file is
/// turned so that its up axis is +z. One entry per object.
///
/// # Errors
/// A file that cannot be read, is of another kind, damaged, or has no triangles.
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
pub fn load(path: &Path, unit: Option<LengthUnit>) -> Result<LoadedMeshes, FormatError> {
    load_with(path, unit, UpAxis::ToZ)
}

/// As [`load`], with a say about the up axis.
///
/// # Errors
/// As [`load`].
pub fn load_with(path: &Path, unit: Option<LengthUnit>, up: UpAxis) -> Result<LoadedMeshes, FormatError> {
    let bytes = source::read(path)?;
    let mut loaded = parse(&bytes, path, unit, up)?;
    if let Some(w) = units_suspicion(loaded.aabb().extent()) {
        loaded.warnings.push(Warning { file: path.to_owned(), ..w });
    }
    Ok(loaded)
}

/// Parses the content of a mesh file; `file` is named in messages, gives the format where the content does not, and
/// is where a glTF's buffers are looked for.
///
/// # Errors
/// As [`load`].
pub fn parse(bytes: &[u8], file: &Path, unit: Option<LengthUnit>, up: UpAxis) -> Result<LoadedMeshes, FormatError> {
    let format = detect(bytes, file)?;
    let mut loaded = match format {
        Format::Stl => stl::parse(bytes, file),
        Format::Obj => obj::parse(bytes, file),
        Format::Dae => dae::parse(bytes, file, up),
        Format::Gltf => gltf::parse(bytes, file),
        Format::Ply => ply::parse(bytes, file),
        Format::Off => off::parse(bytes, file),
        Format::Tds => tds::parse(bytes, file).map(NodeTree::flatten),
    }?;
    apply_unit(&mut loaded, format, file, unit);
    loaded.meshes.retain(|m| !m.triangles.is_empty());
    if loaded.meshes.is_empty() {
        return Err(FormatError::new(file, None, "has no triangles")
            .hint("export the model as a surface; points, lines and splines cannot collide"));
    }
    refuse_overflow(&loaded, file)?;
    Ok(loaded)
}

fn apply_unit(loaded: &mut LoadedMeshes, format: Format, file: &Path, unit: Option<LengthUnit>) {
    let Some(unit) = unit else { return };
    if format.states_its_unit() {
        let what = format!("states its own unit; the unit {} asked for is not applied", unit.symbol());
        loaded.warnings.push(Warning::new(file, None, what));
        return;
    }
    let factor = unit.to_metres(1.0);
    loaded.meshes.iter_mut().for_each(|m| m.scale(Vec3::splat(factor)));
}

/// A transform or a unit may have pushed finite numbers over the edge.
fn refuse_overflow(loaded: &LoadedMeshes, file: &Path) -> Result<(), FormatError> {
    for mesh in &loaded.meshes {
        if let Some(i) = mesh.vertices.iter().position(|v| !v.is_finite()) {
            return Err(FormatError::new(file, None, format!("vertex {i} of `{}` is infinitely far away", mesh.name))
                .hint("coordinates below 1e300, and a transform with finite numbers"));
        }
    }
    Ok(())
}

/// Doubt about the unit of something of this extent (metres per axis): a robot is rarely larger than 20 m or smaller
/// than 5 mm. `None` where there is no doubt. The warning names no file.
///
/// ```
/// use elbowroom_formats::mesh::units_suspicion;
/// use elbowroom_spatial::Vec3;
/// assert!(units_suspicion(Vec3::new(350.0, 120.0, 80.0)).is_some());
/// assert!(units_suspicion(Vec3::new(0.35, 0.12, 0.08)).is_none());
/// ```
pub fn units_suspicion(extent: Vec3) -> Option<Warning> {
    let largest = extent.max_element();
    if largest > 20.0 {
        return Some(Warning::new("", None, format!("is {largest:.4} m large: is its unit right?")).hint(
            "--unit mm (cm, in), or in a URDF <mesh filename=\"…\" scale=\"0.001 0.001 0.001\"/>; `elbowroom inspect` \
                 says which unit fits",
        ));
    }
    (largest < 0.005).then(|| {
        Warning::new("", None, format!("is only {largest:.3e} m large: is its unit right?"))
            .hint("--unit m, or in a URDF a mesh without scale=\"0.001 0.001 0.001\", where a unit was applied twice")
    })
}

/// Finds out what kind of file this is.
///
/// # Errors
/// Where it is none that this room reads; the message says what it is, where that can be told.
pub fn detect(bytes: &[u8], file: &Path) -> Result<Format, FormatError> {
    source::check_content(bytes, file)?;
    let decoded = source::text_bytes(&bytes[..bytes.len().min(4096) & !1], file).unwrap_or_default();
    let head = decoded.trim_ascii_start();
    if let Some(format) = by_magic(bytes, head) {
        return Ok(format);
    }
    if let Some((kind, hint)) = known_but_not_read(head) {
        return Err(FormatError::new(file, None, format!("is {kind}")).hint(hint));
    }
    if head.starts_with(b"<") || bytes.starts_with(b"<\0") {
        return if contains(&decoded, b"COLLADA") || extension_is(file, "dae") {
            Ok(Format::Dae)
        } else {
            Err(FormatError::new(file, 1, "is XML, but not COLLADA").hint(READABLE))
        };
    }
    by_extension(file).or_else(|| looks_like_obj(head).then_some(Format::Obj)).ok_or_else(|| {
        FormatError::new(file, None, "is of no kind that can be read, by content or by extension").hint(READABLE)
    })
}

const READABLE: &str = "a mesh as STL, OBJ, DAE, glTF/GLB, PLY, OFF or 3DS";

fn by_magic(bytes: &[u8], head: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"glTF") || (head.starts_with(b"{") && contains(head, b"\"")) {
        return Some(Format::Gltf);
    }
    if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
        return Some(Format::Ply);
    }
    if off::is_header(head) {
        return Some(Format::Off);
    }
    if tds::is_header(bytes) {
        return Some(Format::Tds);
    }
    (stl::is_ascii(head) || stl::is_exact_binary(bytes)).then_some(Format::Stl)
}

fn known_but_not_read(head: &[u8]) -> Option<(&'static str, &'static str)> {
    [
        (&b"#VRML"[..], "VRML", READABLE),
        (b"#Inventor", "an Open Inventor file", READABLE),
        (b"# .PCD", "a point cloud, not a mesh", "a mesh of the surface: collision checking needs triangles"),
        (b"VERSION .7", "a point cloud, not a mesh", "a mesh of the surface: collision checking needs triangles"),
        (b"# Octomap", "an octree, not a mesh", READABLE),
        (b"ISO-10303", "STEP, a CAD format", "the part exported from your CAD system as STL or glTF"),
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

fn by_extension(file: &Path) -> Option<Format> {
    [
        ("stl", Format::Stl),
        ("obj", Format::Obj),
        ("dae", Format::Dae),
        ("gltf", Format::Gltf),
        ("glb", Format::Gltf),
        ("ply", Format::Ply),
        ("off", Format::Off),
        ("3ds", Format::Tds),
    ]
    .into_iter()
    .find(|(extension, _)| extension_is(file, extension))
    .map(|(_, format)| format)
}

fn extension_is(file: &Path, extension: &str) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

fn looks_like_obj(head: &[u8]) -> bool {
    head.split(|&b| b == b'\n').any(|l| l.starts_with(b"v ") || l.starts_with(b"v\t"))
}

fn contains(haystack: &[u8], needle: &[u8]) -> bool {
    haystack.windows(needle.len()).any(|w| w == needle)
}
