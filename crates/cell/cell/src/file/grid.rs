//! `[grid.NAME]`: the occupied cell of the working area as a number on outputs.

use elbowroom_formats::toml_tables::{Table, Value};
use elbowroom_formats::{Diagnostic, suggest};
use elbowroom_monitor::{GridSpace, OutputGrid, OutputGridAxis, Region};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;

use super::definitions::robot_id;
use super::mechanism::{self, NOT_GUARDED};
use super::schema::{GRID, names};
use crate::cell::guarded;
use crate::{Cell, CellGrid, CellRobot, Units};

type Result<T> = std::result::Result<T, Diagnostic>;

const CELLS: &str = "cells = [4, 3, 1]";
/// Hysteresis of a box, m, and of a joint, rad, if the file does not state it.
const HYSTERESIS_M: f64 = 1e-3;
const HYSTERESIS_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;
/// The ends of a joint without limits, rad.
const HALF_TURNS: [f64; 2] = [-std::f64::consts::PI, std::f64::consts::PI];

/// Reads the grids of all robots.
pub(super) fn read(root: &Table<'_>, cell: &mut Cell) -> Result<()> {
    for (name, t) in root.named("grid")? {
        t.only(&names(&[GRID]))?;
        for robot in robots(&t, &cell.robots)? {
            let grid = grid(name, &t, cell.units, &cell.robots[robot.0])?;
            cell.monitoring.grids.push(CellGrid { robot, line: t.line, grid });
        }
    }
    Ok(())
}

fn robots(t: &Table<'_>, all: &[CellRobot]) -> Result<Vec<RobotId>> {
    let Some(v) = t.get("robots") else { return Ok(guarded(all).collect()) };
    let mut named: Vec<RobotId> = Vec::new();
    for item in &v.list("robots = [\"r1\"]")? {
        let robot = robot_id(item, all)?;
        mechanism::refuse(item, &all[robot.0], NOT_GUARDED)?;
        if named.contains(&robot) {
            return Err(item.error("is named twice").hint("each robot once"));
        }
        named.push(robot);
    }
    if named.is_empty() {
        return Err(v.error("is empty: no robot would have the grid").hint("leave it out for all robots"));
    }
    Ok(named)
}

fn grid(name: &str, t: &Table<'_>, units: Units, robot: &CellRobot) -> Result<OutputGrid> {
    let (space, ends, hysteresis) = match t.get("joints") {
        Some(v) => joints(&v, t, units, robot)?,
        None => cuboid(t, units)?,
    };
    let cells = t.need("cells", CELLS)?;
    let counts =
        cells.list(CELLS)?.iter().map(|v| v.whole(1, OutputGrid::MAX_CELLS as u32)).collect::<Result<Vec<u32>>>()?;
    if counts.len() != ends.len() {
        let what = format!("has {} numbers for {} axes", counts.len(), ends.len());
        return Err(cells.error(what).hint("one number per axis of the box or per joint; 1 leaves an axis undivided"));
    }
    let axes =
        ends.iter().zip(counts).map(|([from, to], count)| OutputGridAxis { from: *from, to: *to, count }).collect();
    let output = t.need("output", "output = 8")?;
    let grid = OutputGrid { name: name.into(), space, axes, output: output.whole(0, 63)? as u8, hysteresis };
    if grid.cells() > OutputGrid::MAX_CELLS {
        let what = format!("makes {} cells, more than {}", grid.cells(), OutputGrid::MAX_CELLS);
        return Err(cells.error(what).hint("fewer divisions, or a grid for each part"));
    }
    if grid.channels().end > 64 {
        let what = format!(
            "numbers up to {} take {} outputs from here, and the last is 63",
            grid.cells(),
            grid.channels().len()
        );
        return Err(output.error(what).hint(format!("output = {}   (or lower)", 64 - grid.channels().len())));
    }
    check_hysteresis(&grid, t, units, robot)?;
    Ok(grid)
}

/// At most half of the smallest cell.
fn check_hysteresis(grid: &OutputGrid, t: &Table<'_>, units: Units, robot: &CellRobot) -> Result<()> {
    let smallest = grid.axes.iter().map(OutputGridAxis::step).fold(f64::INFINITY, f64::min);
    if grid.hysteresis <= 0.5 * smallest {
        return Ok(());
    }
    let slides = match &grid.space {
        GridSpace::Tcp { .. } => true,
        GridSpace::Joints(joints) => joints.first().is_some_and(|joint| robot.slides(*joint)),
    };
    let [hysteresis, cell] = [grid.hysteresis, smallest].map(|length| units.show_joint(slides, length));
    let what = format!("the hysteresis is {hysteresis}, more than half of a cell of {cell}");
    let hint = "a smaller `hysteresis`, or fewer cells";
    Err(t.get("hysteresis").map_or_else(|| t.error(&what), |v| v.error(format!("is too large: {what}"))).hint(hint))
}

