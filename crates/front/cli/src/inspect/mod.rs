//! `elbowroom inspect`: the contents of a model.

pub(crate) mod args;
mod link_poses;
mod picture;
mod point_of_link;

use std::io::IsTerminal;
use std::path::Path;

use elbowroom::cell::{Cell, PairFile, QueryModel};
use elbowroom::formats::stl::write_binary;
use elbowroom::inspect::{DhConvention, InspectOptions, Inspection};
use elbowroom::spatial::units::LengthUnit;

use crate::arg_values::PoseNumbers;
use crate::output::{ExitStatus, Failure, cannot_write, note, print, print_json, refuse_existing};
use crate::output_file::{write_bytes, write_file};
use args::InspectArgs;
use link_poses::link_poses;
use picture::draw;
use point_of_link::point_of_link;

pub(crate) fn inspect(args: &InspectArgs) -> Result<ExitStatus, Failure> {
    if let Some(path) = args.pairs.as_ref().filter(|_| is_cell(&args.model)) {
        let cell = Cell::load(&args.model)?;
        cell.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        write_pairs(&QueryModel::without_rules(&cell), path, args.accept)?;
        return Ok(ExitStatus::Success);
    }
    let options = InspectOptions {
        srdf: args.srdf.clone(),
        unit: args.unit.map(LengthUnit::from),
        joints: args.joints.joints.clone(),
        joint: args.joints.joint.clone(),
        tip: args.chain.tip.clone(),
        dh: args.dh.iter().copied().map(DhConvention::from).collect(),
        brief: args.brief || args.states.is_some() || args.chain.pose.is_some() || args.chain.at.is_some(),
    };
    let inspection = Inspection::of(&args.model, &options)?;
    if let Some(PoseNumbers(pose)) = args.chain.pose {
        return pose_solutions(&inspection, args, pose);
    }
    if let Some(at) = &args.chain.at {
        return point_of_link(&inspection, at, args);
    }
    if let Some(states) = &args.states {
        inspection.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        return link_poses(&inspection, states, args.table || std::io::stdout().is_terminal() && !args.json);
    }
    if let Some(path) = &args.drawing.picture {
        draw(&inspection, args.drawing.levels, path)?;
    }
    write_files(&inspection, args)?;
    if args.json {
        inspection.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        print_json(&inspection)?;
    } else {
        print(&inspection.to_string())?;
    }
    Ok(ExitStatus::Success)
}

/// Writes the models, the SRDF and the pairs that are asked for.
fn write_files(inspection: &Inspection, args: &InspectArgs) -> Result<(), Failure> {
    if let Some(dir) = &args.models {
        models(inspection, dir)?;
    }
    if let Some(path) = &args.write_srdf {
        let what = || {
            Failure::Wrong(format!(
                "{}: has no pairs of links\n  write: a robot with collision geometry",
                args.model.display()
            ))
        };
        // An existing file may have pairs and groups that a person has written.
        refuse_existing(path)?;
        write_bytes(path, inspection.srdf().ok_or_else(what)?)?;
        note(format_args!("wrote {}", path.display()));
    }
    if let Some(path) = &args.pairs {
        let robot = inspection.robot().ok_or_else(|| {
            let model = args.model.display();
            Failure::Wrong(format!("{model}: is a mesh; it has no pairs\n  write: a robot or a cell file"))
        })?;
        write_pairs(&QueryModel::of_robot(&args.model, robot.clone()), path, args.accept)?;
    }
    Ok(())
}

/// Prints all joint values with which the tip is at a pose.
fn pose_solutions(inspection: &Inspection, args: &InspectArgs, pose: [f64; 6]) -> Result<ExitStatus, Failure> {
    inspection.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let solutions = inspection.pose_solutions(args.chain.tip.as_deref(), pose)?;
    if args.json {
        print_json(&solutions)?;
    } else {
        print(&solutions.to_string())?;
    }
    Ok(if solutions.solutions.is_empty() { ExitStatus::NegativeResult } else { ExitStatus::Success })
}

fn is_cell(model: &Path) -> bool {
    model.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

/// Writes the file of pairs of a model; rows that a person wrote in an existing file stay.
fn write_pairs(model: &QueryModel, path: &Path, accept: bool) -> Result<(), Failure> {
    let before = path.exists().then(|| PairFile::read(path)).transpose()?;
    let (file, counts) = PairFile::survey(path, model, before.as_ref(), accept)?;
    write_bytes(path, file.to_string())?;
    let always = if accept { "skipped" } else { "tested" };
    let counted = [
        (counts.excluded, "never tested (adjacent, no joint between, SRDF)"),
        (counts.out_of_reach, "out of reach of each other (proven)"),
        (counts.always, &format!("always in contact ({always})")),
        (counts.never, "never in contact in samples (tested last)"),
        (counts.at_rest, "in contact at rest (tested)"),
        (counts.by_hand, "by hand"),
        (counts.others, "others (tested)"),
    ];
    let counted: Vec<String> =
        counted.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
    note(format_args!("wrote {}: {}", path.display(), counted.join(", ")));
    Ok(())
}

/// Writes hull, middle and coarse triangles of every link, one file each.
fn models(inspection: &Inspection, dir: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(dir).map_err(cannot_write(dir))?;
    let mut files = 0;
    for (index, levels) in inspection.resolution.iter().enumerate() {
        for mesh in &levels.meshes {
            let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
            let link: String = levels.link.chars().map(plain).collect();
            let path = dir.join(format!("{index:02}_{link}.{}.stl", mesh.name));
            write_file(&path, |mut out| write_binary(&mut out, std::slice::from_ref(mesh)))?;
            files += 1;
        }
    }
    note(format_args!("wrote {files} files to {}", dir.display()));
    Ok(())
}
