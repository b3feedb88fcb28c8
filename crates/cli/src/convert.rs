//! `elbowroom convert`: a robot as URDF with STL meshes, or as 3DS.

use std::path::{Path, PathBuf};

use elbowroom::cell::Cell;
use elbowroom::formats::robot::{self, LoadOptions};
use elbowroom::formats::{joints, tds};
use elbowroom::robot::Robot;
use elbowroom::spatial::units::LengthUnit;

use crate::args::{ConvertArgs, Written};
use crate::output::{ExitStatus, Failure, cannot_write, note};

pub(crate) fn convert(args: &ConvertArgs) -> Result<ExitStatus, Failure> {
    let is_cell = args.model.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let (name, robot) = if is_cell { of_cell(args)? } else { of_model(args)? };
    std::fs::create_dir_all(&args.out).map_err(cannot_write(&args.out))?;
    for to in &args.to {
        let path = args.out.join(match to {
            Written::Urdf => format!("{name}.urdf"),
            Written::Tds => format!("{name}.3ds"),
        });
        let beside: &[&str] = match to {
            Written::Urdf => &["urdf", "srdf"],
            Written::Tds => &["3ds", "joints.toml"],
        };
        for extension in beside {
            keep_own(&args.out.join(format!("{name}.{extension}")), &args.model)?;
        }
        let files = match to {
            Written::Urdf => robot::write_urdf(&robot, &args.out, &name)?,
            Written::Tds => write_tds(&robot, &path)?,
        };
        let more = files.len() - 1;
        note(format_args!("wrote {} and {more} files that belong to it", path.display()));
    }
    Ok(ExitStatus::Success)
}

fn of_model(args: &ConvertArgs) -> Result<(String, Robot), Failure> {
    if args.robot.is_some() {
        return Err(Failure::Wrong("--robot goes with a cell file\n  write: a model without --robot".to_owned()));
    }
    let options = LoadOptions {
        srdf: args.srdf.clone(),
        load_visuals: true,
        unit: args.unit.map(LengthUnit::from),
        joints: args.joints.joints.clone(),
        joint: args.joints.joint.clone(),
    };
    let loaded = robot::load(&args.model, &options)?;
    loaded.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let name = args.model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok((name, loaded.robot))
}

fn of_cell(args: &ConvertArgs) -> Result<(String, Robot), Failure> {
    let given =
        args.srdf.is_some() || args.unit.is_some() || args.joints.joints.is_some() || !args.joints.joint.is_empty();
    if given {
        let what =
            "--srdf, --unit, --joints and --joint go with a model\n  write: the cell file says these things itself";
        return Err(Failure::Wrong(what.to_owned()));
    }
    let cell = Cell::load(&args.model)?;
    let names: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
    let chosen = match &args.robot {
        Some(name) => cell.robots.iter().find(|r| r.name == *name),
        None => cell.robots.first().filter(|_| names.len() == 1),
    };
    let robot = chosen.ok_or_else(|| {
        let file = args.model.display();
        Failure::Wrong(format!("{file}: which robot?\n  write: --robot with one of {}", names.join(", ")))
    })?;
    Ok((robot.name.clone(), robot.robot.clone()))
}

/// The 3DS model, and a file with the joints, which 3DS cannot hold.
fn write_tds(robot: &Robot, path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let bytes = tds::write(&robot::to_tree(robot), path)?;
    std::fs::write(path, bytes).map_err(cannot_write(path))?;
    let beside = joints::default_path(path);
    std::fs::write(&beside, joints::to_toml(&robot.chain)).map_err(cannot_write(&beside))?;
    Ok(vec![path.to_owned(), beside])
}

/// Files beside the model are never overwritten: its SRDF and its joints may be written by the user.
fn keep_own(path: &Path, model: &Path) -> Result<(), Failure> {
    let folder = |p: &Path| p.canonicalize().ok().and_then(|p| p.parent().map(Path::to_owned));
    if path.exists() && folder(path) == folder(model) {
        let what =
            format!("{}: is there already, beside the model\n  write: --out with another folder", path.display());
        return Err(Failure::Wrong(what));
    }
    Ok(())
}
