//! Boxes of joint space, cut in two until each is free or blocked.

use std::sync::atomic::{AtomicUsize, Ordering};

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::mesh::{Hint, Scratch};
use elbowroom_spatial::{Pose, Vec3};

use super::blocks::{Cells, Node};
use super::filler::FillCounts;
use super::joints::{Drive, MOST_JOINTS};
use super::look::look;
use super::pace::Pace;
use super::part::{Hollow, Parts};
use super::target::{Target, depth_in};
use crate::Axis;

/// A pair is not looked at where it was nearer than this share of what would do, in a box around.
const HOPE: f64 = 0.85;

/// A piece of the robot and something it may touch in the box at hand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub part: u32,
    pub target: u32,
    /// About so far apart, metres: as last seen, in this box or one around it. Infinite before.
    pub gap: f64,
    pub hint: Hint,
}

/// What a fill works with, constant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Task<'a> {
    pub drive: &'a Drive,
    pub parts: &'a Parts,
    pub axes: &'a [Axis],
    pub targets: &'a [Target],
    /// Solid and target small enough to be inside.
    pub suspects: &'a [(u32, u32)],
    /// How often a cell at the border is cut in two to tell whether it is free, per number of axes that move a piece.
    pub looks: [u32; MOST_JOINTS + 1],
    /// Nodes at most, of all slabs together.
    pub most_nodes: usize,
    /// Nodes of the slabs that are done.
    pub used: &'a AtomicUsize,
}

/// One thread's work on slabs.
pub(super) struct Search<'a> {
    pub task: Task<'a>,
    pub state: ChainState,
    pub scratch: Scratch,
    pub pairs: Vec<Pair>,
    nodes: Vec<Node>,
    pub counts: FillCounts,
    /// Looks that are left for the cell at hand.
    pub left: u32,
}

/// The tree would become too large.
#[derive(Debug)]
pub(super) struct TooLarge;

/// A box of joint values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub middle: [f64; MOST_JOINTS],
    pub half: [f64; MOST_JOINTS],
}

impl<'a> Search<'a> {
    pub fn new(task: Task<'a>) -> Self {
        Self {
            state: task.drive.state(),
            task,
            scratch: Scratch::new(),
            pairs: Vec::new(),
            nodes: Vec::new(),
            counts: FillCounts::default(),
            left: 0,
        }
    }

    /// The tree of some cells.
    pub fn run(&mut self, cells: &Cells) -> Result<Vec<Node>, TooLarge> {
        self.pairs.clear();
        self.nodes.clear();
        let parts = 0..self.task.parts.pieces.len() as u32;
        let targets = self.task.targets.len() as u32;
        let pair = |part, target| Pair { part, target, gap: f64::INFINITY, hint: Hint::default() };
        self.pairs.extend(parts.flat_map(|part| (0..targets).map(move |target| pair(part, target))));
        // Pieces that few axes move come first: what they block is blocked for all values of the others.
        self.pairs.sort_by_key(|pair| self.task.parts.pieces[pair.part as usize].depth);
        self.explore(cells, 0)?;
        self.task.used.fetch_add(self.nodes.len(), Ordering::Relaxed);
        Ok(std::mem::take(&mut self.nodes))
    }

    /// Adds the tree of a box in which the pairs from `first` on are in question. They are gone afterwards.
    fn explore(&mut self, cells: &Cells, first: usize) -> Result<(), TooLarge> {
        if self.nodes.len() + self.task.used.load(Ordering::Relaxed) >= self.task.most_nodes {
            // The others need not go on, either.
            self.task.used.store(self.task.most_nodes, Ordering::Relaxed);
            return Err(TooLarge);
        }
        let span = self.span(cells);
        self.task.drive.place(&mut self.state, &span.middle[..self.task.axes.len()]);
        self.counts.boxes += 1;
        let mut from = first;
        loop {
            let begin = self.pairs.len();
            let lowest = self.sift(&span, from, begin);
            from = begin;
            let Some(depth) = lowest else {
                let leaf = if self.is_inside(MOST_JOINTS, None) { Node::Blocked } else { Node::Free };
                self.nodes.push(leaf);
                break;
            };
            if let Some(axis) = self.longest(cells, &span, begin, depth) {
                if self.is_held(&span, begin) || self.is_inside(MOST_JOINTS, Some(&span)) {
                    self.nodes.push(Node::Blocked);
                } else {
                    self.cut(cells, begin, axis)?;
                }
                break;
            }
            // The cells are single ones on all axes that move these pieces.
            if self.touch_in(&span, begin, depth) {
                self.nodes.push(Node::Blocked);
                break;
            }
            let parts = &self.task.parts.pieces;
            let begin = self.pairs.len();
            for i in from..begin {
                if parts[self.pairs[i].part as usize].depth > depth {
                    self.pairs.push(self.pairs[i]);
                }
            }
            from = begin;
        }
        self.pairs.truncate(first);
        Ok(())
    }

