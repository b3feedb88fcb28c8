//! Random grids around the places to which robots come.

use std::fmt::Write as _;

use elbowroom_cell::Cell;

use super::region::point_on_the_path;
use crate::fuzz_cells::random::{Random, rounded};
use crate::fuzz_cells::spec::{CellSpec, GridSpec, Vector, list};

/// Adds up to two grids, of boxes and of joint values.
pub fn some(spec: &mut CellSpec, cell: &Cell, random: &mut Random) {
    for i in 0..random.whole(0, 2) {
        let robot = random.whole(0, spec.robots.len() - 1);
        let space = if random.percent(60) { a_box(spec, cell, robot, random) } else { joints(cell, robot, random) };
        let Some((space, axes, hysteresis)) = space else { continue };
        let cells = (0..axes).map(|_| random.whole(1, 9) as u32).collect();
        spec.grids.push(GridSpec {
            name: format!("w{i}"),
            robot,
            space,
            cells,
            // Ten bits are enough for both.
            output: 20 + 20 * i as u8,
            hysteresis: random.percent(50).then_some(hysteresis),
        });
    }
}

/// The lines of a space, its number of axes and a hysteresis.
type Space = (String, usize, f64);

/// A box with a corner of its cells near the path.
fn a_box(spec: &CellSpec, cell: &Cell, robot: usize, random: &mut Random) -> Option<Space> {
    let at = point_on_the_path(spec, cell, robot, random)?;
    let corner = |at: f64, by: f64| rounded(at + by);
    let from: Vector = at.map(|x| corner(x, -random.between(0.1, 1.5)));
    let to: Vector = at.map(|x| corner(x, random.between(0.1, 1.5)));
    let turn = if random.percent(50) { format!("rpy = {}\n", list(&random.vector(3.0))) } else { String::new() };
    let lines = format!("from = {}\nto = {}\n{turn}", list(&from), list(&to));
    Some((lines, 3, random.between(0.0, 0.01)))
}

/// One or two joints that turn, some with ends of their own.
fn joints(cell: &Cell, robot: usize, random: &mut Random) -> Option<Space> {
    let r = &cell.robots[robot];
    let chain = &r.robot.chain;
    let turns =
        |j: &usize| chain.joints()[chain.active_joints()[*j].0].kind != elbowroom_kinematics::JointKind::Prismatic;
    let mut all: Vec<usize> = (0..chain.dof()).filter(turns).collect();
    let mut chosen = Vec::new();
    for _ in 0..random.whole(1, 2).min(all.len()) {
        chosen.push(all.remove(random.whole(0, all.len() - 1)));
    }
    if chosen.is_empty() {
        return None;
    }
    let names = r.joint_names();
    let named: Vec<String> = chosen.iter().map(|j| format!("\"{}\"", names[*j])).collect();
    let mut lines = format!("joints = [{}]\n", named.join(", "));
    if random.percent(50) {
        let low: Vec<f64> = chosen.iter().map(|_| rounded(random.between(-2.0, -0.1))).collect();
        let high: Vec<f64> = low.iter().map(|low| rounded(low + random.between(0.3, 3.0))).collect();
        let _ = writeln!(lines, "from = {}\nto = {}", list(&low), list(&high));
    }
    Some((lines, chosen.len(), random.between(0.0, 0.01)))
}
