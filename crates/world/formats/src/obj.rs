//! Wavefront OBJ: polygons of any size, relative indices, continued lines.
//!
//! The result has one entry per object: by `o` if the file has any, else by `g`. A repeated name continues its object.
//! Materials, normals, texture coordinates, points and lines are ignored. Unknown statements are ignored with a warning.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::mesh_data::{LoadedMeshes, MeshData, split_vertices};
use crate::tokens::{Lines, integer, show, vector};
use crate::warning_list::WarningList;
use crate::{Diagnostic, input, polygon};

/// Largest number of different unknown words with a warning.
const MAX_UNKNOWN_WORDS: usize = 20;

/// Parses an OBJ file. Numbers are metres.
///
/// # Errors
/// [`Diagnostic`] for faces without corners, missing vertices, invalid numbers, or a file with unknown statements only.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text_bytes(bytes, file)?;
    let joined = join_lines(&text);
    let mut parser = ObjParser::new(file);
    for (line, content) in Lines::new(&joined) {
        let content = content.split(|&b| b == b'#').next().unwrap_or(content).trim_ascii();
        if !content.is_empty() {
            parser.statement(line, content)?;
        }
    }
    parser.finish()
}

/// Joins lines that end with a backslash to the next line.
///
/// Their line ends follow after the joined line, so that later lines keep their numbers.
fn join_lines(text: &[u8]) -> std::borrow::Cow<'_, [u8]> {
    if !text.contains(&b'\\') {
        return text.into();
    }
    let mut joined = Vec::with_capacity(text.len());
    let (mut owed, mut i) = (0, 0);
    while i < text.len() {
        let ending = [&b"\r\n"[..], b"\n", b"\r"].into_iter().find(|e| text[i + 1..].starts_with(e));
        match (text[i], ending) {
            (b'\\', Some(ending)) => {
                joined.push(b' ');
                owed += 1;
                i += 1 + ending.len();
            }
            (b, _) => {
                joined.push(b);
                if b == b'\n' {
                    joined.resize(joined.len() + std::mem::take(&mut owed), b'\n');
                }
                i += 1;
            }
        }
    }
    joined.into()
}

struct Face {
    object: usize,
    line: usize,
    /// End of its corners in `corners`; they begin at the end of the previous face.
    end: usize,
}

struct ObjParser<'a> {
    file: &'a Path,
    vertices: Vec<Vec3>,
    corners: Vec<u32>,
    faces: Vec<Face>,
    names: Vec<String>,
    index_of: HashMap<String, usize>,
    object: usize,
    has_objects: bool,
    /// Line and word of the first statement that OBJ does not define.
    first_unknown: Option<(usize, String)>,
    unknown_words: HashSet<String>,
    warnings: WarningList,
}

impl<'a> ObjParser<'a> {
    fn new(file: &'a Path) -> Self {
        let name = input::stem(file);
        Self {
            file,
            vertices: Vec::new(),
            corners: Vec::new(),
            faces: Vec::new(),
            index_of: HashMap::new(),
            names: vec![name],
            object: 0,
            has_objects: false,
            first_unknown: None,
            unknown_words: HashSet::new(),
            warnings: WarningList::default(),
        }
    }

    fn statement(&mut self, line: usize, content: &[u8]) -> Result<(), Diagnostic> {
        let mut words = content.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        match words.next() {
            Some(b"v") => self.vertices.push(vector(&mut words, self.file, line, "the vertex")?),
            Some(b"f" | b"fo") => self.face(line, words)?,
            Some(b"o") => self.object_statement(&content[1..]),
            Some(b"g") if !self.has_objects => self.select(&content[1..]),
            Some(b"surf" | b"curv" | b"curv2") => self.warnings.push_with(|| {
                Diagnostic::new(self.file, line, "a free-form curve or surface is ignored").hint("polygons: f 1 2 3")
            }),
            Some(word) if !is_keyword(word) => self.unknown(line, word),
            _ => {}
        }
        Ok(())
    }

