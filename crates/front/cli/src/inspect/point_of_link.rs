//! The chain that ends in a point of a link.

use std::fmt::Write;
use std::path::Path;

use elbowroom::cell::QueryModel;
use elbowroom::inspect::{Inspection, SurfacePoint};
use elbowroom::spatial::Vec3;

use super::args::InspectArgs;
use super::picture::picture;
use crate::arg_values::LinkPoint;
use crate::output::{ExitStatus, Failure, note, print, print_json};

/// Prints the chain, or with states the place of the point in each.
pub(super) fn point_of_link(
    inspection: &Inspection,
    at: &LinkPoint,
    args: &InspectArgs,
) -> Result<ExitStatus, Failure> {
    inspection.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
    let dh: Vec<_> = args.dh.iter().copied().map(Into::into).collect();
    let mut point = inspection.surface_point(&at.link, Vec3::from(at.point), &dh)?;
    if let Some(path) = &args.drawing.picture {
        picture(inspection, Some(&point), path)?;
    }
    if let Some(states) = &args.states {
        if args.json {
            let what = "--at with --states prints CSV\n  write: without --json";
            return Err(Failure::Wrong(what.to_owned()));
        }
        return places(inspection, &mut point, states);
    }
    if args.json {
        print_json(&point)?;
    } else {
        print(&point.to_string())?;
    }
    Ok(ExitStatus::Success)
}

/// Prints the place of the point in each state, in the root link.
fn places(inspection: &Inspection, point: &mut SurfacePoint, states: &Path) -> Result<ExitStatus, Failure> {
    let Some(robot) = inspection.robot() else { return Ok(ExitStatus::Success) };
    let states = crate::states::read(states, &QueryModel::of_robot(&inspection.model, robot.clone()))?;
    let mut text = "index,x_m,y_m,z_m\n".to_owned();
    for index in 0..states.len() {
        for (_, q) in states.of(index) {
            let [x, y, z] = point.place(q).to_array();
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{index},{x:?},{y:?},{z:?}");
        }
    }
    print(&text)?;
    Ok(ExitStatus::Success)
}
