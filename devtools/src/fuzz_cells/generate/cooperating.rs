//! Robots that act as one: two or three arms, a bar between them, objects and a region in the way.

use std::f64::consts::PI;
use std::fmt::Write as _;

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::guided::{TRIES, hand, object, tool_in_world, vector, with_tool};
use super::region;
use super::settings::{Places, settings};
use crate::fuzz_cells::oracle;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellSpec, GuidanceSpec, ObjectSpec, list};

/// Name of the work-piece.
const BAR: &str = "bar";

/// Makes robots that carry a bar; nothing touches at the start.
pub fn cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = try_cell(random, places);
    for _ in 0..TRIES {
        if starts(&spec, places) {
            break;
        }
        spec = try_cell(random, places);
    }
    spec
}

fn starts(spec: &CellSpec, places: &Places<'_>) -> bool {
    let Ok(cell) = spec.parse(places.cells) else { return false };
    let Ok(scene) = QueryModel::of_cell(&cell).scene(OutOfReachProofs::Omit) else { return false };
    cell.guidance.virtual_robots.iter().all(|spec| spec.start(&cell, &scene).is_ok())
}

fn try_cell(random: &mut Random, places: &Places<'_>) -> CellSpec {
    let mut spec = settings(random);
    (spec.max_s, spec.tick_ms) = (5.0, random.one(&[4.0, 8.0]));
    let count = if random.percent(25) { 3 } else { 2 };
    let (width, length) = (random.between(0.02, 0.08), random.between(0.1, 0.5));
    // A start beyond a joint's limit is refused.
    let tools = (0..TRIES).find_map(|_| {
        spec.robots = (0..count).map(|_| with_tool(random, places)).collect();
        let cell = spec.parse(places.cells).ok()?;
        Some((0..count).map(|robot| tool_in_world(&cell, robot)).collect::<Vec<Pose>>())
    });
    let Some(tools) = tools else { return spec };
    // The first robot holds the lower end of the bar; the others come to it from around.
    let bar = tools[0] * Pose::from_translation(Vec3::Z * (0.5 * length));
    for (robot, tool) in tools.iter().enumerate().skip(1) {
        let (yaw, angle) = (random.between(-PI, PI), random.between(-PI, PI));
        let aside = Vec3::new(angle.cos(), angle.sin(), random.between(-0.3, 0.3)) * random.between(0.25, 0.8);
        let turn = Rotation::from_rpy(0.0, 0.0, yaw);
        spec.robots[robot].at = (bar.translation + aside - turn * tool.translation).to_array().map(rounded);
        spec.robots[robot].rpy = [0.0, 0.0, rounded(yaw)];
    }
    for i in 0..random.whole(0, 2) {
        let mut with = spec.clone();
        with.objects.push(object(&format!("o{i}"), bar.translation + vector(random, 0.3), random));
        if with.parse(places.cells).is_ok_and(|cell| oracle::is_clear_at_start(&cell, 0.01)) {
            spec = with;
        }
    }
    // The approach of 50 mm, if none is given, is longer too.
    let gap_m = if random.percent(40) { random.scaled(0.001, 0.045) } else { 0.01 };
    let mut guidance = GuidanceSpec {
        rows: hand(bar, &spec.objects, random),
        virtual_robot: keys(count, gap_m, random),
        ..Default::default()
    };
    guidance.tables.push(grasps(count, [width, length, gap_m], random));
    if random.first_or_percent(50) {
        _ = writeln!(guidance.virtual_robot, "seen_by = \"eye\"\nhidden = {}", random.whole(2, 80));
        guidance.tables.push(camera(bar.translation, random));
    }
    let on_the_way = guidance.rows[random.whole(0, guidance.rows.len() - 1)].at.map(|v| v as f64 * 1e-6);
    spec.objects.push(ObjectSpec {
        name: BAR.into(),
        shape: format!("shape = \"box\"\nsize = {}\n", list(&[width, width, length])),
        at: bar.translation.to_array().map(rounded),
        rpy: bar.rotation.to_rpy().map(rounded),
        ..ObjectSpec::default()
    });
    spec.guidance = Some(guidance);
    if random.first_or_percent(30) {
        add_region(&mut spec, on_the_way, places, random);
    }
    spec
}

