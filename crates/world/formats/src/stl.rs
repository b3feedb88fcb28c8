//! STL, binary and ASCII.
//!
//! Some binary files begin with `solid`, so the size decides first: a file of exactly `84 + 50·n` bytes, with n at byte
//! 80, is binary. Normals are not read: the winding determines the outside.

use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::mesh_data::{LoadedMeshes, MeshData};
use crate::tokens::{Tokens, show, vector};
use crate::warning_list::WarningList;
use crate::{Diagnostic, input, polygon};

const HEADER: usize = 84;
const FACET: usize = 50;

pub(crate) fn is_ascii(head: &[u8]) -> bool {
    head.get(..5).is_some_and(|s| s.eq_ignore_ascii_case(b"solid"))
}

pub(crate) fn is_exact_binary(bytes: &[u8]) -> bool {
    promised_size(bytes) == Some(bytes.len())
}

fn promised_size(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
    (count as usize).checked_mul(FACET)?.checked_add(HEADER)
}

/// Parses an STL file: one entry per `solid` of an ASCII file, one entry for a binary file. Numbers are metres.
///
/// # Errors
/// [`Diagnostic`] for truncated files, unexpected words, or invalid numbers.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text_bytes(bytes, file)?;
    let head = &text[..text.len().min(2048)];
    let is_text = is_ascii(head.trim_ascii_start()) && !is_exact_binary(bytes) && !head.contains(&0);
    if is_text { parse_ascii(&text, file) } else { parse_binary(bytes, file) }
}

/// Merges bitwise equal corners of triangles into shared vertices.
#[derive(Default)]
struct VertexMerger {
    mesh: MeshData,
    index_of: HashMap<[u64; 3], u32>,
}

impl VertexMerger {
    fn vertex(&mut self, v: Vec3) -> u32 {
        // Adding zero converts -0 to 0.
        let key = v.to_array().map(|x| (x + 0.0).to_bits());
        *self.index_of.entry(key).or_insert_with(|| {
            self.mesh.vertices.push(v);
            self.mesh.vertices.len() as u32 - 1
        })
    }
}

fn parse_binary(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    let refuse = |what: String| Diagnostic::new(file, None, what).hint("copy or export the file again");
    let size = promised_size(bytes)
        .ok_or_else(|| refuse(format!("is truncated: {} bytes, where a binary STL begins with 84", bytes.len())))?;
    let count = (size - HEADER) / FACET;
    if size > bytes.len() {
        let complete = (bytes.len() - HEADER) / FACET;
        return Err(refuse(format!(
            "is truncated, or no STL: it announces {count} triangles = {size} bytes, but has {complete} triangles in {} bytes",
            bytes.len()
        )));
    }
    let mut warnings = Vec::new();
    if size < bytes.len() {
        let what = format!("has {} bytes after its {count} triangles; they are ignored", bytes.len() - size);
        warnings.push(Diagnostic::new(file, None, what));
    }
    let mut builder =
        VertexMerger { mesh: MeshData { name: input::stem(file), ..MeshData::default() }, ..VertexMerger::default() };
    builder.index_of.reserve(count / 2);
    builder.mesh.triangles.reserve(count);
    for (i, facet) in bytes[HEADER..size].chunks_exact(FACET).enumerate() {
        let mut triangle = [0; 3];
        for (corner, raw) in triangle.iter_mut().zip(facet[12..48].chunks_exact(12)) {
            let v = floats(raw);
            if !v.is_finite() {
                return Err(Diagnostic::new(
                    file,
                    None,
                    format!("triangle {i} (from 0) has a corner that is not finite: {v:?}"),
                )
                .hint("finite numbers; export the mesh again"));
            }
            *corner = builder.vertex(v);
        }
        builder.mesh.triangles.push(triangle);
    }
    Ok(LoadedMeshes { meshes: vec![builder.mesh], warnings })
}

fn floats(raw: &[u8]) -> Vec3 {
    let at = |i: usize| f64::from(f32::from_le_bytes([raw[i], raw[i + 1], raw[i + 2], raw[i + 3]]));
    Vec3::new(at(0), at(4), at(8))
}

struct AsciiReader<'a> {
    words: Tokens<'a>,
    file: &'a Path,
    warnings: WarningList,
}

fn parse_ascii(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    let mut reader = AsciiReader { words: Tokens::new(bytes), file, warnings: WarningList::default() };
    let mut meshes = Vec::new();
    while let Some(word) = reader.words.next() {
        if !word.eq_ignore_ascii_case(b"solid") {
            return Err(reader.unexpected(word, "solid NAME"));
        }
        let mesh = reader.solid()?;
        if mesh.triangles.is_empty() {
            let what = format!("the solid `{}` has no triangles and is left out", mesh.name);
            reader.warnings.push(Diagnostic::new(file, reader.words.line(), what));
        } else {
            meshes.push(mesh);
        }
    }
    Ok(LoadedMeshes { meshes, warnings: reader.warnings.finish(file) })
}

