//! Boxes of joint space, bisected until each is free or blocked.

use std::sync::atomic::Ordering;

use elbowroom_proximity::WarmStart;

use super::box_tree::{CellRange, Node};
use super::motion_bound::MotionBound;
use super::pair_evaluator::{JointBox, PairEvaluator, PieceObstaclePair, SubdivisionTask};
use super::robot_pieces::RobotPiece;
use super::settings::{MAX_JOINTS, RobotMapStats};

/// One thread's work on slabs.
pub(super) struct Subdivision<'a> {
    evaluator: PairEvaluator<'a>,
    /// Stack of the undecided pairs, box by box.
    pairs: Vec<PieceObstaclePair>,
    nodes: Vec<Node>,
}

/// The tree would exceed the memory limit.
#[derive(Debug)]
pub(super) struct NodeLimitReached;

/// A finished slab.
#[derive(Debug)]
pub(super) struct Slab {
    pub nodes: Vec<Node>,
    pub stats: RobotMapStats,
}

impl<'a> Subdivision<'a> {
    pub fn new(task: SubdivisionTask<'a>) -> Self {
        Self { evaluator: PairEvaluator::new(task), pairs: Vec::new(), nodes: Vec::new() }
    }

    /// Builds the tree of some cells.
    pub fn run(&mut self, cells: &CellRange) -> Result<Slab, NodeLimitReached> {
        self.pairs.clear();
        self.nodes.clear();
        self.evaluator.stats = RobotMapStats::default();
        let task = self.evaluator.task;
        let pieces = 0..task.pieces.pieces.len() as u32;
        let obstacles = task.obstacles.len() as u32;
        let pair = |piece, obstacle| PieceObstaclePair {
            piece,
            obstacle,
            distance: f64::INFINITY,
            warm_start: WarmStart::default(),
        };
        self.pairs.extend(pieces.flat_map(|piece| (0..obstacles).map(move |obstacle| pair(piece, obstacle))));
        // Pieces that few axes move come first: what they block is blocked for all values of the other axes.
        self.pairs.sort_by_key(|pair| task.pieces.pieces[pair.piece as usize].depth);
        self.explore(cells, 0)?;
        task.used_nodes.fetch_add(self.nodes.len(), Ordering::Relaxed);
        Ok(Slab { nodes: std::mem::take(&mut self.nodes), stats: self.evaluator.stats })
    }

    /// Adds the tree of a box whose undecided pairs are those from `first` on; removes these pairs from the stack.
    fn explore(&mut self, cells: &CellRange, first: usize) -> Result<(), NodeLimitReached> {
        let task = self.evaluator.task;
        if self.nodes.len() + task.used_nodes.load(Ordering::Relaxed) >= task.max_nodes {
            // Makes the other threads stop, too.
            task.used_nodes.store(task.max_nodes, Ordering::Relaxed);
            return Err(NodeLimitReached);
        }
        let joint_box = JointBox::new(task.axes, cells);
        self.evaluator.set_configuration(&joint_box.center);
        self.evaluator.stats.boxes += 1;
        let mut from = first;
        loop {
            let begin = self.pairs.len();
            let lowest = self.cull_pairs(&joint_box, from, begin);
            from = begin;
            let Some(depth) = lowest else {
                let is_blocked = self.evaluator.contains_obstacle(MAX_JOINTS, None);
                self.nodes.push(if is_blocked { Node::Blocked } else { Node::Free });
                break;
            };
            if let Some(axis) = self.split_axis(cells, &joint_box, begin, depth) {
                if self.evaluator.is_in_contact_throughout(&joint_box, &self.pairs[begin..])
                    || self.evaluator.contains_obstacle(MAX_JOINTS, Some(&joint_box))
                {
                    self.nodes.push(Node::Blocked);
                } else {
                    self.split(cells, begin, axis)?;
                }
                break;
            }
            // On all axes that move these pieces, the box is a single cell.
            if self.evaluator.may_touch_in_cell(&joint_box, &self.pairs[begin..], depth) {
                self.nodes.push(Node::Blocked);
                break;
            }
            let begin = self.pairs.len();
            for i in from..begin {
                if task.pieces.pieces[self.pairs[i].piece as usize].depth > depth {
                    self.pairs.push(self.pairs[i]);
                }
            }
            from = begin;
        }
        self.pairs.truncate(first);
        Ok(())
    }

