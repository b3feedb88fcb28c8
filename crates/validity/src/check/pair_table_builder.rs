//! Builds the tables of what can touch.

use fearless_simd::dispatch;

use super::block::{BlockModel, BlockRequest};
use super::motion_table::MotionTable;
use super::workspace::Workspace;
use crate::lanes::{LANES, Row, detected_simd_level};
use crate::model::{BEYOND_RAD, CELL_RAD, CELLS, CoveredRobot, LinkPair, MAX_PAIRS, PairTable};
use crate::obstacles::{BoxTree, ObstacleSet};

/// Slides with longer strokes are not covered by a table, m.
const LONGEST_STROKE_M: f64 = 0.1;
/// Rounding of cell borders, rad.
const ROUNDING_RAD: f64 = 1e-3;

/// Pairs with the same turning joints between them, if these are one or two.
struct Group {
    steps: [usize; 2],
    pairs: Vec<usize>,
}

/// The tables of a robot; pairs that are in none are always checked.
pub(crate) fn pair_tables(robot: &CoveredRobot) -> Vec<PairTable> {
    let mut groups: Vec<Group> = Vec::new();
    for (p, pair) in robot.pairs.iter().enumerate() {
        let Some(steps) = turning_steps(robot, pair) else { continue };
        match groups.iter_mut().find(|g| g.steps == steps && g.pairs.len() < MAX_PAIRS) {
            Some(group) => group.pairs.push(p),
            None => groups.push(Group { steps, pairs: vec![p] }),
        }
    }
    groups.into_iter().map(|group| table(robot, group)).collect()
}

/// The one or two independent turning joints of a pair, where all others are short slides.
fn turning_steps(robot: &CoveredRobot, pair: &LinkPair) -> Option<[usize; 2]> {
    let mut turning = Vec::new();
    for joint in &pair.joints {
        let step = &robot.chain.steps[joint.step];
        if !step.is_prismatic {
            turning.push(joint.step);
        } else if !(step.upper - step.lower <= LONGEST_STROKE_M) {
            return None;
        }
    }
    match turning[..] {
        [one] => Some([one, one]),
        [one, two] => Some([one, two]),
        _ => None,
    }
}

fn table(robot: &CoveredRobot, group: Group) -> PairTable {
    let mut cells = vec![0_u8; CELLS * CELLS];
    let is_single = group.steps[0] == group.steps[1];
    let mut open: Vec<usize> = (0..CELLS * CELLS)
        .filter(|i| {
            let (row, column) = (i / CELLS, i % CELLS);
            (!is_single || row == column)
                && is_reachable(robot, group.steps[0], row)
                && is_reachable(robot, group.steps[1], column)
        })
        .collect();
    // What no joint value reaches is always checked.
    cells.fill(u8::MAX);
    let motion = MotionTable::new(robot);
    let mut workspace = Workspace::new(robot, &motion);
    let (obstacles, tree) = (ObstacleSet::default(), BoxTree::default());
    let model = BlockModel { robot, obstacles: &obstacles, tree: &tree, motion: &motion, skipped: &[] };
    open.resize(open.len().next_multiple_of(LANES), open.last().copied().unwrap_or(0));
    for block in open.chunks(LANES) {
        place(robot, &group, block, &mut workspace);
        workspace.set_no_motion();
        let mut near = [0_u8; LANES];
        for (bit, &p) in group.pairs.iter().enumerate() {
            let margin_m = motion_within_cell_m(robot, &robot.pairs[p]);
            let request = BlockRequest { chords: false, active: 0xffff };
            let work = &mut workspace;
            let touching = dispatch!(detected_simd_level(), simd => model.check_pair(simd, work, request, p, margin_m));
            near.iter_mut().enumerate().for_each(|(lane, n)| *n |= ((touching >> lane & 1) as u8) << bit);
        }
        for (&cell, near) in block.iter().zip(near) {
            cells[cell] = near;
        }
    }
    PairTable { steps: group.steps, pairs: group.pairs, cells }
}

/// True where some value within the joint's limits is in the cell or near it.
fn is_reachable(robot: &CoveredRobot, step: usize, cell: usize) -> bool {
    let step = &robot.chain.steps[step];
    let width = step.upper - step.lower;
    if !(width < std::f64::consts::TAU) {
        return true;
    }
    let from_lower = (cell as f64 * CELL_RAD - step.lower).rem_euclid(std::f64::consts::TAU);
    from_lower <= width || from_lower >= std::f64::consts::TAU - CELL_RAD
}

/// Sets the lanes to the centres of cells; slides are in the middle of their stroke, all other joints at zero.
fn place(robot: &CoveredRobot, group: &Group, block: &[usize], workspace: &mut Workspace) {
    for (i, step) in robot.chain.steps.iter().enumerate() {
        let middle = if step.is_prismatic { 0.5 * (step.lower + step.upper) } else { 0.0 };
        workspace.values[i] = Row([if middle.is_finite() { middle as f32 } else { 0.0 }; LANES]);
    }
    let centre = |cell: usize| ((cell as f64 + 0.5) * CELL_RAD) as f32;
    for (lane, &cell) in block.iter().enumerate() {
        workspace.values[group.steps[0]].0[lane] = centre(cell / CELLS);
        workspace.values[group.steps[1]].0[lane] = centre(cell % CELLS);
    }
}

/// No point of one body moves farther against the other, from the centre of a cell to any value that it stands for.
fn motion_within_cell_m(robot: &CoveredRobot, pair: &LinkPair) -> f32 {
    let turn = 0.5 * CELL_RAD + f64::from(BEYOND_RAD) + ROUNDING_RAD;
    let each = pair.joints.iter().map(|joint| {
        let step = &robot.chain.steps[joint.step];
        let change = if step.is_prismatic { 0.5 * (step.upper - step.lower) } else { turn };
        change * f64::from(joint.lever_m)
    });
    (each.sum::<f64>() as f32).next_up()
}
