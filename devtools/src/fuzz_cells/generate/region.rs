//! Random regions at places where a robot will come.

use std::path::Path;

use elbowroom_cell::Cell;

use super::moving_object::vector;
use crate::fuzz_cells::oracle::{self, Guarded};
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellSpec, RegionSpec, StepSpec, Vector, list};

/// Number of tries to find a place that is on the path, but not at the start.
const TRIES: usize = 6;
/// Least distance of the start from a region, m.
const START_M: f64 = 0.005;

/// Makes a forbidden region on the path of one of the robots; `None` if none was found that its start is outside of.
pub fn on_the_path(spec: &CellSpec, cell: &Cell, name: &str, random: &mut Random) -> Option<RegionSpec> {
    let robot = random.whole(0, spec.robots.len() - 1);
    // No region concerns a mechanism.
    let robot = if spec.robots[robot].is_mechanism { 0 } else { robot };
    for _ in 0..TRIES {
        let at = point_on_the_path(spec, cell, robot, random)?;
        let base = cell.robots[robot].base_in_world.translation;
        let region = if random.percent(25) {
            around(spec, robot, ([base.x, base.y, base.z], at), name, random)
        } else {
            self::at(spec, robot, at, name, random)
        };
        let with = CellSpec { regions: vec![region.clone()], ..spec.clone() };
        if starts_outside(&with, cell.file.parent().unwrap_or(Path::new(""))) {
            return Some(region);
        }
    }
    None
}

/// Makes a forbidden region of any shape at a place.
pub fn at(spec: &CellSpec, robot: usize, at: Vector, name: &str, random: &mut Random) -> RegionSpec {
    RegionSpec {
        name: name.to_owned(),
        shape: shape(random, at),
        kind: "forbidden",
        warning: warning(random),
        guards: guards(spec, robot, random),
        robots: if random.percent(50) { vec![robot] } else { Vec::new() },
        temporary: false,
        is_fence: false,
        follow: None,
        limits: None,
    }
}

/// Makes a region that keeps a robot inside of a solid, or within a fence, whose border is at a place.
fn around(
    spec: &CellSpec,
    robot: usize,
    (base, border): (Vector, Vector),
    name: &str,
    random: &mut Random,
) -> RegionSpec {
    let base = base.map(rounded);
    let apart: Vector = std::array::from_fn(|i| (border[i] - base[i]).abs());
    let far = usize::from(apart[0] <= apart[1]);
    let share = random.between(0.7, 1.0);
    let radius = rounded((share * apart[0].hypot(apart[1])).max(0.05));
    // Square to the axis along which the border is farthest.
    let half = |i: usize| if i == far { (share * apart[i]).max(0.05) } else { 4.0 };
    let corner = |sign: f64| -> Vector { std::array::from_fn(|i| rounded(base[i] + sign * half(i))) };
    let ([x0, y0, z0], [x1, y1, z1]) = (corner(-1.0), corner(1.0));
    let low = list(&[base[0], base[1], rounded(base[2] - 3.0)]);
    let (shape, is_fence) = match random.whole(0, 4) {
        0 => (format!("shape = \"sphere\"\ncentre = {}\nradius = {radius}\n", list(&base)), false),
        1 => (format!("shape = \"cylinder\"\nbase = {low}\nradius = {radius}\nheight = 6\n"), false),
        2 => (format!("shape = \"capsule\"\nat = {}\nradius = {radius}\nheight = 2\n", list(&base)), false),
        3 => (format!("shape = \"box\"\nfrom = [{x0}, {y0}, {z0}]\nto = [{x1}, {y1}, {z1}]\n"), false),
        _ => {
            let corners = format!("[[{x0}, {y0}], [{x1}, {y0}], [{x1}, {y1}], [{x0}, {y1}]]");
            let gates = if random.percent(40) || random.is_first() {
                gate([x0, x1], y1, [z0, z1], random)
            } else {
                String::new()
            };
            (format!("corners = {corners}\nfloor = {z0}\nheight = {}\n{gates}", rounded(z1 - z0)), true)
        }
    };
    let keep = if is_fence { "" } else { "keep = \"inside\"\n" };
    let region = at(spec, robot, border, name, random);
    RegionSpec { shape: shape + keep, is_fence, robots: vec![robot], ..region }
}

/// Makes an opening in the wall along x at a place of y; some are as high as the wall.
fn gate([x0, x1]: [f64; 2], y: f64, [z0, z1]: [f64; 2], random: &mut Random) -> String {
    let mut between = |low: f64, high: f64| {
        let (a, b) = (random.between(0.05, 0.45), random.between(0.55, 0.95));
        [rounded(low + (high - low) * a), rounded(low + (high - low) * b)]
    };
    let ([from, to], [bottom, top]) = (between(x0, x1), between(z0, z1));
    let low = if random.first_or_percent(50) { format!(", bottom = {bottom}") } else { String::new() };
    let high = if random.percent(50) { format!(", top = {top}") } else { String::new() };
    format!("gates = [{{ from = [{from}, {y}], to = [{to}, {y}]{low}{high} }}]\n")
}