fn no_such_joint(item: &Value<'_>, name: &str, robot: &CellRobot, known: &[String]) -> Diagnostic {
    let chain = &robot.robot.chain;
    if let Some(followed) = chain.joint(name).and_then(|joint| chain.mimic_source(joint)) {
        let followed = &chain.joints()[followed.joint.0].name;
        return item.error(format!("names the joint \"{name}\", which follows \"{followed}\"")).hint(followed.clone());
    }
    item.error(format!("names the joint \"{name}\", which robot \"{}\" does not have", robot.name))
        .hint(suggest::hint(name, known.iter().map(String::as_str)))
}

/// The space of a grid, the ends of its axes and its hysteresis.
type Space = (GridSpace, Vec<[f64; 2]>, f64);

/// A box, placed as a region of this shape.
fn cuboid(t: &Table<'_>, units: Units) -> Result<Space> {
    let from = units.point(&t.need("from", "from = [500, -200, 0]   (or: joints = [\"joint_1\"])")?)?;
    let to = t.need("to", "to = [1100, 200, 700]")?;
    let size = (units.point(&to)? - from).abs();
    if size.min_element() <= 0.0 {
        return Err(to
            .error("lies on a face with `from`: the box has no volume")
            .hint("two corners that differ in x, y and z"));
    }
    let anchor = Region::cuboid_from_corners("", from, units.point(&to)?).anchor;
    let frame_in_world = Pose::new(units.rotation(t)?, anchor.translation);
    let ends = vec![[-0.5 * size.x, 0.5 * size.x], [-0.5 * size.y, 0.5 * size.y], [0.0, size.z]];
    let hysteresis = t.get("hysteresis").map_or(Ok(HYSTERESIS_M), |v| units.not_negative_length(&v))?;
    Ok((GridSpace::Tcp { frame_in_world }, ends, hysteresis))
}

fn joints(v: &Value<'_>, t: &Table<'_>, units: Units, robot: &CellRobot) -> Result<Space> {
    const EXAMPLE: &str = "joints = [\"joint_1\", \"joint_2\"]";
    if let Some(turned) = t.get("rpy").or_else(|| t.get("quaternion")) {
        return Err(turned.error("turns a box, and `joints` divides joint values").hint("one of the two"));
    }
    let known = robot.joint_names();
    let mut joints: Vec<usize> = Vec::new();
    for item in &v.list(EXAMPLE)? {
        let name = item.text()?;
        let joint = known.iter().position(|n| n == name).ok_or_else(|| no_such_joint(item, name, robot, &known))?;
        if joints.contains(&joint) {
            return Err(item.error("is named twice").hint("each joint once"));
        }
        joints.push(joint);
    }
    if joints.is_empty() {
        return Err(v.error("is empty").hint(EXAMPLE));
    }
    let slides: Vec<bool> = joints.iter().map(|joint| robot.slides(*joint)).collect();
    if let Some(other) = slides.iter().position(|s| *s != slides[0]) {
        let what = format!("has joints that turn and joints that slide, such as \"{}\"", known[joints[other]]);
        return Err(v.error(what).hint("a grid for each sort"));
    }
    let (low, high) = (robot.robot.chain.lower(), robot.robot.chain.upper());
    let limits = joints.iter().map(|j| if low[*j].is_finite() { [low[*j], high[*j]] } else { HALF_TURNS });
    let mut ends: Vec<[f64; 2]> = limits.collect();
    for (key, side) in [("from", 0), ("to", 1)] {
        let Some(v) = t.get(key) else { continue };
        let numbers = v.numbers(&format!("{key} = [-90, 0]"))?;
        if numbers.len() != joints.len() {
            let what = format!("has {} values for {} joints", numbers.len(), joints.len());
            return Err(v.error(what).hint("one value per joint"));
        }
        for ((end, number), slides) in ends.iter_mut().zip(numbers).zip(&slides) {
            end[side] = units.joint(*slides, number);
        }
    }
    if let Some(k) = ends.iter().position(|[from, to]| from >= to) {
        let [from, to] = ends[k].map(|end| units.show_joint(slides[k], end));
        let what = format!("has no values for joint \"{}\": they would go from {from} to {to}", known[joints[k]]);
        let at = t.get("to").or_else(|| t.get("from")).unwrap_or_else(|| v.clone());
        return Err(at.error(what).hint("from < to, within the joint's limits"));
    }
    let default = if slides[0] { HYSTERESIS_M } else { HYSTERESIS_RAD };
    let hysteresis = t.get("hysteresis").map_or(Ok(default), |v| Ok(units.joint(slides[0], v.not_negative()?)))?;
    Ok((GridSpace::Joints(joints), ends, hysteresis))
}
