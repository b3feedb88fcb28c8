//! Random cells with robots that exchange their tools.

use super::settings::{Places, laws, settings};
use super::{any_robot, exchange, region};
use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, HandSpec, Model, RobotSpec, StepSpec, ToolSpec};

/// Makes a cell with forbidden regions, or with exchange regions of several robots.
pub fn cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    if random.percent(40) {
        let mut spec = CellSpec { max_s: 60.0, ..exchange::cell(random) };
        spec.robots.truncate(3);
        let last = spec.robots.len() - 1;
        for robot in &mut spec.robots[..=random.whole(0, last)] {
            equip(robot, random, 1.5);
        }
        return spec;
    }
    let mut spec = settings(random);
    laws(&mut spec, random);
    let mut one = any_robot::any(random, places);
    equip(&mut one, random, 0.8);
    if random.percent(30) {
        one.program.repeat = 2;
    }
    spec.robots.push(one);
    let Ok(cell) = spec.parse(places.cells) else { return spec };
    for i in 0..random.whole(1, 3) {
        spec.regions.extend(region::on_the_path(&spec, &cell, &format!("g{i}"), random));
    }
    spec
}

/// Replaces the hand by two or three tools, the first one mounted, and adds steps that exchange them.
fn equip(robot: &mut RobotSpec, random: &mut Random, reach: f64) {
    let names = ["gripper", "torch", "probe"];
    let tool = |(i, name): (usize, &&str)| {
        // The second tool is long: it may reach where the first one did not.
        let length = if i == 1 { random.between(0.2, reach) } else { random.between(0.02, 0.3) };
        let size = [random.between(0.02, 0.1), random.between(0.02, 0.1), length];
        let solid = random.percent(85).then_some(([0.0, 0.0, length / 2.0], size));
        ToolSpec { name: (*name).to_owned(), tcp: [0.0, 0.0, length], solid, mounted: i == 0, flange: None }
    };
    let mut tools: Vec<ToolSpec> = names.iter().take(2).enumerate().map(tool).collect();
    if let Some(mut r) = random.rare(0, 4, 10)
        && let Model::Dh { rows, .. } = &robot.model
        && rows.len() > 1
    {
        // Its own flange has it from the start on, or gets it later.
        (tools[1].flange, tools[1].mounted) = (Some("link_1".into()), r.percent(50));
    }
    let count = random.whole(1, 3);
    for i in 0..count {
        let name = if i == 0 { "torch".to_owned() } else { tools[random.whole(0, 1)].name.clone() };
        let steps = &mut robot.program.steps;
        let at = random.whole(0, steps.len());
        steps.insert(at, StepSpec::Tool(name));
        if random.percent(50) {
            steps.insert(at, StepSpec::Wait(random.between(0.01, 0.3)));
        }
    }
    // The exchange then happens part of the way along its first move.
    if random.percent(50) {
        part_of_the_first_move(robot, random);
    }
    robot.hand = HandSpec { tools, ..HandSpec::default() };
}

/// Adds a stop during the first move, with an exchange.
fn part_of_the_first_move(robot: &mut RobotSpec, random: &mut Random) {
    let is_move = |s: &StepSpec| matches!(s, StepSpec::Joint { .. });
    let Some(index) = robot.program.steps.iter().position(is_move) else { return };
    let StepSpec::Joint { to, percent } = robot.program.steps[index].clone() else { return };
    let share = random.between(0.1, 0.9);
    let part = robot.start.iter().zip(&to).map(|(a, b)| a + (b - a) * share).collect();
    let on_the_way = [StepSpec::Joint { to: part, percent }, StepSpec::Tool("torch".into())];
    robot.program.steps.splice(index..index, on_the_way);
}
