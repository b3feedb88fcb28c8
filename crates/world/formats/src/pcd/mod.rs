//! PCD, the format of the Point Cloud Library: ASCII, binary and LZF-compressed.

mod lzf;

use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::Diagnostic;
use crate::tokens::show;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Ascii,
    Binary,
    Compressed,
}

/// Number type of a field (TYPE).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NumberType {
    Float,
    Signed,
    Unsigned,
}

/// A field of a point: its type, and its offset in the bytes or words of the point.
#[derive(Debug, Clone, Copy)]
struct Field {
    kind: NumberType,
    size: usize,
    count: usize,
    first_byte: usize,
    first_word: usize,
}

struct Header {
    fields: Vec<Field>,
    xyz: [Field; 3],
    points: usize,
    encoding: Encoding,
    /// Line number of DATA, counted from 1.
    line: usize,
}

/// Parses the points of a PCD file as written.
///
/// Numbers are metres; sensors write NaN for points that they did not measure.
///
/// # Errors
/// [`Diagnostic`] for invalid headers, more declared points than the file can hold, damaged compression, or words that
/// are not numbers.
pub fn parse_points(bytes: &[u8], file: &Path) -> Result<Vec<Vec3>, Diagnostic> {
    if bytes.is_empty() {
        return Err(Diagnostic::new(file, None, "is empty").hint("a PCD header and points"));
    }
    let (header, body) = header(bytes, file)?;
    match header.encoding {
        Encoding::Ascii => ascii(&header, body, file),
        Encoding::Binary => binary(&header, body, file),
        Encoding::Compressed => compressed(&header, body, file),
    }
}

fn header<'a>(bytes: &'a [u8], file: &Path) -> Result<(Header, &'a [u8]), Diagnostic> {
    let mut lists: [Vec<&str>; 4] = Default::default(); // FIELDS, SIZE, TYPE, COUNT
    let (mut width, mut height, mut points) = (None, None, None);
    let mut rest = bytes;
    let mut line = 0;
    loop {
        line += 1;
        let Some(end) = rest.iter().position(|&b| b == b'\n') else {
            return Err(Diagnostic::new(file, line, "the header does not end").hint("DATA ascii, or DATA binary"));
        };
        let text = std::str::from_utf8(&rest[..end]).map_err(|_| {
            Diagnostic::new(file, line, "the header is damaged: a line is not text").hint("copy the file again")
        })?;
        rest = &rest[end + 1..];
        let mut words = text.split_ascii_whitespace();
        let count = |words: &mut std::str::SplitAsciiWhitespace<'_>| {
            let word = words.next().unwrap_or_default();
            word.parse::<usize>().map(Some).map_err(|_| {
                Diagnostic::new(file, line, format!("`{}` is no count", show(word.as_bytes()))).hint("a whole number")
            })
        };
        match words.next() {
            Some("FIELDS") => lists[0] = words.collect(),
            Some("SIZE") => lists[1] = words.collect(),
            Some("TYPE") => lists[2] = words.collect(),
            Some("COUNT") => lists[3] = words.collect(),
            Some("WIDTH") => width = count(&mut words)?,
            Some("HEIGHT") => height = count(&mut words)?,
            Some("POINTS") => points = count(&mut words)?,
            Some("DATA") => {
                let encoding = encoding(words.next().unwrap_or_default(), file, line)?;
                let product = width.zip(height).and_then(|(w, h): (usize, usize)| w.checked_mul(h));
                let points = points.or(product).ok_or_else(|| {
                    Diagnostic::new(file, line, "the header does not state the number of points").hint("POINTS 8")
                })?;
                let fields = fields(&lists, file, line)?;
                let xyz = coordinates(&lists[0], &fields, file, line)?;
                return Ok((Header { fields, xyz, points, encoding, line }, rest));
            }
            // Comments, VERSION, VIEWPOINT, and keywords of later versions.
            _ => {}
        }
    }
}

fn encoding(word: &str, file: &Path, line: usize) -> Result<Encoding, Diagnostic> {
    match word {
        "ascii" => Ok(Encoding::Ascii),
        "binary" => Ok(Encoding::Binary),
        "binary_compressed" => Ok(Encoding::Compressed),
        _ => Err(Diagnostic::new(file, line, format!("DATA `{}` is unknown", show(word.as_bytes())))
            .hint("DATA ascii, DATA binary or DATA binary_compressed")),
    }
}

fn fields(lists: &[Vec<&str>; 4], file: &Path, line: usize) -> Result<Vec<Field>, Diagnostic> {
    let [names, sizes, kinds, counts] = lists;
    let inconsistent = |what: String| {
        Diagnostic::new(file, line, what).hint("FIELDS x y z, SIZE 4 4 4, TYPE F F F, COUNT 1 1 1: one word per field")
    };
    if names.is_empty() || sizes.len() != names.len() || kinds.len() != names.len() {
        let (n, s, k) = (names.len(), sizes.len(), kinds.len());
        return Err(inconsistent(format!("{n} fields, {s} sizes and {k} types")));
    }
    let (mut first_byte, mut first_word) = (0_usize, 0_usize);
    let mut fields = Vec::new();
    for i in 0..names.len() {
        let size = sizes[i].parse::<usize>().ok().filter(|size| [1, 2, 4, 8].contains(size));
        let count = counts.get(i).map_or(Some(1), |c| c.parse::<usize>().ok().filter(|&c| c <= 1 << 20));
        let kind = match kinds[i] {
            "F" => Some(NumberType::Float),
            "I" => Some(NumberType::Signed),
            "U" => Some(NumberType::Unsigned),
            _ => None,
        };
        let (Some(size), Some(count), Some(kind)) = (size, count, kind) else {
            return Err(inconsistent(format!(
                "the field `{}` has an unknown size, type or count",
                show(names[i].as_bytes())
            )));
        };
        fields.push(Field { kind, size, count, first_byte, first_word });
        first_byte += size * count;
        first_word += count;
    }
    Ok(fields)
}

