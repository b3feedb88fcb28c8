//! Any robot: mostly one of random joints; a few have a rare model, or keys that few robots have.

use std::f64::consts::{FRAC_PI_2, PI};

use super::robot;
use super::settings::{Places, program};
use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, Model, RobotSpec, SolidSpec};

/// Number of features of robots.
const OF_ROBOTS: u64 = 8;
/// Each so many of the first cells have one of the rare models. Robots with meshes take long.
pub const OF_MODELS: u64 = 37;
/// Tries to make a robot within its limits.
const TRIES: usize = 16;

/// Makes any robot, with a program, at the origin.
pub fn any(random: &mut Random, places: &Places<'_>) -> RobotSpec {
    let mut robot = model(random, places).unwrap_or_else(|| match random.whole(0, 99) {
        0..=5 => robot::example(random, places),
        6..=25 => robot::small(random),
        _ => robot::arm(random),
    });
    if random.percent(50) {
        robot.rpy = [random.between(-PI, PI), random.between(-FRAC_PI_2, FRAC_PI_2), random.between(-PI, PI)];
    }
    robot::equip(&mut robot, random);
    keys(&mut robot, random);
    robot
}

/// A robot with a model that few cells have; `None` for most cells.
fn model(random: &mut Random, places: &Places<'_>) -> Option<RobotSpec> {
    if let Some(mut r) = random.rare(0, OF_MODELS, 2) {
        return Some(drawn_arm(&mut r));
    }
    let unit = random.rare(1, OF_MODELS, 2);
    let near = random.rare(2, OF_MODELS, 2);
    let chosen = random.rare(3, OF_MODELS, 2);
    let has_unit = unit.is_some();
    let (mut own, places) = (unit.or(near).or(chosen)?, Places { data: None, ..*places });
    // Random joint values may be beyond the limits.
    let alone = CellSpec { tick_ms: 4.0, max_s: 1.0, ..CellSpec::default() };
    let is_read = |r: &RobotSpec| CellSpec { robots: vec![r.clone()], ..alone.clone() }.parse(places.cells).is_ok();
    let mut robot = robot::example(&mut own, &places);
    for _ in 0..TRIES {
        if is_read(&robot) {
            break;
        }
        robot = robot::example(&mut own, &places);
    }
    if has_unit {
        // The unit of meshes that state none.
        robot.keys.push("unit = \"m\"".into());
    }
    Some(robot)
}

/// A robot of a VRML model, with its joints in a file.
fn drawn_arm(random: &mut Random) -> RobotSpec {
    let mut place = || vec![random.between(-2.9, 2.9), random.between(-0.39, 0.39)];
    let (start, targets) = (place(), vec![place(), place()]);
    let model = Model::File("model = \"arm.wrl\"\njoints = \"arm_axes.toml\"\n".into());
    let mut robot = robot::bare(model, start, random);
    robot.acceleration = Some(random.scaled(2.0, 20.0));
    robot.program.steps = program(targets, None, random);
    robot
}

/// Adds keys to a robot.
fn keys(robot: &mut RobotSpec, random: &mut Random) {
    let rare: Vec<Option<Random>> = (0..OF_ROBOTS).map(|slot| random.rare(slot, OF_ROBOTS, 3)).collect();
    let [base, names, ignore, speed, mesh, tool, home, flange] = rare.try_into().expect("there are eight");
    if let Some(mut r) = speed {
        robot.keys.push(format!("speed = {}", r.scaled(0.3, 4.0)));
    }
    robot.starts_at_home = home.is_some();
    if let Some(mut r) = tool.filter(|_| robot.hand.tool_box.is_none()) {
        robot.hand.tool_mesh = Some((r.vector(0.1), r.vector(3.0)));
    }
    let Model::Dh { rows, links, has_names } = &mut robot.model else { return };
    let last = rows.len();
    if let Some(mut r) = base {
        let solid = robot::solid(&mut r, [0.0; 3], 0.25).text();
        robot.keys.push(format!("base_link = {}", if r.percent(50) { solid } else { format!("[{solid}]") }));
    }
    *has_names = names.is_some();
    if ignore.is_some() && last > 1 {
        robot.keys.push(format!("ignore = [[\"link_1\", \"link_{last}\"]]"));
    }
    if let Some(mut r) = mesh {
        let unit = r.one(&["m", "cm", "in", "mm"]);
        links[last - 1].push(SolidSpec::Mesh { at: r.vector(0.1), rpy: r.vector(3.0), unit });
    }
    if let Some(mut r) = flange {
        robot.keys.push(format!("flange = \"link_{}\"", r.whole(last.max(2) - 1, last)));
    }
}