/// Adds a forbidden or an exchange region that the first robot starts outside of.
fn add_region(spec: &mut CellSpec, at: [f64; 3], places: &Places<'_>, random: &mut Random) {
    let mut region = region::at(spec, 0, at.map(rounded), "g0", random);
    if random.in_turn(2) == 0 {
        (region.kind, region.warning, region.robots) = ("exchange", region.warning.max(0.05), Vec::new());
    }
    let with = CellSpec { regions: vec![region], ..spec.clone() };
    if region::starts_outside(&with, places.cells) {
        *spec = with;
    }
}

fn keys(count: usize, gap_m: f64, random: &mut Random) -> String {
    let robots: Vec<String> = (0..count).map(|i| format!("\"r{i}\"")).collect();
    let mut keys =
        format!("robots = [{}]\nwork_piece = \"{BAR}\"\nholder = \"r0\"\ngap = {gap_m}\n", robots.join(", "));
    let mut add = |key: &str, percent: u32, low: f64, high: f64| {
        if random.first_or_percent(percent) {
            _ = writeln!(keys, "{key} = {}", random.scaled(low, high));
        }
    };
    add("speed", 50, 0.02, 1.5);
    add("turn_speed", 70, 0.1, 4.0);
    add("approach_speed", 30, 0.02, 0.5);
    add("settle_ms", 30, 10.0, 600.0);
    add("horizon_s", 20, 0.5, 8.0);
    keys
}

/// A camera that looks at where the bar is at the start, more or less.
fn camera(bar: Vec3, random: &mut Random) -> String {
    let (yaw, height) = (random.between(-PI, PI), random.between(-0.8, 0.95));
    let away = Vec3::new(yaw.cos(), yaw.sin(), height) * random.scaled(0.5, 3.0);
    let along = vector(random, 0.1) - away;
    let rpy = Rotation::from_z(along * (1.0 / along.length())).to_rpy().map(rounded);
    let at = (bar + away).to_array().map(rounded);
    let distortion = if random.first_or_percent(30) { "distortion = [-0.1, 0.02]\n" } else { "" };
    let centre = match random.in_turn(3) {
        0 => "centre_px = [300.5, 250]\n",
        1 => "center_px = [330, 220.5]\n",
        _ => "",
    };
    format!(
        "[camera.eye]\nsize = [640, 480]\nfocal_px = {}\n{distortion}{centre}pose = {{ at = {}, rpy = {} }}\n",
        random.between(300.0, 900.0),
        list(&at),
        list(&rpy)
    )
}

/// Both ends and the sides of the bar; the first robot has the lower end. Every approach is longer than the gap.
fn grasps(count: usize, [width, length, gap_m]: [f64; 3], random: &mut Random) -> String {
    let mut t = String::from("[virtual_robot.pair.grasps]\n");
    for robot in 0..count {
        let mut all = Vec::new();
        for (out, distance) in [(-Vec3::Z, length), (Vec3::Z, length), (Vec3::X, width), (-Vec3::X, width)] {
            if robot == 0 && all.is_empty() || random.percent(70) {
                let rotation = if out == -Vec3::Z { Rotation::IDENTITY } else { Rotation::from_z(-out) };
                let (at, rpy) = ((out * (0.5 * distance)).to_array(), rotation.to_rpy());
                let approach = if random.percent(50) {
                    format!("{}", rounded(gap_m + random.scaled(0.001, 0.2)))
                } else {
                    list(&(out * -rounded(gap_m + random.scaled(0.001, 0.15))).to_array())
                };
                all.push(format!("{{ at = {}, rpy = {}, approach = {approach} }}", list(&at), list(&rpy)));
            }
        }
        if all.is_empty() {
            all.push(format!("{{ at = [0, 0, {}], rpy = [{PI}, 0, 0] }}", 0.5 * length));
        }
        _ = writeln!(t, "r{robot} = [{}]", all.join(", "));
    }
    t
}