/// Returns a point on or near a guarded solid, somewhere on the program's path.
pub fn point_on_the_path(spec: &CellSpec, cell: &Cell, robot: usize, random: &mut Random) -> Option<Vector> {
    let r = &spec.robots[robot];
    let ends = match &r.program.recording {
        Some(recording) => some_rows(&recording.rows),
        None => ends(&r.start, &r.program.steps),
    };
    if ends.len() < 2 {
        return None;
    }
    let last = ends.len() - 2;
    // The last segment of a repeated recording is the way back.
    let is_repeated = r.program.recording.is_some() && spec.repeat.max(r.program.repeat) > 1;
    let leg = if is_repeated && random.percent(80) { last } else { random.whole(0, last) };
    let u = random.between(0.2, 1.1);
    let q: Vec<f64> = ends[leg].iter().zip(ends[leg + 1]).map(|(a, b)| a + (b - a) * u).collect();
    let guarded = Guarded::all(&cell.robots[robot]);
    let one = &guarded[random.whole(0, guarded.len() - 1)];
    let at = one.center(&oracle::Arm::new(&cell.robots[robot]).frames(&q)) + vector(random.vector(0.15));
    Some([at.x, at.y, at.z].map(rounded))
}

/// Returns the start and the targets of the steps.
fn ends<'s>(start: &'s Vec<f64>, steps: &'s [StepSpec]) -> Vec<&'s Vec<f64>> {
    std::iter::once(start).chain(steps.iter().filter_map(StepSpec::target)).collect()
}

/// Returns up to a dozen rows of a recording, and the first one again: a robot that repeats it drives back.
fn some_rows(rows: &[(f64, Vec<f64>)]) -> Vec<&Vec<f64>> {
    let step = rows.len().div_ceil(10);
    rows.iter().step_by(step).chain(rows.last()).chain(rows.first()).map(|(_, q)| q).collect()
}

/// Whether the robots start outside the last region; true if the cell is refused.
pub fn starts_outside(spec: &CellSpec, folder: &Path) -> bool {
    let Ok(cell) = spec.parse(folder) else { return true };
    oracle::start_distance(&cell, cell.regions.len() - 1) > START_M
}

/// Returns the thickness of a warning zone: none, thin or thick.
fn warning(random: &mut Random) -> f64 {
    match random.whole(0, 9) {
        0..=2 => 0.0,
        3..=5 => random.between(0.001, 0.03),
        _ => random.between(0.05, 0.5),
    }
}

fn guards(spec: &CellSpec, robot: usize, random: &mut Random) -> Vec<&'static str> {
    let carries = |i: usize| {
        let hand = &spec.robots[i].hand;
        let has_tools = !hand.tools.is_empty() && hand.tools.iter().all(|t| t.solid.is_some());
        let grips = spec.robots[i].program.steps.iter().any(|step| matches!(step, StepSpec::Grip(_)));
        hand.tool_box.is_some() || hand.load.is_some() || has_tools || grips
    };
    match random.whole(0, 9) {
        0..=1 => vec!["tcp"],
        2 if (0..spec.robots.len()).all(carries) => vec!["tool"],
        3 if carries(robot) => vec!["tcp", "arm"],
        _ => vec!["arm"],
    }
}

/// Makes any shape near a point: large, small, or a thin plate.
fn shape(random: &mut Random, at: Vector) -> String {
    let size = random.scaled(0.02, 0.6);
    let rpy = list(&random.vector(3.0));
    let at_text = list(&at);
    match random.whole(0, 9) {
        0..=1 => format!("shape = \"sphere\"\ncentre = {at_text}\nradius = {size}\n"),
        2 => {
            let height = random.scaled(0.01, 1.0);
            format!("shape = \"cylinder\"\nbase = {at_text}\nrpy = {rpy}\nradius = {size}\nheight = {height}\n")
        }
        3 => format!("shape = \"capsule\"\nat = {at_text}\nrpy = {rpy}\nradius = {size}\nheight = {size}\n"),
        4 => {
            let [x, y] =
                [random.vector(1.0), random.vector(1.0)].map(|v| std::array::from_fn(|i| rounded(at[i] + v[i])));
            let [x, y]: [Vector; 2] = [x, y];
            format!("shape = \"plane\"\norigin = {at_text}\nx = {}\ny = {}\n", list(&x), list(&y))
        }
        5 => {
            let to: Vector = std::array::from_fn(|i| rounded(at[i] + random.scaled(0.005, 0.5)));
            format!("shape = \"box\"\nfrom = {at_text}\nto = {}\n", list(&to))
        }
        6 | 7 => {
            let thickness = random.scaled(0.001, 0.01);
            let size = list(&[thickness, random.between(0.2, 2.0), random.between(0.2, 2.0)]);
            format!("shape = \"box\"\nbase = {at_text}\nrpy = {rpy}\nsize = {size}\n")
        }
        8 => {
            let size = list(&[size, random.scaled(0.02, 0.6), random.scaled(0.02, 0.6)]);
            format!("shape = \"box\"\nbase = {at_text}\nrpy = {rpy}\nsize = {size}\n")
        }
        _ => {
            let kind = random.one(&["mesh", "convex"]);
            format!("shape = \"{kind}\"\nat = {at_text}\nrpy = {rpy}\nmesh = \"corner.obj\"\n")
        }
    }
}
