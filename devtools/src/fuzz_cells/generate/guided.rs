//! Robots that a person guides into objects, with shields, guides and forces.

use std::fmt::Write as _;

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::settings::{Places, settings};
use super::shields::Side;
use super::{rare, region, robot};
use crate::fuzz_cells::oracle;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellSpec, GuidanceSpec, HandRow, ObjectSpec, ProgramSpec, RobotSpec, list};

/// Laws of forces; the first three are fields alone.
const LAWS: [&str; 5] = ["repulsive", "khatib", "spring_damper", "admittance", "impedance"];
/// Tries to make a robot, and to place an object that does not touch it.
pub const TRIES: usize = 8;

/// Makes a guided robot among objects.
pub fn cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = settings(random);
    spec.max_s = 4.0;
    // A start beyond a joint's limit is refused.
    let cell = (0..TRIES).find_map(|_| {
        spec.robots = vec![with_tool(random, places)];
        spec.parse(places.cells).ok()
    });
    let Some(cell) = cell else { return spec };
    let tool = tool_in_world(&cell, 0);
    for i in 0..random.whole(1, 3) {
        for _ in 0..TRIES {
            let mut object = object(&format!("o{i}"), tool.translation, random);
            if i == 0 && random.is_first() && !object.shape.contains("\"box\"") {
                object.shape = String::from("shape = \"box\"\nsize = [0.2, 0.25, 0.3]\n");
            }
            let mut with = spec.clone();
            with.objects.push(object);
            if with.parse(places.cells).is_ok_and(|cell| oracle::is_clear_at_start(&cell, 0.005)) {
                spec = with;
                break;
            }
        }
    }
    rare::scene_at(&mut spec, tool.translation, places, random);
    let mut guidance = GuidanceSpec { rows: hand(tool, &spec.objects, random), ..GuidanceSpec::default() };
    guidance.operator = operator(random);
    tables(&mut guidance, &spec.objects, tool, random);
    switch_shield(&mut guidance, random);
    let on_the_way = guidance.rows[random.whole(0, guidance.rows.len() - 1)].at.map(|v| v as f64 * 1e-6);
    spec.guidance = Some(guidance);
    if random.percent(40) {
        let region = region::at(&spec, 0, on_the_way.map(rounded), "g0", random);
        let with = CellSpec { regions: vec![region], ..spec.clone() };
        if region::starts_outside(&with, places.cells) {
            spec = with;
        }
    }
    spec
}

/// A robot of six axes with a box as its tool.
pub fn with_tool(random: &mut Random, places: &Places<'_>) -> RobotSpec {
    let mut robot = robot::example(random, places);
    robot.program = ProgramSpec::of_steps(100.0, Vec::new());
    let (width, length) = (random.scaled(0.006, 0.06), random.between(0.04, 0.2));
    robot.hand.tcp = Some([0.0, 0.0, length]);
    robot.hand.tool_box = Some(([0.0, 0.0, rounded(0.5 * length)], [width, width, length]));
    robot
}

/// The tool point of a robot at its start.
pub fn tool_in_world(cell: &Cell, robot: usize) -> Pose {
    let robot = &cell.robots[robot];
    let mut state = ChainState::new(&robot.robot.chain);
    state.q.copy_from_slice(&robot.start);
    robot.robot.chain.forward(&mut state);
    robot.base_in_world * state.link_in_root(robot.flange) * robot.tcp_in_flange
}

pub fn vector(random: &mut Random, most: f64) -> Vec3 {
    let [x, y, z] = random.vector(most);
    Vec3::new(x, y, z)
}

