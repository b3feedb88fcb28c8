//! Any-angle search over the coarse graph: lazy theta* (Nash, Koenig, Tovey 2010).
//!
//! A node's parent is the last corner of the way to it, not the neighbour it was found from, so lengths are those of
//! straight stretches. Whether a node sees its parent is looked at once, when it is taken up; if not, the best neighbour
//! becomes its parent, joined through their cells.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use elbowroom_cspace::Table;

use crate::graph::{Graph, Node};
use crate::sight::is_clear;
use crate::space::{Point, Scale, Space};

/// A link through parts of blocks winds: it counts as this much longer than it is straight.
const WINDING: f32 = 1.2;

/// What a search knows of a node.
#[derive(Debug, Clone, Copy, Default)]
struct Visit {
    /// Length from the start.
    length: f32,
    parent: Node,
    /// The search that saw it; others know nothing of it.
    search: u32,
    closed: bool,
    /// Joined to its parent through cells of both, not by sight.
    winding: bool,
}

/// Where a search goes.
pub(crate) struct Task<'a> {
    pub table: &'a Table,
    pub graph: &'a Graph,
    pub space: &'a Space,
    pub scale: Scale,
    pub start: (Node, Point),
    pub goal: (Node, Point),
    /// Gives up after so many nodes.
    pub most: usize,
}

impl Task<'_> {
    /// The point that stands for a node.
    pub fn point(&self, node: Node) -> Point {
        if node == self.start.0 {
            self.start.1
        } else if node == self.goal.0 {
            self.goal.1
        } else {
            self.space.middle(self.graph.at(node))
        }
    }

    fn distance(&self, a: Node, b: Node) -> f32 {
        self.scale.distance(self.point(a), self.point(b)) as f32
    }
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    Found,
    /// Everything that the start is joined to was seen.
    NotJoined,
    GaveUp,
}

/// Memory of the search, used again.
#[derive(Debug, Default)]
pub(crate) struct Search {
    visits: Vec<Visit>,
    /// Least length over the node first: lengths are not negative, so their bits are in their order.
    open: BinaryHeap<Reverse<u64>>,
    number: u32,
    /// Nodes taken up by the last search.
    pub taken: usize,
}

impl Search {
    /// Nodes from the goal back to the start, each with how it is joined to the next (true: winding).
    pub fn run(&mut self, task: &Task, chain: &mut Vec<(Node, bool)>) -> Outcome {
        self.begin(task);
        self.go_on(task, chain)
    }

    /// The same after it gave up, with more nodes.
    pub fn go_on(&mut self, task: &Task, chain: &mut Vec<(Node, bool)>) -> Outcome {
        chain.clear();
        while self.taken < task.most {
            let Some(Reverse(top)) = self.open.pop() else { return Outcome::NotJoined };
            let node = top as Node;
            if self.visits[node as usize].closed {
                continue;
            }
            self.settle(task, node);
            if node == task.goal.0 {
                self.trace(task, chain);
                return Outcome::Found;
            }
            self.expand(task, node);
        }
        Outcome::GaveUp
    }

    fn begin(&mut self, task: &Task) {
        self.visits.resize(task.graph.bound(), Visit::default());
        self.open.clear();
        self.taken = 0;
        if self.number == u32::MAX {
            self.visits.fill(Visit::default());
            self.number = 0;
        }
        self.number += 1;
        let start = task.start.0;
        self.visits[start as usize] =
            Visit { length: 0.0, parent: start, search: self.number, closed: false, winding: false };
        self.push(task, start, 0.0);
    }

    fn push(&mut self, task: &Task, node: Node, length: f32) {
        let over = length + task.distance(node, task.goal.0);
        self.open.push(Reverse(u64::from(over.to_bits()) << 32 | u64::from(node)));
    }

    /// Makes sure of a node's parent.
    fn settle(&mut self, task: &Task, node: Node) {
        self.taken += 1;
        let visit = self.visits[node as usize];
        self.visits[node as usize].closed = true;
        if visit.parent == node || is_clear(task.table, task.point(visit.parent), task.point(node)) {
            return;
        }
        let mut best = (f32::INFINITY, node);
        task.graph.all_neighbours(node, |other| {
            let seen = self.visits[other as usize];
            if seen.search != self.number || !seen.closed || other == node {
                return;
            }
            let straight = task.graph.is_full(node) && task.graph.is_full(other);
            let length = seen.length + task.distance(other, node) * if straight { 1.0 } else { WINDING };
            if length < best.0 {
                best = (length, other);
            }
        });
        let visit = &mut self.visits[node as usize];
        (visit.length, visit.parent) = best;
        visit.winding = true;
    }

    fn expand(&mut self, task: &Task, node: Node) {
        let parent = self.visits[node as usize].parent;
        let (from, so_far) = (task.point(parent), self.visits[parent as usize].length);
        task.graph.all_neighbours(node, |other| {
            let seen = self.visits[other as usize];
            let known = seen.search == self.number;
            if known && seen.closed {
                return;
            }
            let length = so_far + task.scale.distance(from, task.point(other)) as f32;
            if !known || length < seen.length {
                let (search, closed, winding) = (self.number, false, false);
                self.visits[other as usize] = Visit { length, parent, search, closed, winding };
                self.push(task, other, length);
            }
        });
    }

    fn trace(&self, task: &Task, chain: &mut Vec<(Node, bool)>) {
        let mut node = task.goal.0;
        loop {
            let visit = self.visits[node as usize];
            chain.push((node, visit.winding));
            if node == task.start.0 {
                return;
            }
            node = visit.parent;
        }
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.visits.capacity() * size_of::<Visit>() + self.open.capacity() * size_of::<u64>()
    }
}
