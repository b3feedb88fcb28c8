//! `elbowroom convert`: a robot as URDF, 3DS or SRDF; a planning scene as a cell file; joint states of an MCAP
//! recording as a table.

mod robot;
mod scene;
mod srdf;

use std::path::Path;

use crate::args::ConvertArgs;
use crate::live;
use crate::output::{ExitStatus, Failure};
use robot::has_extension;

pub(crate) fn convert(args: &ConvertArgs) -> Result<ExitStatus, Failure> {
    if has_extension(&args.model, "mcap") {
        return match &args.output {
            Some(table) if has_extension(table, "csv") => {
                live::convert_recording(&args.model, args.topic.as_deref(), table)
            }
            _ => Err(Failure::Wrong("a recording becomes a table\n  write: convert log.mcap log.csv".into())),
        };
    }
    if let Some(topic) = &args.topic {
        let what = format!("--topic {topic} is for recordings, and {} is none", args.model.display());
        return Err(Failure::Wrong(format!("{what}\n  write: convert log.mcap log.csv --topic {topic}")));
    }
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