/// An object near the tool: a large one with a side before it, or a small one anywhere around.
pub fn object(name: &str, tool: Vec3, random: &mut Random) -> ObjectSpec {
    let gap = random.scaled(0.006, 0.1);
    let is_large = random.percent(50);
    let size: [f64; 3] =
        std::array::from_fn(|_| if is_large { random.between(0.2, 0.6) } else { random.between(0.02, 0.12) });
    let out = if is_large {
        let axis = random.one(&[Vec3::X, Vec3::Y, Vec3::Z]);
        axis * random.one(&[-1.0, 1.0])
    } else {
        vector(random, 1.0).try_normalize().unwrap_or(Vec3::Z)
    };
    let half = 0.5 * (size[0] * out.x.abs() + size[1] * out.y.abs() + size[2] * out.z.abs());
    let at = tool + out * (half + gap);
    let (shape, rpy) = match random.whole(0, 5) {
        0..=2 => {
            (format!("shape = \"box\"\nsize = {}\n", list(&size)), if is_large { [0.0; 3] } else { random.vector(1.5) })
        }
        3 => (format!("shape = \"sphere\"\nradius = {}\n", rounded(0.5 * size[0])), [0.0; 3]),
        4 => (
            format!("shape = \"cylinder\"\nradius = {}\nlength = {}\n", rounded(0.5 * size[0]), size[2]),
            random.vector(1.5),
        ),
        _ => ("shape = \"mesh\"\nmesh = \"corner.obj\"\n".to_owned(), random.vector(1.5)),
    };
    ObjectSpec { name: name.into(), shape, at: at.to_array().map(rounded), rpy, ..ObjectSpec::default() }
}

fn operator(random: &mut Random) -> String {
    let mut keys = String::new();
    if random.percent(60) {
        _ = writeln!(keys, "gap = {}", random.scaled(0.0002, 0.004));
    }
    if random.percent(50) {
        _ = writeln!(keys, "speed = {}", random.scaled(0.02, 1.0));
    }
    if random.percent(30) {
        _ = writeln!(keys, "acceleration = {}", random.scaled(0.5, 20.0));
    }
    if random.percent(20) {
        _ = writeln!(keys, "scale = {}", random.scaled(0.2, 3.0));
    }
    if random.percent(40) {
        keys += "interpolation = \"linear\"\n";
    }
    if random.first_or_percent(30) {
        keys += "tool = \"tool\"\n";
    }
    keys + "stale_ms = 150\n"
}

/// A hand that pushes into objects, jumps, trembles, turns, lets go and is lost.
pub fn hand(tool: Pose, objects: &[ObjectSpec], random: &mut Random) -> Vec<HandRow> {
    let mut rows = Vec::new();
    let (mut t_ms, mut at, mut turn) = (0, tool.translation, Vec3::ZERO);
    let centres: Vec<Vec3> = objects.iter().map(|o| Vec3::new(o.at[0], o.at[1], o.at[2])).collect();
    while t_ms < 2500 {
        let to = match random.whole(0, 9) {
            0..=5 if !centres.is_empty() => random.one(&centres) + vector(random, 0.1),
            6..=8 => tool.translation + vector(random, 0.2),
            _ => tool.translation + vector(random, 1.0),
        };
        let steps = if random.percent(10) { 1 } else { random.whole(5, 30) };
        let turned = if random.percent(40) { vector(random, 0.6) } else { turn };
        let tremble = if random.percent(20) { 0.003 } else { 0.0 };
        let (enable, clutch) = (!random.percent(6), random.percent(6));
        for k in 1..=steps {
            let share = k as f64 / steps as f64;
            let p = at + (to - at) * share + vector(random, 1.0) * tremble;
            let rotation = Rotation::from_rotation_vector(turn + (turned - turn) * share) * tool.rotation;
            rows.push(HandRow {
                t_ms,
                at: p.to_array().map(|v| (v * 1e6).round() as i64),
                turn: rotation.to_quaternion_xyzw().map(|v| (v * 1e6).round() as i64),
                enable,
                clutch,
                shield: true,
            });
            t_ms += 20;
        }
        (at, turn) = (to, turned);
        if random.percent(8) {
            t_ms += 300;
        }
    }
    rows
}

/// Adds a shield around a box, a guide and forces to some cells.
fn tables(guidance: &mut GuidanceSpec, objects: &[ObjectSpec], tool: Pose, random: &mut Random) {
    let boxed = objects.iter().find(|o| o.shape.contains("\"box\"")).filter(|_| random.first_or_percent(35));
    if let Some(side) = boxed.and_then(|object| Side::any(object, random)) {
        let (table, file) = side.shield(random);
        guidance.tables.push(table);
        guidance.shields.extend(file);
    }
    if random.first_or_percent(30) {
        guidance.tables.push(guide(tool, random));
    }
    let other = match boxed {
        Some(_) if guidance.tables.iter().any(|t| t.contains("protects")) => "shield",
        _ => match objects.first() {
            Some(object) => object.name.as_str(),
            None => return,
        },
    };
    if random.first_or_percent(50) {
        guidance.tables.push(force("soft", "r0/tool", other, &LAWS, random));
    }
    if let Some(object) = objects.last().filter(|_| random.percent(25)) {
        guidance.tables.push(force("arm", "r0", &object.name, &LAWS[..3], random));
    }
}

