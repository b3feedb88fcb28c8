//! `inspect --picture`: an image of the model.

use std::path::Path;

use elbowroom::inspect::{Inspection, SurfacePoint};
use elbowroom::report::model_picture;

use crate::output::{Failure, note};
use crate::output_file::write_file;

/// Writes a picture, or a page with four views; with the chain to a point of a link, if one is given.
pub(super) fn picture(inspection: &Inspection, point: Option<&SurfacePoint>, path: &Path) -> Result<(), Failure> {
    let ends = |ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
    if !(ends("png") || ends("html")) {
        let what = format!("{}: pictures are png or html\n  write: --picture model.png", path.display());
        return Err(Failure::Wrong(what));
    }
    write_file(path, |out| {
        if ends("png") {
            model_picture::write_png(inspection, point, out)
        } else {
            model_picture::write_page(inspection, point, out)
        }
    })?;
    note(format_args!("wrote {}", path.display()));
    Ok(())
}
