//! Cells that the covers leave open, settled by exact queries.

use elbowroom_proximity::WarmStart;

use super::super::box_tree::CellRange;
use super::super::motion_bound::MotionBound;
use super::super::pair_evaluator::{JointBox, PairEvaluator, PieceObstaclePair, SubdivisionTask};
use super::super::robot_pieces::RobotPiece;
use super::super::settings::MAX_JOINTS;

/// Settles cells of one obstacle.
pub(super) struct Settlement<'a> {
    evaluator: PairEvaluator<'a>,
    pairs: Vec<PieceObstaclePair>,
}

impl<'a> Settlement<'a> {
    pub fn new(task: SubdivisionTask<'a>) -> Self {
        Self { evaluator: PairEvaluator::new(task), pairs: Vec::new() }
    }

    /// True where a piece that exactly these axes move may touch the obstacle in a cell.
    pub fn may_touch(&mut self, cell: [u16; 3], axes: [bool; 3]) -> bool {
        let task = self.evaluator.task;
        let mut cells = CellRange { first: [0; MAX_JOINTS], end: [1; MAX_JOINTS] };
        for (axis, &at) in cell.iter().enumerate() {
            (cells.first[axis], cells.end[axis]) = (at, at + 1);
        }
        let joint_box = JointBox::new(task.axes, &cells);
        self.evaluator.set_configuration(&joint_box.center);
        self.pairs.clear();
        let mut depth = 0;
        for (number, piece) in task.pieces.pieces.iter().enumerate().filter(|(_, piece)| moving_axes(piece) == axes) {
            let bound = MotionBound::new(piece, task.chain, &self.evaluator.state);
            let displacement = bound.max_displacement(piece, &joint_box.half);
            let warm_start = WarmStart::default();
            let mut pair = PieceObstaclePair { piece: number as u32, obstacle: 0, distance: f64::INFINITY, warm_start };
            depth = piece.depth;
            if !self.evaluator.is_apart(&mut pair, &bound, displacement) {
                self.pairs.push(pair);
            }
        }
        let pairs = std::mem::take(&mut self.pairs);
        let may_touch = self.evaluator.may_touch_in_cell(&joint_box, &pairs, depth);
        self.pairs = pairs;
        may_touch
    }
}

/// The axes that move a piece.
fn moving_axes(piece: &RobotPiece) -> [bool; 3] {
    [0, 1, 2].map(|axis| piece.joints.iter().any(|joint| joint.axis == axis))
}
