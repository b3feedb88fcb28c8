//! The file of an `Inline`.

use std::path::{Component, Path, PathBuf};

use super::values::Fields;
use crate::tokens::show;
use crate::{Diagnostic, input, resolve};

/// Returns the first file of the field `url` that exists, and its bytes.
///
/// Only files below the folder of the file that names them are followed.
pub(super) fn load(fields: Fields<'_, '_>) -> Result<(PathBuf, Vec<u8>), Diagnostic> {
    let folder = fields.file.parent().unwrap_or(Path::new(""));
    let hint = "url \"part.wrl\", a file beside this one; its surface would be missing otherwise";
    let mut why = "has no url".to_owned();
    for url in fields.texts("url")? {
        let relative = PathBuf::from(resolve::percent_decode(&url.replace('\\', "/")));
        let stays_below = relative.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
        if url.contains("://") || !stays_below {
            why = format!("`{}` leads out of the file's directory, and is not followed", show(url.as_bytes()));
            continue;
        }
        let path = folder.join(relative);
        match input::read(&path) {
            Ok(bytes) => return Ok((path, bytes)),
            Err(e) => why = format!("{} {}", path.display(), e.message),
        }
    }
    Err(fields.error(why).hint(hint))
}
