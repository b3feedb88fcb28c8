//! The SRDF of a robot.

use std::path::Path;

use elbowroom::formats::srdf::{Group, GroupState, Srdf};
use elbowroom::inspect;
use elbowroom::kinematics::{Chain, LinkId};
use elbowroom::robot::Robot;

use super::robot::{has_extension, of_cell, of_model};
use crate::args::ConvertArgs;
use crate::output::{ExitStatus, Failure, note, refuse_existing};
use crate::output_file::write_bytes;

/// Name of the group of all moving joints if no SRDF has groups, as in ROS-Industrial.
const GROUP: &str = "manipulator";

/// Writes the SRDF of the robot of a model or cell: groups, states, and the pairs that need no test.
pub(super) fn convert(args: &ConvertArgs, file: &Path) -> Result<ExitStatus, Failure> {
    refuse_existing(file)?;
    let (robot, given) = if has_extension(&args.model, "toml") { of_cell_file(args)? } else { of_model_file(args)? };
    let text = inspect::srdf(&args.model, &robot, given)?;
    write_bytes(file, text)?;
    note(format_args!("wrote {}", file.display()));
    Ok(ExitStatus::Success)
}

fn of_model_file(args: &ConvertArgs) -> Result<(Robot, Srdf), Failure> {
    let loaded = of_model(args)?;
    let mut given = loaded.srdf.unwrap_or_default();
    if given.groups.is_empty() {
        let chain = &loaded.robot.chain;
        given.groups.push(group(chain, chain.tip()));
    }
    Ok((loaded.robot, given))
}

fn of_cell_file(args: &ConvertArgs) -> Result<(Robot, Srdf), Failure> {
    let robot = of_cell(args)?;
    let chain = &robot.robot.chain;
    let state = |(name, q): &(String, Vec<f64>)| GroupState {
        name: name.clone(),
        group: GROUP.to_owned(),
        values: robot.joint_names().into_iter().zip(q.iter().copied()).collect(),
    };
    let states = robot.states.iter().map(state).collect();
    let given = Srdf { groups: vec![group(chain, robot.flange)], states, ..Srdf::default() };
    Ok((robot.robot.clone(), given))
}

/// Makes the group of all moving joints: a chain to the flange, or a list if some joints are not on that chain.
fn group(chain: &Chain, flange: LinkId) -> Group {
    let mut group = Group { name: GROUP.to_owned(), ..Group::default() };
    let path = chain.path(flange);
    if chain.active_joints().iter().all(|joint| path.contains(joint)) {
        let [base, tip] = [chain.root(), flange].map(|link| chain.links()[link.0].clone());
        group.chains.push([base, tip]);
    } else {
        group.joints = chain.active_joints().iter().map(|j| chain.joints()[j.0].name.clone()).collect();
    }
    group
}
