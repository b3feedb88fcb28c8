//! Object File Format, ASCII: `OFF`, with the prefixes `ST`, `C` and `N`, whose numbers are ignored.

use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::mesh_data::{LoadedMeshes, MeshData};
use crate::tokens::{Lines, integer, show, vector};
use crate::{Diagnostic, input, polygon};

pub(crate) fn is_header(head: &[u8]) -> bool {
    let word = head.split(|b| b.is_ascii_whitespace() || *b == b'#').next().unwrap_or_default();
    word.strip_suffix(b"OFF").is_some_and(|prefix| prefix.len() <= 5 && prefix.iter().all(|b| b"STCN4n".contains(b)))
}

/// Parses an OFF file. Numbers are metres.
///
/// # Errors
/// [`Diagnostic`] for declared counts that the file cannot hold, missing vertices, invalid numbers, or binary OFF.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text_bytes(bytes, file)?;
    let mut lines = Lines::new(&text);
    let (vertex_count, face_count) = counts(&mut lines, file)?;
    let mut vertices = Vec::with_capacity(vertex_count);
    for i in 0..vertex_count {
        let (line, content) = next(&mut lines, file, || format!("vertex {} of {vertex_count}", i + 1))?;
        vertices.push(vector(&mut words(content), file, line, "the vertex")?);
    }
    let mut triangles = Vec::with_capacity(face_count);
    let mut corners = Vec::new();
    for i in 0..face_count {
        let (line, content) = next(&mut lines, file, || format!("face {} of {face_count}", i + 1))?;
        let wrong = |what: String| {
            Diagnostic::new(file, line, what)
                .hint("the number of corners, then as many vertices counted from 0: 3 0 1 2")
        };
        read_face(content, &vertices, &mut corners, wrong)?;
        polygon::triangulate(&vertices, &corners, &mut triangles);
    }
    let mesh = MeshData { name: input::stem(file), vertices, triangles };
    Ok(LoadedMeshes { meshes: vec![mesh], warnings: Vec::new() })
}

fn words(content: &[u8]) -> impl Iterator<Item = &[u8]> {
    content.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

fn next<'a>(lines: &mut Lines<'a>, file: &Path, of: impl Fn() -> String) -> Result<(usize, &'a [u8]), Diagnostic> {
    lines.next_content().ok_or_else(|| {
        Diagnostic::new(file, lines.line(), format!("the file ends before {}", of()))
            .hint("copy or export the file again")
    })
}

/// The numbers of vertices and faces, on the header's line or the next line.
///
/// Counts that the file cannot hold are refused before memory is allocated.
fn counts(lines: &mut Lines<'_>, file: &Path) -> Result<(usize, usize), Diagnostic> {
    let (mut line, mut content) = next(lines, file, || "its counts".to_owned())?;
    let mut rest: Vec<&[u8]> = words(content).collect();
    if is_header(content) {
        let header = rest.remove(0);
        if header.contains(&b'4') || header.contains(&b'n') {
            let what = format!("`{}`: only three dimensions can be read", show(header));
            return Err(Diagnostic::new(file, line, what).hint("OFF"));
        }
        if rest.first().is_some_and(|w| w.eq_ignore_ascii_case(b"BINARY")) {
            return Err(
                Diagnostic::new(file, line, "binary OFF is not read").hint("the mesh exported as ASCII OFF or STL")
            );
        }
        if rest.is_empty() {
            (line, content) = next(lines, file, || "its counts".to_owned())?;
            rest = words(content).collect();
        }
    }
    let count = |i: usize, of: &str| {
        rest.get(i).and_then(|w| integer(w)).and_then(|n| usize::try_from(n).ok()).ok_or_else(|| {
            Diagnostic::new(file, line, format!("the number of {of} is missing"))
                .hint("VERTICES FACES EDGES, such as 8 6 12")
        })
    };
    let (vertices, faces) = (count(0, "vertices")?, count(1, "faces")?);
    // The shortest vertex is `0 0 0` and a line end, the shortest face `0` and a line end.
    let needed = vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2));
    if needed > lines.remaining_bytes() + 2 {
        let what = format!(
            "announces {vertices} vertices and {faces} faces, but has only {} bytes left for them",
            lines.remaining_bytes()
        );
        return Err(
            Diagnostic::new(file, line, what).hint("the true counts: VERTICES FACES EDGES; or copy the file again")
        );
    }
    Ok((vertices, faces))
}

/// Reads the corners of a face; `wrong` makes the diagnostic of its line.
fn read_face(
    content: &[u8],
    vertices: &[Vec3],
    corners: &mut Vec<u32>,
    wrong: impl Fn(String) -> Diagnostic,
) -> Result<(), Diagnostic> {
    let mut words = words(content);
    let number = words.next().unwrap_or_default();
    let size = integer(number).and_then(|n| usize::try_from(n).ok());
    let size = size.ok_or_else(|| wrong(format!("`{}` is no number of corners", show(number))))?;
    if size < 3 {
        return Err(wrong(format!("a face with {size} corners")));
    }
    corners.clear();
    for _ in 0..size {
        let too_few = || wrong(format!("a face of {size} corners lists only {}", corners.len()));
        let word = words.next().ok_or_else(too_few)?;
        let index = integer(word).and_then(|i| u32::try_from(i).ok()).filter(|&i| (i as usize) < vertices.len());
        let missing = || wrong(format!("the corner `{}` does not exist: {} vertices", show(word), vertices.len()));
        corners.push(index.ok_or_else(missing)?);
    }
    Ok(())
}
