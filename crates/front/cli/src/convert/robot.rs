//! A robot as URDF with STL meshes, or as 3DS.

use std::path::{Path, PathBuf};

use elbowroom::cell::{Cell, CellRobot};
use elbowroom::formats::robot::{self, LoadOptions, LoadedRobot};
use elbowroom::formats::{joints, tds};
use elbowroom::robot::Robot;
use elbowroom::spatial::units::LengthUnit;

use crate::args::{ConvertArgs, Written};
use crate::output::{ExitStatus, Failure, cannot_write, note};
use crate::output_file::write_bytes;

/// Writes the robot to the folder `out`.
pub(super) fn convert(args: &ConvertArgs, out: &Path) -> Result<ExitStatus, Failure> {
    let (name, robot) = if has_extension(&args.model, "toml") {
        let robot = of_cell(args)?;
        (robot.name.clone(), robot.robot)
    } else {
        let name = args.model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        (name, of_model(args)?.robot)
    };
    std::fs::create_dir_all(out).map_err(cannot_write(out))?;
    for to in &args.to {
        let path = out.join(match to {
            Written::Urdf => format!("{name}.urdf"),
            Written::Tds => format!("{name}.3ds"),
        });
        let beside: &[&str] = match to {
            Written::Urdf => &["urdf", "srdf"],
            Written::Tds => &["3ds", "joints.toml"],
        };
        for extension in beside {
            keep_own(&out.join(format!("{name}.{extension}")), &args.model)?;
        }
        let files = match to {
            Written::Urdf => robot::write_urdf(&robot, out, &name)?,
            Written::Tds => write_tds(&robot, &path)?,
        };
        let more = files.len() - 1;
        note(format_args!("wrote {} and {more} files that belong to it", path.display()));
    }
    Ok(ExitStatus::Success)
}

/// Whether the file has this extension, in upper or lower case.
pub(super) fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// Loads the robot of a model.
pub(super) fn of_model(args: &ConvertArgs) -> Result<LoadedRobot, Failure> {
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
    Ok(loaded)
}

/// Loads the robot of a cell.
pub(super) fn of_cell(args: &ConvertArgs) -> Result<CellRobot, Failure> {
    let given =
        args.srdf.is_some() || args.unit.is_some() || args.joints.joints.is_some() || !args.joints.joint.is_empty();
    if given {
        let what =
            "--srdf, --unit, --joints and --joint go with a model\n  write: the cell file says these things itself";
        return Err(Failure::Wrong(what.to_owned()));
    }
    let mut cell = Cell::load(&args.model)?;
    let names: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
    let chosen = match &args.robot {
        Some(name) => names.iter().position(|n| n == name),
        None => (names.len() == 1).then_some(0),
    };
    let chosen = chosen.ok_or_else(|| {
        let file = args.model.display();
        Failure::Wrong(format!("{file}: which robot?\n  write: --robot with one of {}", names.join(", ")))
    })?;
    Ok(cell.robots.swap_remove(chosen))
}

/// Writes the 3DS model, and a file with the joints, which 3DS cannot hold.
fn write_tds(robot: &Robot, path: &Path) -> Result<Vec<PathBuf>, Failure> {
    let bytes = tds::write(&robot::to_tree(robot), path)?;
    write_bytes(path, bytes)?;
    let beside = joints::default_path(path);
    write_bytes(&beside, joints::to_toml(&robot.chain))?;
    Ok(vec![path.to_owned(), beside])
}

/// Refuses to overwrite files beside the model: the user may have written its SRDF and its joints.
fn keep_own(path: &Path, model: &Path) -> Result<(), Failure> {
    let folder = |p: &Path| p.canonicalize().ok().and_then(|p| p.parent().map(Path::to_owned));
    if path.exists() && folder(path) == folder(model) {
        let what =
            format!("{}: is there already, beside the model\n  write: --out with another folder", path.display());
        return Err(Failure::Wrong(what));
    }
    Ok(())
}