    /// Copies what is not proven apart to the end; the fewest axes that move a piece of those.
    fn sift(&mut self, span: &Span, from: usize, to: usize) -> Option<usize> {
        let task = self.task;
        let mut lowest = None;
        let mut last: Option<(u32, Pace, f64)> = None;
        for i in from..to {
            let mut pair = self.pairs[i];
            let part = &task.parts.pieces[pair.part as usize];
            // A box that is to be cut for others first is often too long for this one.
            if lowest.is_some_and(|depth| part.depth > depth && later(part, &span.half, depth)) {
                self.pairs.push(pair);
                continue;
            }
            let (pace, far) = match last {
                Some((number, pace, far)) if number == pair.part => (pace, far),
                _ => {
                    let pace = Pace::of(part, task.drive, &self.state);
                    (pace, pace.farthest(part, &span.half))
                }
            };
            last = Some((pair.part, pace, far));
            if !self.is_apart(&mut pair, &pace, far) {
                lowest = lowest.or(Some(part.depth));
                self.pairs.push(pair);
            }
        }
        lowest
    }

    /// True where a pair stays apart in the whole box; what is learnt is kept.
    fn is_apart(&mut self, pair: &mut Pair, pace: &Pace, far: f64) -> bool {
        let part = &self.task.parts.pieces[pair.part as usize];
        let target = &self.task.targets[pair.target as usize];
        if target.at_least(pace.center) - part.radius > far {
            return true;
        }
        // Certainly not farther apart than that.
        if target.points.first().is_some_and(|p| p.distance(pace.center) + part.radius <= far) {
            return false;
        }
        // It was nearer a moment ago: looking would tell what is known.
        if pair.gap < HOPE * far {
            return false;
        }
        self.counts.looks += 1;
        let in_world = self.in_world(pair.part as usize);
        let found = look(&mut self.scratch, (&part.shape, &in_world), target, far, &mut pair.hint);
        pair.gap = found.unwrap_or(far);
        found.is_none()
    }

    /// The axis along which a box should be cut for pieces of a depth: the one that moves them most.
    fn longest(&self, cells: &Cells, span: &Span, begin: usize, depth: usize) -> Option<usize> {
        let parts = &self.task.parts.pieces;
        let mut shares = [0.0; MOST_JOINTS];
        let mut last = u32::MAX;
        for pair in &self.pairs[begin..] {
            let part = &parts[pair.part as usize];
            if part.depth != depth || pair.part == last {
                continue;
            }
            last = pair.part;
            let pace = Pace::of(part, self.task.drive, &self.state);
            for axis in 0..depth {
                shares[axis] = f64::max(shares[axis], pace.share(part, axis, &span.half));
            }
        }
        let long = (0..depth).filter(|&axis| cells.count(axis) > 1);
        long.max_by(|&a, &b| shares[a].total_cmp(&shares[b]))
    }

    /// Adds a cut and both parts.
    fn cut(&mut self, cells: &Cells, begin: usize, axis: usize) -> Result<(), TooLarge> {
        let at = cells.first[axis] + cells.count(axis) / 2;
        let parts = cells.cut(axis, at);
        let end = self.pairs.len();
        let node = self.nodes.len();
        self.nodes.push(Node::Free);
        self.pairs.extend_from_within(begin..end);
        self.explore(&parts[0], end)?;
        let right = self.nodes.len();
        self.explore(&parts[1], begin)?;
        let leaf = self.nodes[right];
        if right == node + 2 && self.nodes[node + 1] == leaf && !matches!(leaf, Node::Cut { .. }) {
            self.nodes.truncate(node);
            self.nodes.push(leaf);
        } else {
            self.nodes[node] = Node::Cut { axis: axis as u8, at, right: right as u32 };
        }
        Ok(())
    }

