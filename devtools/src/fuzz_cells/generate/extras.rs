//! Keys that any table of its kind may have, whatever else the cell tests: a law, a force or a path must keep its promises with them.

use crate::fuzz_cells::random::Random;
use crate::fuzz_cells::spec::{CellSpec, ExtraKey, RegionSpec};

/// Adds keys to some of the tables.
pub fn add(spec: &mut CellSpec, random: &mut Random) {
    let has_faults = !spec.faults.is_empty();
    if !has_faults {
        speed_zones(spec, random);
    }
    let text = spec.to_toml();
    for table in text.lines().filter_map(|line| line.strip_prefix('[')?.strip_suffix(']')) {
        let (parts, own) = (table.split('.').collect::<Vec<&str>>(), keys_of(&text, table));
        for line in lines(&parts, own, has_faults, random) {
            let key = line.split_inclusive(" =").next().unwrap_or_default();
            if !own.lines().any(|line| line.starts_with(key)) {
                spec.extras.keys.push(ExtraKey { table: table.to_owned(), line });
            }
        }
    }
}

/// Makes speed zones of some forbidden regions.
fn speed_zones(spec: &mut CellSpec, random: &mut Random) {
    let is_plain = |region: &&mut RegionSpec| {
        region.kind == "forbidden" && !region.temporary && !region.is_fence && !region.shape.contains("keep =")
    };
    for region in spec.regions.iter_mut().filter(is_plain) {
        if random.percent(8) {
            region.kind = "monitored";
            let line = format!("slow_to = {}", random.whole(5, 80));
            spec.extras.keys.push(ExtraKey { table: format!("region.{}", region.name), line });
        }
    }
}

/// The lines of a table.
fn keys_of<'t>(text: &'t str, table: &str) -> &'t str {
    let (_, after) = text.split_once(&format!("[{table}]\n")).unwrap_or_default();
    after.split("\n[").next().unwrap_or_default()
}

fn lines(table: &[&str], own: &str, has_faults: bool, random: &mut Random) -> Vec<String> {
    let mut lines = Vec::new();
    match table {
        ["monitor"] => {
            some(&mut lines, 12, random, |r| format!("override_rate = {}", r.scaled(0.5, 20.0)));
            // Faults have ages, which are judged with the age of the default.
            if !has_faults {
                some(&mut lines, 12, random, |r| format!("stale_ms = {}", r.whole(20, 100)));
            }
        }
        ["region" | "fence", _] => {
            some(&mut lines, 20, random, |r| format!("hysteresis = {}", r.scaled(1e-4, 0.1)));
            if !has_faults {
                // Grids have those from 20 on.
                some(&mut lines, 15, random, |r| format!("output = {}", r.whole(0, 9)));
                some(&mut lines, 15, random, |r| format!("warning_output = {}", r.whole(10, 19)));
            }
            if table[0] == "fence" {
                some(&mut lines, 30, random, |r| format!("thickness = {}", r.scaled(0.01, 0.3)));
            }
        }
        // The rows of a file say where a belt is.
        ["encoder", _] if own.contains("speed =") => {
            some(&mut lines, 60, random, |r| format!("at = {}", r.between(-0.5, 0.5)));
            some(&mut lines, 60, random, |r| format!("end = {}", r.between(3.0, 8.0)));
        }
        ["robot", _] => {
            some(&mut lines, 20, random, |r| format!("jerk = {}", r.scaled(5.0, 500.0)));
        }
        ["avoidance", _] => avoidance(&mut lines, random),
        ["force", _] => force(&mut lines, own, random),
        ["virtual_robot", _] => {
            some(&mut lines, 30, random, |r| format!("stale_ms = {}", r.whole(200, 1000)));
        }
        ["fixture", _] if random.first_or_percent(30) => lines.push("active = true".to_owned()),
        _ => {}
    }
    lines
}

fn force(lines: &mut Vec<String>, own: &str, random: &mut Random) {
    let is = |law: &str| own.contains(&format!("law = \"{law}\""));
    let is_first = random.is_first();
    let mut some = |percent: u32, line: &dyn Fn(&mut Random) -> String| {
        if random.percent(percent) || is_first {
            lines.push(line(random));
        }
    };
    if is("admittance") || is("impedance") {
        some(50, &|r| format!("largest_force = {}", r.scaled(20.0, 300.0)));
    }
    if is("admittance") {
        some(50, &|r| format!("jerk = {}", r.scaled(50.0, 1000.0)));
    }
    if is("impedance") {
        some(50, &|r| format!("tank = {}", r.scaled(0.001, 0.05)));
        // The damping limits the stiffness at a tick.
        let least = least_device_damping(own);
        some(30, &|r| format!("device_damping = {}", least * r.scaled(1.05, 3.0)));
    }
}

/// Stiffness times half of the longest tick, and the damping, N·s/m.
fn least_device_damping(own: &str) -> f64 {
    let number =
        |key: &str| own.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = ")?.parse::<f64>().ok());
    number("stiffness").unwrap_or(800.0) * 0.004 + number("damping").unwrap_or(0.0) + 1.0
}

fn avoidance(lines: &mut Vec<String>, random: &mut Random) {
    some(lines, 50, random, |_| "robots = []".to_owned());
    some(lines, 50, random, |r| format!("speed = {}", r.scaled(0.1, 3.0)));
    some(lines, 50, random, |r| format!("clearance = {}", r.scaled(0.005, 0.2)));
    some(lines, 50, random, |r| format!("return_speed = {}", r.whole(5, 100)));
    some(lines, 50, random, |r| format!("stall_timeout = {}", r.scaled(0.1, 5.0)));
    some(lines, 85, random, |r| format!("horizon = {}", r.between(0.0, 5.0)));
    some(lines, 40, random, |r| format!("noise = {}", r.scaled(0.001, 0.02)));
    some(lines, 40, random, |r| format!("delay_ms = {}", r.whole(0, 200)));
    some(lines, 50, random, |r| format!("plan_ms = {}", r.whole(0, 500)));
}

/// Adds a line in this percentage of cases, and in more of the first ones.
fn some(lines: &mut Vec<String>, percent: u32, random: &mut Random, line: impl Fn(&mut Random) -> String) {
    let percent = if random.is_first() { percent.max(60) } else { percent };
    if random.percent(percent) {
        lines.push(line(random));
    }
}
