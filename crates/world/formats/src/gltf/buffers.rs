//! Chunks of a GLB and the buffers of a glTF.

use std::borrow::Cow;
use std::path::{Component, Path, PathBuf};

use base64::Engine;

use super::document::Document;
use crate::tokens::show;
use crate::{Diagnostic, input};

/// The JSON of a file, and the binary chunk of a GLB.
type Chunks<'a> = (Cow<'a, [u8]>, Option<&'a [u8]>);

/// Splits a file into its chunks. A plain glTF is JSON only.
pub(super) fn split<'a>(bytes: &'a [u8], file: &Path) -> Result<Chunks<'a>, Diagnostic> {
    if !bytes.starts_with(b"glTF") {
        return input::text_bytes(bytes, file).map(|json| (json, None));
    }
    let bad = |what: String| Diagnostic::new(file, None, what).hint("copy or export the file again, as glTF 2.0");
    let word = |at: usize| {
        let raw = bytes.get(at..at + 4).ok_or_else(|| bad(format!("the GLB is truncated at byte {}", bytes.len())))?;
        Ok(u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]) as usize)
    };
    let (version, length) = (word(4)?, word(8)?);
    if version != 2 {
        return Err(bad(format!("is glTF of version {version}; only 2 is read")));
    }
    if length > bytes.len() || length < 12 {
        return Err(bad(format!("the GLB is truncated: it announces {length} bytes and has {}", bytes.len())));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at + 8 <= length {
        let (size, kind) = (word(at)?, &bytes[at + 4..at + 8]);
        let chunk = (at + 8).checked_add(size).and_then(|end| bytes.get(at + 8..end));
        let chunk =
            chunk.ok_or_else(|| bad(format!("a chunk of the GLB announces {size} bytes, more than there are")))?;
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + size;
    }
    let json = json.ok_or_else(|| bad("the GLB has no JSON chunk".into()))?;
    Ok((json.into(), binary))
}

/// Loads the bytes of every buffer, each at least as long as declared.
pub(super) fn load<'a>(
    document: &Document,
    binary: Option<&'a [u8]>,
    file: &Path,
) -> Result<Vec<Cow<'a, [u8]>>, Diagnostic> {
    let mut buffers = Vec::new();
    for (i, buffer) in document.buffers.iter().enumerate() {
        let place = format!("buffer {i}");
        let bytes = match &buffer.uri {
            None => Cow::Borrowed(binary.ok_or_else(|| {
                Diagnostic::new(file, None, format!("{place} has no uri, and the file has no binary chunk"))
                    .hint("\"uri\": \"model.bin\"")
            })?),
            Some(uri) => Cow::Owned(fetch(uri, &place, file)?),
        };
        if bytes.len() < buffer.byte_length {
            let what = format!("{place} announces {} bytes and has {}", buffer.byte_length, bytes.len());
            return Err(Diagnostic::new(file, None, what).hint("copy or export the files again"));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn fetch(uri: &str, place: &str, file: &Path) -> Result<Vec<u8>, Diagnostic> {
    let error = |what: String| Diagnostic::new(file, None, format!("{place}: {what}"));
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, d)| d);
        let encoded = encoded
            .ok_or_else(|| error("its data is not base64".into()).hint("data:application/octet-stream;base64,…"))?;
        let engine = base64::engine::general_purpose::STANDARD;
        return engine
            .decode(encoded)
            .map_err(|e| error(format!("its base64 is damaged: {e}")).hint("export the file again"));
    }
    let relative = PathBuf::from(crate::resolve::percent_decode(uri));
    let stays_below = relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    if !stays_below || uri.contains("://") {
        return Err(error(format!(
            "`{}` leads out of the file's directory, and is not followed",
            show(uri.as_bytes())
        ))
        .hint("\"uri\": \"model.bin\", a file beside the .gltf; or export as .glb"));
    }
    let path = file.parent().unwrap_or(Path::new("")).join(relative);
    input::read(&path).map_err(|e| {
        error(format!("{} {}", path.display(), e.message)).hint("the file beside the .gltf; or export as .glb")
    })
}