    /// True where a piece is so deep inside something that it is in it in the whole box.
    fn is_held(&mut self, span: &Span, begin: usize) -> bool {
        let Some(&nearest) = self.pairs[begin..].iter().min_by(|a, b| a.gap.total_cmp(&b.gap)) else { return false };
        let part = &self.task.parts.pieces[nearest.part as usize];
        let target = &self.task.targets[nearest.target as usize];
        let in_world = self.in_world(nearest.part as usize);
        self.counts.tried += 1;
        if !self.scratch.collides(&part.shape, &in_world, &target.shape, &target.in_world) {
            return false;
        }
        let link = self.task.drive.link_in_world(&self.state, part.link);
        let pace = Pace::of(part, self.task.drive, &self.state);
        let stays = |depth: f64, p: Vec3| depth > 0.0 && depth > pace.farthest_of(part, &span.half, p);
        part.points.iter().map(|p| link.transform_point(*p)).any(|p| stays(target.depth(p), p))
            || target.points.iter().any(|&p| stays(depth_in(&part.shape, &in_world, p), p))
    }

    /// True where something is inside a link that no more than `depth` axes move, at the middle of the box: no surface
    /// tells it. With the box, only where it is so deep inside that it is in the whole box.
    pub fn is_inside(&self, depth: usize, throughout: Option<&Span>) -> bool {
        self.task.suspects.iter().any(|&(solid, target)| {
            let Hollow { mesh, part } = &self.task.parts.hollows[solid as usize];
            if part.depth > depth {
                return false;
            }
            let link = self.task.drive.link_in_world(&self.state, part.link);
            let center = link.transform_point(part.center);
            let mesh_in_world = link * part.in_link;
            // Apart surfaces: a connected part is inside as a whole or not at all.
            let inside = |p: &Vec3| {
                let near = center.distance(*p) <= part.radius * (1.0 + 1e-9);
                near && mesh.contains(mesh_in_world.inverse_transform_point(*p))
            };
            let stays = |p: &Vec3| {
                throughout.is_none_or(|span| {
                    let pace = Pace::of(part, self.task.drive, &self.state);
                    depth_in(&part.shape, &mesh_in_world, *p) > pace.farthest_of(part, &span.half, *p)
                })
            };
            self.task.targets[target as usize].points.iter().any(|p| inside(p) && stays(p))
        })
    }

    /// Middle and half widths of a box of cells, within the limits.
    fn span(&self, cells: &Cells) -> Span {
        let mut span = Span { middle: [0.0; MOST_JOINTS], half: [0.0; MOST_JOINTS] };
        for (i, axis) in self.task.axes.iter().enumerate() {
            let low = axis.border(cells.first[i].into());
            let high = axis.border(cells.end[i].into()).min(axis.max()).max(low);
            span.middle[i] = 0.5 * (low + high);
            // A value on the border is in one of two cells: both have it.
            span.half[i] = 0.5 * (high - low) + 1e-8 * axis.step();
        }
        span
    }

    /// Where a piece is now.
    pub fn in_world(&self, part: usize) -> Pose {
        let part = &self.task.parts.pieces[part];
        self.task.drive.link_in_world(&self.state, part.link) * part.in_link
    }
}

/// True where the axes beyond `depth` move a piece more than those before.
fn later(part: &super::part::Part, half: &[f64], depth: usize) -> bool {
    let (mut before, mut beyond) = (0.0, 0.0);
    for (mover, lever) in part.movers.iter().zip(&part.levers) {
        let far = half[mover.axis] * mover.multiplier.abs() * if mover.turns { *lever } else { 1.0 };
        *(if mover.axis < depth { &mut before } else { &mut beyond }) += far;
    }
    beyond > before
}
