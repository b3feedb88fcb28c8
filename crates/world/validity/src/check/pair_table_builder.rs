//! Builder of the pair tables, which say which pairs of links can touch.

use fearless_simd::dispatch;

use super::block::BlockModel;
use super::block_request::BlockRequest;
use super::motion_table::MotionTable;
use super::workspace::Workspace;
use crate::lanes::{LANES, Row, detected_simd_level};
use crate::model::{BEYOND_RAD, CELLS, CoveredRobot, LEVELS, LinkPair, MAX_PAIRS, PairTable};
use crate::obstacles::{BroadPhase, ObstacleSet};

/// Longest stroke of a slide that a table covers, m.
const LONGEST_STROKE_M: f64 = 0.1;
/// Allowance for the rounding of cell borders, rad.
const ROUNDING_RAD: f64 = 1e-3;

/// Number of fine cells per coarse cell and joint.
const REFINEMENT: usize = 4;

/// Pairs with the same one or two turning joints between them.
struct Group {
    steps: [usize; 2],
    pairs: Vec<usize>,
}

impl Group {
    /// True if one joint alone moves the pairs.
    fn is_single(&self) -> bool {
        self.steps[0] == self.steps[1]
    }

    /// False for cells in which the single joint of the group would have two values.
    fn has(&self, cell: [usize; 2]) -> bool {
        !self.is_single() || cell[0] == cell[1]
    }
}

/// The tables of a robot. Pairs without a table are always checked.
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

/// The one or two independent turning joints of a pair, if all other joints between its links are short slides.
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

/// Cells of a grid over the joints of a group, each with the pairs that may touch, one bit per pair.
struct NearCells {
    /// Number of cells per turn of each joint.
    per_turn: usize,
    /// Cell of each joint, and bits of the pairs.
    cells: Vec<([usize; 2], u8)>,
}

fn table(robot: &CoveredRobot, group: Group) -> PairTable {
    let row = if group.is_single() { 0 } else { CELLS };
    let index = |cell: [usize; 2]| cell[0] * row + cell[1];
    let mut prober = Prober::new(robot, &group);
    let reachable = NearCells::reachable(robot, &group);
    let fine = reachable.refined(&group);
    // Coarse cells leave few fine cells to test. Each level tests the cells that the level before it left.
    let mut near = prober.near(&reachable, BEYOND_RAD[LEVELS - 1]).refined(&group);
    let mut levels: [Vec<u8>; LEVELS] = Default::default();
    for level in (0..LEVELS).rev() {
        near = prober.near(&near, BEYOND_RAD[level]);
        // Cells that no joint value reaches are always checked.
        let mut cells = vec![u8::MAX; CELLS * row.max(1)];
        fine.cells.iter().for_each(|&(cell, _)| cells[index(cell)] = 0);
        near.cells.iter().for_each(|&(cell, pairs)| cells[index(cell)] = pairs);
        levels[level] = cells;
    }
    PairTable { steps: group.steps, pairs: group.pairs, row, levels }
}

impl NearCells {
    /// All coarse cells within the limits, with all pairs.
    fn reachable(robot: &CoveredRobot, group: &Group) -> Self {
        let per_turn = CELLS / REFINEMENT;
        let all = (0..per_turn * per_turn).map(|i| [i / per_turn, i % per_turn]);
        let cells = all
            .filter(|cell| group.has(*cell) && (0..2).all(|k| is_reachable(robot, group.steps[k], cell[k], per_turn)));
        Self { per_turn, cells: cells.map(|cell| (cell, u8::MAX)).collect() }
    }

    /// The same region, divided into fine cells.
    fn refined(&self, group: &Group) -> Self {
        let parts = || (0..REFINEMENT * REFINEMENT).map(|k| [k / REFINEMENT, k % REFINEMENT]);
        let part = |cell: [usize; 2], [i, j]: [usize; 2]| [cell[0] * REFINEMENT + i, cell[1] * REFINEMENT + j];
        let of_one = |(cell, pairs): ([usize; 2], u8)| parts().map(move |k| (part(cell, k), pairs));
        let cells = self.cells.iter().copied().flat_map(of_one).filter(|(cell, _)| group.has(*cell)).collect();
        Self { per_turn: CELLS, cells }
    }
}

/// Tests cells of a group.
struct Prober<'r> {
    robot: &'r CoveredRobot,
    group: &'r Group,
    motion: MotionTable,
    workspace: Workspace,
}

