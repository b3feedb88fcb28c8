//! Bytes and text of a file, with the checks that all formats share.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::Diagnostic;

/// Largest size of a model file, which bounds memory, bytes.
const MAX_BYTES: u64 = 1 << 30;

/// Reads the file of a model or mesh.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Diagnostic> {
    read_file(path, MAX_BYTES, "a coarser mesh: collision checking needs thousands of triangles, not millions")
}

/// Reads a whole regular file. Refuses directories, devices and pipes, which may never end.
///
/// # Errors
/// [`Diagnostic`] if the file cannot be read, is not a regular file, or has more than `max_bytes` bytes. In the last
/// case `smaller` is the hint.
pub fn read_file(path: &Path, max_bytes: u64, smaller: &str) -> Result<Vec<u8>, Diagnostic> {
    let cannot = |e: std::io::Error| Diagnostic::unreadable(path, &e, "the path of a file that is there");
    let meta = std::fs::metadata(path).map_err(cannot)?;
    if !meta.is_file() {
        return Err(Diagnostic::new(path, None, "is not a file").hint("the path of a file, not of a directory"));
    }
    if meta.len() > max_bytes {
        let what = format!("has {} bytes, more than the {max_bytes} allowed", meta.len());
        return Err(Diagnostic::new(path, None, what).hint(smaller));
    }
    let mut bytes = Vec::with_capacity(meta.len() as usize);
    File::open(path).and_then(|f| f.take(max_bytes).read_to_end(&mut bytes)).map_err(cannot)?;
    Ok(bytes)
}

/// Refuses empty files, Git LFS pointers, archives, and STEP files.
pub(crate) fn check_content(bytes: &[u8], file: &Path) -> Result<(), Diagnostic> {
    let refuse = |what: &str, hint: &str| Err(Diagnostic::new(file, None, what).hint(hint));
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return refuse("is empty", "export the model again: nothing arrived in the file");
    }
    if bytes.starts_with(b"version https://git-lfs") {
        return Err(Diagnostic::new(file, 1, "is a Git LFS pointer, not the file itself")
            .hint("run `git lfs pull` in the repository that it came from"));
    }
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return refuse("is a zip archive (.zae, .3mf and the like)", "unpack it and name the .dae or .stl inside");
    }
    if bytes.trim_ascii_start().starts_with(b"ISO-10303") {
        let mut stl = file.with_extension("stl");
        // A STEP file may have the extension .stl.
        if stl == file {
            stl = file.with_extension("mesh.stl");
        }
        let [step, stl] = [file, stl.as_path()].map(shell_word);
        let unit = "its unit is mm: --unit mm, or mesh_unit = \"mm\" in a cell file";
        let hint = format!("run `gmsh {step} -2 -o {stl}` and name its output; {unit}");
        return refuse("is STEP, a CAD format without triangles", &hint);
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return refuse("is compressed with gzip", "unpack it first: gunzip FILE");
    }
    Ok(())
}

/// Quotes a path as a word of a command line.
pub(crate) fn shell_word(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:,@%".contains(c);
    if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

/// Hint for a file whose extension is that of a `MoveIt` planning scene; `None` for other files.
pub fn planning_scene_hint(file: &Path) -> Option<String> {
    let is_scene = file.extension().is_some_and(|e| ["scene", "yaml", "yml"].iter().any(|s| e.eq_ignore_ascii_case(s)));
    let command = || format!("elbowroom convert {} cell.toml", shell_word(file));
    is_scene.then(|| {
        format!(
            "[scene.NAME] file = {:?} in a cell file, or run `{}`: it is a planning scene",
            file.display().to_string(),
            command()
        )
    })
}

/// Decodes the text of a file: UTF-8; UTF-16 with a byte order mark or as XML; Latin-1 if the XML declaration states it.
pub(crate) fn text<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, str>, Diagnostic> {
    if let Some(rest) = bytes.strip_prefix(b"\xef\xbb\xbf") {
        return utf8(rest, file);
    }
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes, file),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes, file),
        [b'<', 0, ..] => utf16(bytes, u16::from_le_bytes, file),
        [0, b'<', ..] => utf16(bytes, u16::from_be_bytes, file),
        _ => utf8(bytes, file),
    }
}

fn utf8<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, str>, Diagnostic> {
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return Ok(Cow::Borrowed(text)),
        Err(e) => e,
    };
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    if head.starts_with("<?xml") && (head.contains("iso-8859-1") || head.contains("windows-1252")) {
        return Ok(Cow::Owned(bytes.iter().map(|&b| b as char).collect()));
    }
    let line = bytes[..error.valid_up_to()].split(|&b| b == b'\n').count();
    Err(Diagnostic::new(file, line, "is not text: a byte here is not UTF-8").hint("save the file as UTF-8"))
}

fn utf16<'a>(bytes: &[u8], unit: fn([u8; 2]) -> u16, file: &Path) -> Result<Cow<'a, str>, Diagnostic> {
    let units = bytes.chunks_exact(2).map(|c| unit([c[0], c[1]]));
    let text: Result<String, _> = char::decode_utf16(units).collect();
    text.map(Cow::Owned)
        .map_err(|_| Diagnostic::new(file, None, "is not valid UTF-16 text").hint("save the file as UTF-8"))
}

/// The bytes without a byte order mark; UTF-16 is converted to UTF-8.
pub(crate) fn text_bytes<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, [u8]>, Diagnostic> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return text(bytes, file).map(|t| Cow::Owned(t.into_owned().into_bytes()));
    }
    Ok(Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)))
}

/// The file name without directory and extension.
pub(crate) fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(|| "mesh".to_owned(), |s| s.to_string_lossy().into_owned())
}
