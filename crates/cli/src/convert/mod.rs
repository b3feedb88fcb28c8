//! `elbowroom convert`: a robot as URDF, 3DS or SRDF; a planning scene as a cell file.

mod robot;
mod scene;
mod srdf;

use std::path::Path;

use crate::args::ConvertArgs;
use crate::output::{ExitStatus, Failure};
use robot::has_extension;

pub(crate) fn convert(args: &ConvertArgs) -> Result<ExitStatus, Failure> {
    let is_scene = ["scene", "yaml", "yml"].iter().any(|e| has_extension(&args.model, e));
    match (&args.output, &args.out) {
        (Some(file), _) if has_extension(file, "toml") && !has_extension(&args.model, "toml") => {
            scene::convert(args, file)
        }
        (Some(file), _) if has_extension(file, "srdf") && !is_scene => srdf::convert(args, file),
        (None, Some(dir)) if !is_scene => robot::convert(args, dir),
        _ => Err(wrong_output(args, is_scene)),
    }
}

fn wrong_output(args: &ConvertArgs, is_scene: bool) -> Failure {
    let output = args.output.as_deref().or(args.out.as_deref()).unwrap_or(Path::new(""));
    let write = if is_scene {
        "a planning scene becomes a cell file: convert SCENE cell.toml"
    } else {
        "convert MODEL arm.srdf for an SRDF, or convert MODEL --out DIR --to urdf,3ds for the model"
    };
    Failure::Wrong(format!("{} cannot become {}\n  write: {write}", args.model.display(), output.display()))
}