fn coordinates(names: &[&str], fields: &[Field], file: &Path, line: usize) -> Result<[Field; 3], Diagnostic> {
    let mut found = [fields[0]; 3];
    for (slot, name) in found.iter_mut().zip(["x", "y", "z"]) {
        let index = names.iter().position(|n| *n == name).filter(|&i| fields[i].count == 1);
        let index = index
            .ok_or_else(|| Diagnostic::new(file, line, format!("the points have no {name}")).hint("FIELDS x y z …"))?;
        *slot = fields[index];
    }
    Ok(found)
}

/// Refuses counts that the remaining bytes cannot hold.
fn check_remaining(header: &Header, bytes_per_point: usize, left: usize, file: &Path) -> Result<(), Diagnostic> {
    if header.points.checked_mul(bytes_per_point).is_some_and(|needed| needed <= left) {
        return Ok(());
    }
    let what = format!("{} points are announced, but only {left} bytes are left for them", header.points);
    Err(Diagnostic::new(file, header.line, what).hint("the true number of points; or copy or export the file again"))
}

fn ascii(header: &Header, body: &[u8], file: &Path) -> Result<Vec<Vec3>, Diagnostic> {
    let per_point: usize = header.fields.iter().map(|f| f.count).sum();
    check_remaining(header, 2 * per_point, body.len() + 1, file)?;
    let mut points = Vec::with_capacity(header.points);
    let mut lines = body.split(|&b| b == b'\n').enumerate();
    while points.len() < header.points {
        let Some((i, text)) = lines.next() else {
            let what = format!("the file ends after {} of {} points", points.len(), header.points);
            return Err(Diagnostic::new(file, header.line, what).hint("copy or export the file again"));
        };
        let line = header.line + 1 + i;
        let words = || text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        if words().next().is_none() {
            continue;
        }
        let mut p = [0.0; 3];
        for (value, field) in p.iter_mut().zip(&header.xyz) {
            let word = words().nth(field.first_word);
            let number = word.and_then(|w| std::str::from_utf8(w).ok()).and_then(|w| w.parse::<f64>().ok());
            *value = number.ok_or_else(|| {
                Diagnostic::new(file, line, format!("`{}` is no point", show(text)))
                    .hint("numbers in the order of FIELDS; nan where nothing was measured")
            })?;
        }
        points.push(p.into());
    }
    Ok(points)
}

fn binary(header: &Header, body: &[u8], file: &Path) -> Result<Vec<Vec3>, Diagnostic> {
    let stride: usize = header.fields.iter().map(|f| f.size * f.count).sum();
    check_remaining(header, stride, body.len(), file)?;
    let point = |record: &[u8]| Vec3::from(header.xyz.map(|field| number(&record[field.first_byte..], field)));
    Ok(body.chunks_exact(stride).take(header.points).map(point).collect())
}

/// Reads all points of one compressed block, which is stored field by field instead of point by point.
fn compressed(header: &Header, body: &[u8], file: &Path) -> Result<Vec<Vec3>, Diagnostic> {
    let stride: usize = header.fields.iter().map(|f| f.size * f.count).sum();
    let damaged = || {
        Diagnostic::new(file, header.line, "the compressed points are damaged or cut off")
            .hint("copy or export the file again")
    };
    let size = |from: usize| body.get(from..from + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let (packed, unpacked) = size(0).zip(size(4)).ok_or_else(damaged)?;
    let packed = body.get(8..).and_then(|b| b.get(..packed as usize)).ok_or_else(damaged)?;
    let expected = header.points.checked_mul(stride).ok_or_else(damaged)?;
    if expected != unpacked as usize {
        let what = format!("{} points need {expected} bytes, but {unpacked} are packed", header.points);
        return Err(Diagnostic::new(file, header.line, what).hint("the true number of points"));
    }
    let bytes = lzf::decompress(packed, expected).ok_or_else(damaged)?;
    let point = |i: usize| {
        Vec3::from(header.xyz.map(|field| number(&bytes[field.first_byte * header.points + i * field.size..], field)))
    };
    Ok((0..header.points).map(point).collect())
}

/// A little-endian number of a field.
fn number(bytes: &[u8], field: Field) -> f64 {
    let mut le = [0; 8];
    le[..field.size].copy_from_slice(&bytes[..field.size]);
    let [a, b, c, d, ..] = le;
    match (field.kind, field.size) {
        (NumberType::Float, 4) => f64::from(f32::from_le_bytes([a, b, c, d])),
        (NumberType::Float, 8) => f64::from_le_bytes(le),
        (NumberType::Signed, 1) => f64::from(a.cast_signed()),
        (NumberType::Signed, 2) => f64::from(i16::from_le_bytes([a, b])),
        (NumberType::Signed, 4) => f64::from(i32::from_le_bytes([a, b, c, d])),
        (NumberType::Signed, 8) => i64::from_le_bytes(le) as f64,
        (NumberType::Unsigned, _) => u64::from_le_bytes(le) as f64,
        _ => f64::NAN,
    }
}
