//! Cell of the bench: arms with one joint in a row, an exchange region between neighbours, where their tips meet, and a
//! temporary region in the middle of each swing.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;

use elbowroom_cell::Cell;

/// Distance from a base to the next, m. The arms are half as long.
const SPACING_M: f64 = 2.0;
/// Half the edge of a region, m.
const HALF_REGION_M: f64 = 0.15;
/// Time from full speed to rest, s.
pub const STOP_TIME_S: f64 = 0.2;
/// Period of the controllers, ms.
pub const TICK_MS: u64 = 20;
/// Amplitude of the arms' swings to both sides, rad: past the centres of both regions.
pub const AMPLITUDE: f64 = 1.1 * FRAC_PI_2;

/// Name of a robot.
pub fn name(robot: usize) -> String {
    format!("robot_{}", robot + 1)
}

/// Name of the exchange region of a robot and the one before it.
pub fn between(left: usize) -> String {
    format!("between_{}_{}", name(left - 1), name(left))
}

/// Name of the temporary region of a robot.
pub fn cart(robot: usize) -> String {
    format!("cart_{}", name(robot))
}

/// Makes a cell of this many robots.
pub fn cell(robots: usize) -> Result<Cell, Box<dyn std::error::Error>> {
    let mut text = format!(
        "version = 1\nname = \"interlock faults\"\nunits = {{ length = \"m\", angle = \"deg\" }}\ntick_ms = {TICK_MS}\n"
    );
    for robot in 0..robots {
        let (name, y) = (name(robot), SPACING_M * robot as f64);
        let joint = "{ a = 1, min = -170, max = 170, speed = 170 }";
        let (cart, edge) = (cart(robot), 2.0 * HALF_REGION_M);
        writeln!(text, "[robot.{name}]\nbase = {{ at = [0, {y}, 0] }}\nstop_time = {STOP_TIME_S}\ndh = [{joint}]")?;
        writeln!(
            text,
            "[region.{cart}]\nshape = \"box\"\nlife = \"temporary\"\nbase = [1, {y}, -{HALF_REGION_M}]\n\
             size = [{edge}, {edge}, {edge}]\nwarning = 0.3\nguards = [\"tcp\"]\nrobots = [\"{name}\"]"
        )?;
    }
    for left in 1..robots {
        let (a, b, region, y) = (name(left - 1), name(left), between(left), SPACING_M * (left as f64 - 0.5));
        let edge = 2.0 * HALF_REGION_M;
        writeln!(
            text,
            "[region.{region}]\nshape = \"box\"\nkind = \"exchange\"\nbase = [0, {y}, -{HALF_REGION_M}]\n\
             size = [{edge}, {edge}, {edge}]\nwarning = 0.3\nguards = [\"tcp\"]\nrobots = [\"{a}\", \"{b}\"]"
        )?;
    }
    // Joint values are sent and overrides applied once per tick.
    writeln!(text, "[monitor]\nstopping_distance = true\ndirection_aware = true\nstale_ms = 100\nreaction_ms = 40")?;
    Ok(Cell::parse("interlock_faults.toml", &text)?)
}

/// Returns the region that the tip of a robot is in at this joint value; `None` outside all. Computed from the geometry
/// alone.
pub fn occupied(robot: usize, robots: usize, q: f64) -> Option<usize> {
    let (x, y) = (q.cos(), SPACING_M * robot as f64 + q.sin());
    (1..robots).find(|left| {
        let middle = SPACING_M * (*left as f64 - 0.5);
        x.abs() < HALF_REGION_M && (y - middle).abs() < HALF_REGION_M
    })
}

/// Whether the tip of a robot is in its temporary region. Computed from the geometry alone.
pub fn is_in_cart(q: f64) -> bool {
    (q.cos() - 1.0).abs() < HALF_REGION_M && q.sin().abs() < HALF_REGION_M
}