/// Lets some streams switch the shield, which forces do not follow.
fn switch_shield(guidance: &mut GuidanceSpec, random: &mut Random) {
    let has = |word: &str| guidance.tables.iter().any(|table| table.contains(word));
    if !has("[fixture.shield]") || has("[force.") || random.percent(40) {
        return;
    }
    guidance.switches = true;
    let mut is_on = random.percent(50);
    for row in &mut guidance.rows {
        is_on ^= random.percent(4);
        row.shield = is_on;
    }
}

fn guide(tool: Pose, random: &mut Random) -> String {
    let at = tool.translation;
    let near = |random: &mut Random, most: f64| list(&(at + vector(random, most)).to_array());
    let head = "[fixture.guide]\ntool = \"r0\"\n";
    let line = |random: &mut Random| {
        let points: Vec<String> = (0..random.whole(2, 6)).map(|_| near(random, 0.15)).collect();
        format!("points = [{}]\n", points.join(", "))
    };
    match random.in_turn(6) {
        0 => format!("{head}guide = \"line\"\n{}", line(random)),
        1 => format!("{head}guide = \"tube\"\n{}radius = {}\n", line(random), random.scaled(0.002, 0.05)),
        2 => format!("{head}guide = \"plane\"\nat = {}\nnormal = {}\n", near(random, 0.02), list(&random.vector(1.0))),
        3 => format!(
            "{head}guide = \"cone\"\nat = {}\naxis = {}\nhalf_angle = {}\n",
            near(random, 0.1),
            list(&random.vector(1.0)),
            random.between(0.05, 1.5)
        ),
        _ => format!("{head}guide = \"entry\"\n{}", entry(tool, random)),
    }
}

/// A point of entry on the shaft of a tool, before or beyond its tip, or up to 20 mm beside it.
fn entry(tool: Pose, random: &mut Random) -> String {
    let axis = if random.percent(60) && !random.is_first() { Vec3::Z } else { vector(random, 1.0) };
    let shaft = tool.rotation * axis.try_normalize().unwrap_or(Vec3::Z);
    let depth_m = random.between(-0.1, 0.15);
    let beside = if random.percent(20) { vector(random, 0.02) } else { Vec3::ZERO };
    let mut keys = format!("at = {}\n", list(&(tool.translation - shaft * depth_m + beside).to_array()));
    if axis != Vec3::Z {
        _ = writeln!(keys, "axis = {}", list(&axis.to_array()));
    }
    if random.first_or_percent(25) {
        _ = writeln!(keys, "radius = {}", random.scaled(0.0002, 0.01));
    }
    if random.first_or_percent(40) {
        let least_m = random.between(-0.05, 0.05);
        _ = writeln!(keys, "depth = [{least_m}, {}]", least_m + random.between(0.005, 0.1));
    }
    keys
}

fn force(name: &str, own: &str, other: &str, laws: &[&str], random: &mut Random) -> String {
    let law = laws[random.in_turn(laws.len())];
    let is_response = matches!(law, "admittance" | "impedance");
    let mut t = format!("[force.{name}]\nbetween = [\"{own}\", \"{other}\"]\nlaw = \"{law}\"\n");
    if !is_response || random.first_or_percent(50) {
        _ = writeln!(t, "range = {}", random.scaled(0.002, 0.1));
    }
    _ = writeln!(t, "stiffness = {}", random.scaled(20.0, 50_000.0));
    if random.first_or_percent(50) {
        _ = writeln!(t, "damping = {}", random.scaled(1.0, 300.0));
    }
    if t.contains("range") && random.first_or_percent(30) {
        _ = writeln!(t, "reaction_ms = {}\ndeceleration = {}", random.whole(0, 200), random.scaled(0.5, 10.0));
    }
    if law == "admittance" && random.first_or_percent(50) {
        _ = writeln!(t, "mass = {}", random.scaled(0.1, 20.0));
    }
    t
}