    /// Warns about a statement that OBJ does not define, once per word.
    fn unknown(&mut self, line: usize, word: &[u8]) {
        let word = show(word);
        self.first_unknown.get_or_insert_with(|| (line, word.clone()));
        if self.unknown_words.len() < MAX_UNKNOWN_WORDS && self.unknown_words.insert(word.clone()) {
            let what = format!("`{word}` is no OBJ statement: such lines are skipped");
            self.warnings.push_with(|| Diagnostic::new(self.file, line, what));
        }
    }

    /// The first `o` merges the groups before it: objects take precedence over groups.
    fn object_statement(&mut self, name: &[u8]) {
        if !self.has_objects {
            self.has_objects = true;
            self.names.truncate(1);
            self.index_of.clear();
            self.faces.iter_mut().for_each(|f| f.object = 0);
        }
        self.select(name);
    }

    fn select(&mut self, name: &[u8]) {
        let name = String::from_utf8_lossy(name.trim_ascii()).into_owned();
        let next = self.names.len();
        self.object = *self.index_of.entry(name.clone()).or_insert(next);
        if self.object == next {
            self.names.push(if name.is_empty() { "default".to_owned() } else { name });
        }
    }

    fn face<'w>(&mut self, line: usize, words: impl Iterator<Item = &'w [u8]>) -> Result<(), Diagnostic> {
        let begin = self.corners.len();
        for word in words {
            let corner = self.corner(line, word)?;
            self.corners.push(corner);
        }
        match self.corners.len() - begin {
            0 => Err(Diagnostic::new(self.file, line, "a face without corners").hint("f 1 2 3")),
            1 | 2 => {
                self.corners.truncate(begin);
                self.warnings
                    .push_with(|| Diagnostic::new(self.file, line, "a face with fewer than 3 corners is left out"));
                Ok(())
            }
            _ => {
                self.faces.push(Face { object: self.object, line, end: self.corners.len() });
                Ok(())
            }
        }
    }

    fn corner(&self, line: usize, word: &[u8]) -> Result<u32, Diagnostic> {
        let index = word.split(|&b| b == b'/').next().and_then(integer).ok_or_else(|| {
            let what = format!("`{}` is not a corner of a face", show(word));
            Diagnostic::new(self.file, line, what)
                .hint("the number of a vertex, from 1: f 1 2 3, or f 1/1/1 2/2/1 3/3/1")
        })?;
        let known = i64::try_from(self.vertices.len()).unwrap_or(i64::MAX);
        let from_zero = if index < 0 { known.saturating_add(index) } else { index - 1 };
        // Vertices may follow later, so only negative indices are refused here.
        u32::try_from(from_zero).map_err(|_| {
            let what = format!("the corner {index} does not exist: there are {known} vertices before this line");
            Diagnostic::new(self.file, line, what).hint("vertices count from 1; -1 is the last one before the line")
        })
    }

    fn finish(self) -> Result<LoadedMeshes, Diagnostic> {
        let mut meshes: Vec<MeshData> =
            self.names.into_iter().map(|name| MeshData { name, ..MeshData::default() }).collect();
        let known = self.vertices.len();
        let mut begin = 0;
        for face in &self.faces {
            let corners = &self.corners[begin..face.end];
            if let Some(i) = corners.iter().find(|&&i| i as usize >= known) {
                let what = format!("the corner {} does not exist: the file has {known} vertices", u64::from(*i) + 1);
                return Err(Diagnostic::new(self.file, face.line, what).hint("the number of a vertex, counted from 1"));
            }
            polygon::triangulate(&self.vertices, corners, &mut meshes[face.object].triangles);
            begin = face.end;
        }
        if let (0, Some((line, word))) = (known, &self.first_unknown) {
            let what = format!("`{word}` is no OBJ statement: is this an OBJ file?");
            return Err(Diagnostic::new(self.file, *line, what).hint("v x y z, then f 1 2 3"));
        }
        if self.faces.is_empty() && known > 0 {
            let what = format!("is a point cloud: {known} vertices, no faces");
            return Err(Diagnostic::new(self.file, None, what).hint("faces: f 1 2 3"));
        }
        meshes.retain(|m| !m.triangles.is_empty());
        split_vertices(&self.vertices, &mut meshes);
        Ok(LoadedMeshes { meshes, warnings: self.warnings.finish(self.file) })
    }
}

