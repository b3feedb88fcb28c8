//! The header: elements and their properties.

use std::path::Path;

use crate::Diagnostic;
use crate::tokens::show;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ScalarType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl ScalarType {
    fn parse(word: &str) -> Option<Self> {
        Some(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: ScalarType,
    /// Type of the count before a list; `None` for a single value.
    pub(super) list_count: Option<ScalarType>,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
    pub(super) line: usize,
}

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Number of lines of the header.
    pub(super) lines: usize,
}

impl Header {
    pub(super) fn line_of(&self, element: &str) -> Option<usize> {
        self.elements.iter().find(|e| e.name == element).map(|e| e.line)
    }
}

/// Parses the header, and returns it with the body.
pub(super) fn parse<'a>(bytes: &'a [u8], file: &Path) -> Result<(Header, &'a [u8]), Diagnostic> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut rest = bytes;
    let mut line = 0;
    loop {
        let Some((text, after)) = split_line(rest) else {
            return Err(Diagnostic::new(file, line, "the header does not end").hint("end_header"));
        };
        rest = after;
        line += 1;
        let bad = |what: String, hint: &str| Err(Diagnostic::new(file, line, what).hint(hint));
        let Ok(text) = std::str::from_utf8(text).map(str::trim) else {
            return bad("the header is damaged: a line is not text".into(), "copy or export the file again");
        };
        let tokens: Vec<&str> = text.split_ascii_whitespace().collect();
        match tokens[..] {
            [] | ["comment" | "obj_info", ..] => {}
            ["ply"] if line == 1 => {}
            ["format", name, _version] => match name {
                "ascii" => encoding = Some(Encoding::Ascii),
                "binary_little_endian" => encoding = Some(Encoding::LittleEndian),
                "binary_big_endian" => encoding = Some(Encoding::BigEndian),
                _ => return bad(format!("unknown format `{}`", show(name.as_bytes())), "format ascii 1.0"),
            },
            ["element", name, count] => elements.push(element(name, count, &elements, file, line)?),
            ["property", ref of @ ..] => match (property(of), elements.last_mut()) {
                (Some(property), Some(element)) => element.properties.push(property),
                (None, _) => {
                    return bad(
                        format!("`{}` is no property", show(text.as_bytes())),
                        "property float x, or property list uchar int vertex_indices",
                    );
                }
                (_, None) => return bad("a property before any element".into(), "element vertex 8"),
            },
            ["end_header"] => break,
            _ => {
                return bad(
                    format!("`{}` is no line of a header", show(text.as_bytes())),
                    "format ascii 1.0, element vertex 8, property float x, … end_header",
                );
            }
        }
    }
    let missing = || Diagnostic::new(file, line, "the header does not state its format").hint("format ascii 1.0");
    Ok((Header { encoding: encoding.ok_or_else(missing)?, elements, lines: line }, rest))
}

/// Splits off the first line. Lines end with `\n`, `\r\n` or `\r`.
fn split_line(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let length = bytes.iter().position(|&b| b == b'\n' || b == b'\r')?;
    let (line, rest) = bytes.split_at(length);
    Some((line, rest.strip_prefix(b"\r\n").unwrap_or(&rest[1..])))
}

fn element(name: &str, count: &str, before: &[Element], file: &Path, line: usize) -> Result<Element, Diagnostic> {
    if let Some(first) = before.iter().find(|e| e.name == name) {
        let what = format!("a second element `{}`; the first is on line {}", show(name.as_bytes()), first.line);
        return Err(Diagnostic::new(file, line, what).hint("one element of each name"));
    }
    let count = count.parse().map_err(|_| {
        Diagnostic::new(file, line, format!("`{}` is no count", show(count.as_bytes())))
            .hint(format!("element {name} 8"))
    })?;
    Ok(Element { name: name.to_owned(), count, properties: Vec::new(), line })
}

fn property(tokens: &[&str]) -> Option<Property> {
    match *tokens {
        ["list", count, kind, name] => Some(Property {
            name: name.to_owned(),
            kind: ScalarType::parse(kind)?,
            list_count: Some(ScalarType::parse(count)?),
        }),
        [kind, name] => Some(Property { name: name.to_owned(), kind: ScalarType::parse(kind)?, list_count: None }),
        _ => None,
    }
}
