//! A planning scene as a cell file.

use std::path::Path;

use elbowroom::cell::{self, Cell, ObjectTables, PairFile};
use elbowroom::formats::planning_scene::{self, FixedFrame};
use elbowroom::formats::stl;

use crate::args::ConvertArgs;
use crate::output::{ExitStatus, Failure, cannot_write, note, refuse_existing};
use crate::output_file::write_bytes;

/// Writes the objects of the scene as tables of the cell file `file`, and its meshes to a folder beside it.
pub(super) fn convert(args: &ConvertArgs, file: &Path) -> Result<ExitStatus, Failure> {
    let robot_options = args.robot.is_some() || args.srdf.is_some() || args.unit.is_some();
    if robot_options || args.joints.joints.is_some() || !args.joints.joint.is_empty() {
        let what = "--robot, --srdf, --unit, --joints and --joint go with a robot\n  write: convert SCENE cell.toml";
        return Err(Failure::Wrong(what.to_owned()));
    }
    refuse_existing(file)?;
    let cell = Cell::parse(args.model.with_file_name("scene.toml"), &cell_text(&args.model)?)?;
    cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let folder = format!("{}_meshes", file.file_stem().unwrap_or_default().to_string_lossy());
    let ObjectTables { toml, meshes } = cell::object_tables(&cell.objects, &folder);
    let beside = file.parent().unwrap_or(Path::new(""));
    if !meshes.is_empty() {
        let folder = beside.join(&folder);
        refuse_existing(&folder)?;
        std::fs::create_dir_all(&folder).map_err(cannot_write(&folder))?;
    }
    for (name, mesh) in &meshes {
        let path = beside.join(name);
        let mut bytes = Vec::new();
        stl::write_binary(&mut bytes, std::slice::from_ref(mesh)).map_err(cannot_write(&path))?;
        write_bytes(&path, bytes)?;
    }
    let pairs = write_pairs(args, file, &cell)?;
    let toml = match &pairs {
        Some(name) => toml.replacen("\n\n", &format!("\npairs = {}\n\n", toml_text(name)), 1),
        None => toml,
    };
    write_bytes(file, toml)?;
    let (objects, meshes) = (cell.objects.len(), meshes.len());
    note(format_args!("wrote {}: {objects} objects, {meshes} mesh files", file.display()));
    Ok(ExitStatus::Success)
}

/// Writes the pairs that the scene lets touch to a file of pairs beside the cell file, if any. Returns the file name.
fn write_pairs(args: &ConvertArgs, file: &Path, cell: &Cell) -> Result<Option<String>, Failure> {
    let name = format!("{}_pairs.toml", file.file_stem().unwrap_or_default().to_string_lossy());
    let path = file.with_file_name(&name);
    let Some(pairs) = PairFile::of_scene(&path, &planning_scene::read(&args.model)?, cell) else { return Ok(None) };
    refuse_existing(&path)?;
    write_bytes(&path, pairs.to_string())?;
    note(format_args!("wrote {}: the pairs that the scene lets touch", path.display()));
    Ok(Some(name))
}

/// Returns a cell file with only the scene. If all objects are in one frame that the scene does not define, that frame
/// becomes the world of the cell: the cell has no robot that could define it.
fn cell_text(file: &Path) -> Result<String, Failure> {
    let scene = planning_scene::read(file)?;
    // The frame by which each object is finally placed.
    let frames = scene.objects.iter().map(|o| FixedFrame::ancestor(&scene.frames, &o.frame, |_| false).0);
    let mut frames: Vec<&str> = frames.filter(|frame| !frame.is_empty()).collect();
    frames.sort_unstable();
    frames.dedup();
    let frame = match frames[..] {
        [] | ["world"] => String::new(),
        [one] => {
            let what = format!("the frame `{one}` of the scene is the world of the cell");
            note(format_args!("warning: {}: {what}", file.display()));
            format!("frame = {}\n", toml_text(one))
        }
        [a, b, ..] => {
            let what = format!("has objects in the frames `{a}` and `{b}`, which it does not define");
            let write = "`fixed_frame_transforms` for one of them; or [scene.NAME] file = … in a cell with the robot they are links of";
            return Err(Failure::Wrong(format!("{}: {what}\n  write: {write}", file.display())));
        }
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let head = "version = 1\nunits = { length = \"m\", angle = \"deg\" }\n[scene.all]\n";
    // The pairs go to a file of their own.
    Ok(format!("{head}file = {}\nallowed_collisions = false\n{frame}", toml_text(&name)))
}

fn toml_text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