impl AsciiReader<'_> {
    fn unexpected(&self, word: &[u8], instead: &str) -> Diagnostic {
        Diagnostic::new(self.file, self.words.line(), format!("`{}` does not belong here", show(word))).hint(instead)
    }

    fn expect(&mut self, keyword: &str) -> Result<(), Diagnostic> {
        match self.words.next() {
            Some(word) if word.eq_ignore_ascii_case(keyword.as_bytes()) => Ok(()),
            Some(word) => Err(self.unexpected(word, keyword)),
            None => Err(self.truncated(keyword)),
        }
    }

    fn truncated(&self, missing: &str) -> Diagnostic {
        Diagnostic::new(self.file, self.words.line(), format!("the file ends in the middle: `{missing}` is missing"))
            .hint("copy or export the file again")
    }

    fn solid(&mut self) -> Result<MeshData, Diagnostic> {
        let name = String::from_utf8_lossy(self.words.rest_of_line()).into_owned();
        let mut builder = VertexMerger::default();
        builder.mesh.name = if name.is_empty() { input::stem(self.file) } else { name };
        loop {
            match self.words.next() {
                Some(word) if word.eq_ignore_ascii_case(b"facet") => self.facet(&mut builder)?,
                Some(word) if word.eq_ignore_ascii_case(b"endsolid") => {
                    self.words.rest_of_line();
                    break;
                }
                Some(word) => return Err(self.unexpected(word, "facet normal …, or endsolid")),
                None => {
                    let what =
                        format!("the solid `{}` is not closed: the end of the file may be missing", builder.mesh.name);
                    self.warnings.push(Diagnostic::new(self.file, self.words.line(), what).hint("endsolid"));
                    break;
                }
            }
        }
        Ok(builder.mesh)
    }

    fn facet(&mut self, builder: &mut VertexMerger) -> Result<(), Diagnostic> {
        // The normal is not used and may be anything, including `-nan(ind)`.
        let mut words_of_normal = 0;
        while self.words.peek().is_some_and(|w| !w.eq_ignore_ascii_case(b"outer")) && words_of_normal < 4 {
            self.words.next();
            words_of_normal += 1;
        }
        self.expect("outer")?;
        self.expect("loop")?;
        let mut corners = Vec::new();
        loop {
            match self.words.next() {
                Some(word) if word.eq_ignore_ascii_case(b"vertex") => {
                    let line = self.words.line();
                    let v = vector(&mut self.words, self.file, line, "the vertex")?;
                    corners.push(builder.vertex(v));
                }
                Some(word) if word.eq_ignore_ascii_case(b"endloop") => break,
                Some(word) => return Err(self.unexpected(word, "vertex x y z, or endloop")),
                None => return Err(self.truncated("endloop")),
            }
        }
        if corners.len() < 3 {
            let what = format!("a facet has {} corners", corners.len());
            return Err(Diagnostic::new(self.file, self.words.line(), what).hint("three lines: vertex x y z"));
        }
        polygon::triangulate(&builder.mesh.vertices, &corners, &mut builder.mesh.triangles);
        self.expect("endfacet")
    }
}

/// Writes a binary STL of all meshes together. Numbers are metres, rounded to single precision as the format requires.
///
/// # Errors
/// The errors of the writer; [`io::ErrorKind::InvalidInput`] for an index out of range or more than 2³² triangles.
///
/// ```
/// use elbowroom_formats::{MeshData, stl};
/// use elbowroom_spatial::Vec3;
/// let mesh =
///     MeshData { name: "flag".into(), vertices: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]] };
/// let mut bytes = Vec::new();
/// stl::write_binary(&mut bytes, &[mesh])?;
/// assert_eq!(bytes.len(), 84 + 50);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_binary(out: &mut impl Write, meshes: &[MeshData]) -> io::Result<()> {
    let count: usize = meshes.iter().map(|m| m.triangles.len()).sum();
    let count = u32::try_from(count).map_err(|_| io::Error::new(io::ErrorKind::InvalidInput, "too many triangles"))?;
    let mut header = [b' '; 80];
    header[..19].copy_from_slice(b"binary STL, metres ");
    out.write_all(&header)?;
    out.write_all(&count.to_le_bytes())?;
    for mesh in meshes {
        for triangle in &mesh.triangles {
            write_facet(out, mesh, triangle)?;
        }
    }
    Ok(())
}

fn write_facet(out: &mut impl Write, mesh: &MeshData, triangle: &[u32; 3]) -> io::Result<()> {
    let corner = |i: u32| {
        let found = mesh.vertices.get(i as usize).copied();
        found.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "a triangle's corner does not exist"))
    };
    let corners = [corner(triangle[0])?, corner(triangle[1])?, corner(triangle[2])?];
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize().unwrap_or(Vec3::ZERO);
    let mut facet = [0; FACET];
    for (slot, v) in facet.chunks_exact_mut(12).zip([normal, corners[0], corners[1], corners[2]]) {
        for (bytes, x) in slot.chunks_exact_mut(4).zip(v.to_array()) {
            bytes.copy_from_slice(&(x as f32).to_le_bytes());
        }
    }
    out.write_all(&facet)
}
