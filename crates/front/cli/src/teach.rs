//! `elbowroom teach`: a region from taught points.

use elbowroom::cell::{Cell, CellRobot, QueryModel};
use elbowroom::kinematics::ChainState;
use elbowroom::spatial::Vec3;

use crate::args::TeachArgs;
use crate::output::{ExitStatus, Failure, note, print};
use crate::taught_region::TaughtRegion;

pub(crate) fn teach(args: &TeachArgs) -> Result<ExitStatus, Failure> {
    let cell = Cell::load(&args.cell)?;
    let robot = robot(&cell, args)?;
    let points = points(&cell, robot, args)?;
    if cell.regions.iter().any(|r| r.region.name == args.name) {
        return Err(Failure::Wrong(format!("{}: there is a region `{}` already", args.cell.display(), args.name)));
    }
    let taught = TaughtRegion { name: &args.name, shape: &args.shape, units: cell.units, is_temporary: false };
    taught.check_arguments()?;
    let wrong = |why: String| Failure::Wrong(format!("{}: {why}", args.states.display()));
    let solid = taught.solid(&points).map_err(wrong)?;
    let built = taught.built(&solid, &points).map_err(wrong)?;
    let comments = built.iter().map(|line| format!("# {line}\n")).collect::<Vec<_>>().concat();
    let text = format!("\n{comments}{}", taught.toml(&solid));
    taught.check(&text, &args.states)?;
    built.iter().for_each(note);
    print(&text)?;
    Ok(ExitStatus::Success)
}

fn robot<'a>(cell: &'a Cell, args: &TeachArgs) -> Result<&'a CellRobot, Failure> {
    let names: Vec<&str> = cell.robots.iter().map(|r| r.name.as_str()).collect();
    let wrong = |what: String| {
        Failure::Wrong(format!("{}: {what}\n  write: --robot with one of {}", args.cell.display(), names.join(", ")))
    };
    if let Some(name) = &args.robot {
        let found = cell.robots.iter().find(|r| r.name == *name);
        return found.ok_or_else(|| wrong(format!("there is no robot `{name}`")));
    }
    match cell.guarded_robots().collect::<Vec<_>>()[..] {
        [only] => Ok(&cell.robots[only.0]),
        _ => Err(wrong("has several robots".into())),
    }
}

/// Computes the position of the TCP (or of the flange) in each state.
fn points(cell: &Cell, robot: &CellRobot, args: &TeachArgs) -> Result<Vec<Vec3>, Failure> {
    let chain = &robot.robot.chain;
    let mut state = ChainState::new(chain);
    let states = crate::states::read(&args.states, &QueryModel::of_robot_in_cell(cell, robot))?;
    // A robot cannot be taught beyond its limits: such values are in another unit, or of another robot.
    if let Some(beyond) = states.warnings.first() {
        let write = "states in radians, and metres for joints that slide, as the robot has taken them";
        return Err(Failure::Wrong(format!("{beyond}\n  write: {write}")));
    }
    let point = |index: usize| {
        states.of(index).for_each(|(_, q)| state.q.copy_from_slice(q));
        chain.forward(&mut state);
        let flange_in_world = robot.base_in_world * state.link_in_root(robot.flange);
        if args.shape.flange {
            flange_in_world.translation
        } else {
            (flange_in_world * robot.tcp_in_flange).translation
        }
    };
    Ok((0..states.len()).map(point).collect())
}
