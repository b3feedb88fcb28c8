//! `inspect --picture`: an image of the model.

use std::path::Path;

use elbowroom::inspect::{Inspection, SurfacePoint, box_levels};
use elbowroom::report::{levels_page as page_of_levels, model_picture};

use crate::output::{Failure, note};
use crate::output_file::write_file;

/// Writes a picture of the model, or the page of its levels.
pub(super) fn draw(inspection: &Inspection, levels: bool, path: &Path) -> Result<(), Failure> {
    if levels { levels_page(inspection, path) } else { picture(inspection, None, path) }
}

/// Writes a picture, or a page with four views; with the chain to a point of a link, if one is given.
pub(super) fn picture(inspection: &Inspection, point: Option<&SurfacePoint>, path: &Path) -> Result<(), Failure> {
    if !(ends(path, "png") || ends(path, "html")) {
        let what = format!("{}: pictures are png or html\n  write: --picture model.png", path.display());
        return Err(Failure::Wrong(what));
    }
    write_file(path, |out| {
        if ends(path, "png") {
            model_picture::write_png(inspection, point, out)
        } else {
            model_picture::write_page(inspection, point, out)
        }
    })?;
    note(format_args!("wrote {}", path.display()));
    Ok(())
}

/// Writes a page with the boxes of each resolution level around a robot.
fn levels_page(inspection: &Inspection, path: &Path) -> Result<(), Failure> {
    if !ends(path, "html") {
        let what = format!("{}: the levels are a page\n  write: --picture levels.html --levels", path.display());
        return Err(Failure::Wrong(what));
    }
    let wrong = |what: &str| {
        let model = inspection.model.display();
        Failure::Wrong(format!("{model}: {what}\n  write: a robot with collision geometry"))
    };
    let robot = inspection.robot().ok_or_else(|| wrong("is a mesh; --levels draws the boxes of a robot's links"))?;
    let levels = box_levels(robot).map_err(|e| wrong(&e.to_string()))?;
    if levels.is_empty() {
        return Err(wrong("has no link with a bounded shape, so that there are no boxes"));
    }
    write_file(path, |out| page_of_levels::write(out, &inspection.name, robot, &levels))?;
    note(format_args!("wrote {}", path.display()));
    Ok(())
}

fn ends(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending))
}
