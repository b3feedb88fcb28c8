//! Path requests from the options of `elbowroom plan`.

use std::time::Duration;

use elbowroom::cell::Cell;
use elbowroom::formats::suggest;
use elbowroom::planner::RrtConnectSettings;
use elbowroom::query::plan;

use crate::arg_values::Configuration;
use crate::output::Failure;
use crate::plan_args::PlanArgs;

/// Reads time limit, clearance and seed.
pub(crate) fn settings(args: &PlanArgs) -> RrtConnectSettings {
    RrtConnectSettings {
        time_limit: Duration::from_secs_f64(args.search.time_limit),
        clearance_m: args.search.clearance,
        seed: args.search.seed,
        ..RrtConnectSettings::default()
    }
}

/// Resolves a configuration of `robot`, or of the first named robot, to joint values in rad or m.
pub(crate) fn configuration(
    args: &PlanArgs,
    cell: &Cell,
    robot: Option<&str>,
    given: &Configuration,
) -> Result<Vec<f64>, Failure> {
    let (_, robot) = plan::select_robot(cell, robot.or(args.robot.first().map(String::as_str)))?;
    match given {
        Configuration::Values(q) if args.cell_units => Ok(robot.joint_values_from_units(q, cell.units)),
        Configuration::Values(q) => Ok(q.clone()),
        Configuration::Named(name) => {
            let start = (name == "start").then_some(&robot.start[..]);
            robot.state(name).or(start).map(<[f64]>::to_vec).ok_or_else(|| {
                let known = robot.states.iter().map(|(name, _)| name.as_str());
                let hint = suggest::hint(name, known);
                Failure::Wrong(format!(
                    "robot \"{}\" has no state \"{name}\"\n  write: {hint}   (states = {{ {name} = […] }} in [robot.{}])",
                    robot.name, robot.name
                ))
            })
        }
    }
}