impl<'r> Prober<'r> {
    fn new(robot: &'r CoveredRobot, group: &'r Group) -> Self {
        let motion = MotionTable::new(robot);
        let workspace = Workspace::new(robot, &motion);
        Self { robot, group, motion, workspace }
    }

    /// The cells in which a pair may touch at a value inside the cell or up to `beyond_rad` outside it.
    fn near(&mut self, among: &NearCells, beyond_rad: f32) -> NearCells {
        let per_turn = among.per_turn;
        let width_rad = std::f64::consts::TAU / per_turn as f64;
        let turn_rad = 0.5 * width_rad + f64::from(beyond_rad) + ROUNDING_RAD;
        let mut cells = Vec::new();
        for block in among.cells.chunks(LANES) {
            self.place(block, per_turn);
            let asked = block.iter().fold(0, |all, (_, pairs)| all | pairs);
            let near = self.near_pairs(asked, turn_rad);
            let tested = block.iter().zip(near).map(|(&(cell, pairs), near)| (cell, pairs & near));
            cells.extend(tested.filter(|(_, near)| *near != 0));
        }
        NearCells { per_turn, cells }
    }

    /// Sets the lanes to the centres of cells. Slides are in the middle of their stroke, all other joints at zero.
    fn place(&mut self, block: &[([usize; 2], u8)], per_turn: usize) {
        for (i, step) in self.robot.chain.steps.iter().enumerate() {
            let middle = if step.is_prismatic { 0.5 * (step.lower + step.upper) } else { 0.0 };
            self.workspace.values[i] = Row([if middle.is_finite() { middle as f32 } else { 0.0 }; LANES]);
        }
        let centre = |cell: usize| ((cell as f64 + 0.5) * std::f64::consts::TAU / per_turn as f64) as f32;
        for lane in 0..LANES {
            // Unused lanes repeat the last one.
            let (cell, _) = block[lane.min(block.len() - 1)];
            for k in 0..2 {
                self.workspace.values[self.group.steps[k]].0[lane] = centre(cell[k]);
            }
        }
        self.workspace.set_no_motion();
    }

    /// Per lane: those pairs of `asked` that may touch if each turning joint moves by up to `turn_rad`.
    fn near_pairs(&mut self, asked: u8, turn_rad: f64) -> [u8; LANES] {
        let mut near = [0_u8; LANES];
        let (robot, work) = (self.robot, &mut self.workspace);
        let (obstacles, tree) = (ObstacleSet::default(), BroadPhase::default());
        let model = BlockModel { robot, obstacles: &obstacles, tree: &tree, motion: &self.motion, skipped: &[] };
        for (bit, &p) in self.group.pairs.iter().enumerate().filter(|(bit, _)| asked >> bit & 1 == 1) {
            let margin_m = motion_m(robot, &robot.pairs[p], turn_rad);
            let request = BlockRequest { chords: false, active: 0xffff };
            let touching = dispatch!(detected_simd_level(), simd => model.check_pair(simd, work, request, p, margin_m));
            near.iter_mut().enumerate().for_each(|(lane, n)| *n |= ((touching >> lane & 1) as u8) << bit);
        }
        near
    }
}

/// True if a value within the joint's limits is in the cell or near it.
fn is_reachable(robot: &CoveredRobot, step: usize, cell: usize, per_turn: usize) -> bool {
    let step = &robot.chain.steps[step];
    let width = step.upper - step.lower;
    if !(width < std::f64::consts::TAU) {
        return true;
    }
    let cell_rad = std::f64::consts::TAU / per_turn as f64;
    let from_lower = (cell as f64 * cell_rad - step.lower).rem_euclid(std::f64::consts::TAU);
    from_lower <= width || from_lower >= std::f64::consts::TAU - cell_rad
}

/// Upper bound (m) on the motion of a point of one body against the other.
///
/// Each turning joint moves by up to `turn_rad`, and each slide from the middle of its stroke to any other position.
fn motion_m(robot: &CoveredRobot, pair: &LinkPair, turn_rad: f64) -> f32 {
    let each = pair.joints.iter().map(|joint| {
        let step = &robot.chain.steps[joint.step];
        let change = if step.is_prismatic { 0.5 * (step.upper - step.lower) } else { turn_rad };
        change * f64::from(joint.lever_m)
    });
    (each.sum::<f64>() as f32).next_up()
}