    /// Culls pairs that are proven apart: copies the other pairs to the end of the stack. Returns the least number of
    /// axes that move a piece of these pairs.
    fn cull_pairs(&mut self, joint_box: &JointBox, from: usize, to: usize) -> Option<usize> {
        let task = self.evaluator.task;
        let mut lowest = None;
        let mut last: Option<(u32, MotionBound, f64)> = None;
        for i in from..to {
            let mut pair = self.pairs[i];
            let piece = &task.pieces.pieces[pair.piece as usize];
            // A box that will be bisected for other pairs is often too large to prove this pair apart.
            if lowest.is_some_and(|depth| piece.depth > depth && moves_more_by_later_axes(piece, joint_box, depth)) {
                self.pairs.push(pair);
                continue;
            }
            let (bound, displacement) = match last {
                Some((number, bound, displacement)) if number == pair.piece => (bound, displacement),
                _ => {
                    let bound = MotionBound::new(piece, task.chain, &self.evaluator.state);
                    (bound, bound.max_displacement(piece, &joint_box.half))
                }
            };
            last = Some((pair.piece, bound, displacement));
            if !self.evaluator.is_apart(&mut pair, &bound, displacement) {
                lowest = lowest.or(Some(piece.depth));
                self.pairs.push(pair);
            }
        }
        lowest
    }

    /// The axis along which a box is bisected for pieces of a depth: the axis that moves them most.
    fn split_axis(&self, cells: &CellRange, joint_box: &JointBox, begin: usize, depth: usize) -> Option<usize> {
        let task = self.evaluator.task;
        let mut displacements = [0.0; MAX_JOINTS];
        let mut last = u32::MAX;
        for pair in &self.pairs[begin..] {
            let piece = &task.pieces.pieces[pair.piece as usize];
            if piece.depth != depth || pair.piece == last {
                continue;
            }
            last = pair.piece;
            let bound = MotionBound::new(piece, task.chain, &self.evaluator.state);
            for axis in 0..depth {
                let displacement = bound.axis_displacement(piece, axis, &joint_box.half);
                displacements[axis] = f64::max(displacements[axis], displacement);
            }
        }
        let long = (0..depth).filter(|&axis| cells.count(axis) > 1);
        long.max_by(|&a, &b| displacements[a].total_cmp(&displacements[b]))
    }

    /// Adds a split and its two halves.
    fn split(&mut self, cells: &CellRange, begin: usize, axis: usize) -> Result<(), NodeLimitReached> {
        let at = cells.first[axis] + cells.count(axis) / 2;
        let halves = cells.split(axis, at);
        let end = self.pairs.len();
        let node = self.nodes.len();
        self.nodes.push(Node::Free);
        self.pairs.extend_from_within(begin..end);
        self.explore(&halves[0], end)?;
        let right = self.nodes.len();
        self.explore(&halves[1], begin)?;
        let leaf = self.nodes[right];
        if right == node + 2 && self.nodes[node + 1] == leaf && !matches!(leaf, Node::Split { .. }) {
            self.nodes.truncate(node);
            self.nodes.push(leaf);
        } else {
            self.nodes[node] = Node::Split { axis: axis as u8, at, right: right as u32 };
        }
        Ok(())
    }
}

/// Whether the axes from `depth` on move a piece more than the axes before.
fn moves_more_by_later_axes(piece: &RobotPiece, joint_box: &JointBox, depth: usize) -> bool {
    let (mut before, mut beyond) = (0.0, 0.0);
    for (joint, lever_arm) in piece.joints.iter().zip(&piece.lever_arms) {
        let lever = if joint.turns { *lever_arm } else { 1.0 };
        let displacement = joint_box.half[joint.axis] * joint.multiplier.abs() * lever;
        *(if joint.axis < depth { &mut before } else { &mut beyond }) += displacement;
    }
    beyond > before
}