/// True for a known statement of OBJ, read or ignored: from the format's description, or a former one.
fn is_keyword(word: &[u8]) -> bool {
    const KEYWORDS: &[&str] = &[
        "v",
        "vt",
        "vn",
        "vp",
        "f",
        "fo",
        "l",
        "p",
        "o",
        "g",
        "s",
        "mg",
        "mtllib",
        "usemtl",
        "maplib",
        "usemap",
        "lod",
        "bevel",
        "c_interp",
        "d_interp",
        "shadow_obj",
        "trace_obj",
        "ctech",
        "stech",
        "deg",
        "cstype",
        "bmat",
        "step",
        "curv",
        "curv2",
        "surf",
        "parm",
        "trim",
        "hole",
        "scrv",
        "sp",
        "end",
        "con",
        "call",
        "scmp",
        "csh",
        "bsp",
        "bzp",
        "cdc",
        "cdp",
        "res",
    ];
    KEYWORDS.iter().any(|k| k.as_bytes() == word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_lines_keep_later_line_numbers() {
        let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 \\\r\n 3\nf 1 2 9\n";
        let error = parse(text, Path::new("a.obj")).unwrap_err();
        assert_eq!(error.line, Some(7));
        let valid = parse(&text[..text.len() - 8], Path::new("a.obj")).unwrap();
        assert_eq!(valid.meshes[0].triangles, [[0, 1, 2]]);
    }

    #[test]
    fn unknown_statements_are_skipped_with_a_warning_each() {
        let text = "exported by x\nv 0 0 0\nv 1 0 0\nv 0 1 0\ntag 1\nf 1 2 3\ntag 2\nparm u 0 1\nend\n";
        let loaded = parse(text.as_bytes(), Path::new("a.obj")).unwrap();
        assert_eq!(loaded.meshes[0].triangles, [[0, 1, 2]]);
        let warned: Vec<_> = loaded.warnings.iter().map(|w| (w.line, w.message.as_str())).collect();
        let skipped = |line, word| (Some(line), format!("`{word}` is no OBJ statement: such lines are skipped"));
        let expected = [skipped(1, "exported"), skipped(5, "tag")];
        assert_eq!(warned, expected.each_ref().map(|(line, what)| (*line, what.as_str())));
        // A file without vertices is not an OBJ file.
        let error = parse(b"\nhello world\n", Path::new("a.obj")).unwrap_err();
        assert!(error.line == Some(2) && error.message.contains("is this an OBJ file?"), "{error}");
    }

    #[test]
    fn groups_divide_only_where_there_are_no_objects() {
        let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        let load = |faces: &str| parse(format!("{vertices}{faces}").as_bytes(), Path::new("a.obj")).unwrap();
        let groups = load("g a\nf 1 2 3\ng b\nusemtl m\nf -3 -2 -1\ng a\nf 3 2 1\n");
        let sizes: Vec<_> = groups.meshes.iter().map(|m| (m.name.as_str(), m.triangles.len())).collect();
        assert_eq!(sizes, [("a", 2), ("b", 1)]);
        let objects = load("g a\nf 1 2 3\no x\ng b\nf 1 2 3\ng c\nf 3 2 1\n");
        let sizes: Vec<_> = objects.meshes.iter().map(|m| (m.name.as_str(), m.triangles.len())).collect();
        assert_eq!(sizes, [("a", 1), ("x", 2)]);
    }
}
