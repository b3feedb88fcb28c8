//! Any-angle search over the coarse graph: lazy Theta* (Nash, Koenig, Tovey 2010).
//!
//! The parent of a node is the last corner of the path to the node, not the neighbour from which it was found. Lengths
//! are therefore lengths of straight segments. Line of sight between a node and its parent is checked once, when the
//! node is expanded. If it is blocked, the best neighbour becomes the parent, connected through the cells of both
//! nodes.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use elbowroom_cspace::OccupancyBitmap;

use crate::cell_group_graph::{CellGroupGraph, Node};
use crate::grid_space::{CellScale, GridPoint, GridSpace};
use crate::line_of_sight::line_of_sight;

/// Length factor of a connection through the cells of blocks, which is not straight.
const CELL_PATH_FACTOR: f32 = 1.2;

/// State of a node in a search.
#[derive(Debug, Clone, Copy, Default)]
struct SearchNode {
    /// Length from the start.
    length: f32,
    parent: Node,
    /// Number of the search that reached the node; the state is invalid in other searches.
    search: u32,
    closed: bool,
    /// Whether the node is connected to its parent through the cells of both, without line of sight.
    by_cells: bool,
}

/// A node and the point that represents it.
#[derive(Clone, Copy)]
pub(crate) struct Terminal {
    pub node: Node,
    pub point: GridPoint,
}

/// Input of a search.
pub(crate) struct ThetaStarQuery<'a> {
    pub occupancy: &'a OccupancyBitmap,
    pub graph: &'a CellGroupGraph,
    pub space: &'a GridSpace,
    pub scale: CellScale,
    pub start: Terminal,
    pub goal: Terminal,
    /// Expansion limit.
    pub max_nodes: usize,
}

impl ThetaStarQuery<'_> {
    /// Returns the point that represents a node.
    pub fn point(&self, node: Node) -> GridPoint {
        if node == self.start.node {
            self.start.point
        } else if node == self.goal.node {
            self.goal.point
        } else {
            self.space.center(self.graph.representative(node))
        }
    }

    fn distance(&self, a: Node, b: Node) -> f32 {
        self.scale.distance(self.point(a), self.point(b)) as f32
    }
}

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SearchOutcome {
    Found,
    /// All nodes connected to the start were expanded.
    NotConnected,
    LimitReached,
}

/// A node of a path and its connection to the previous node.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathLink {
    pub node: Node,
    /// Whether the connection runs through the cells of both nodes, without line of sight.
    pub by_cells: bool,
}

/// Workspace of searches, reused.
#[derive(Debug, Default)]
pub(crate) struct ThetaStarSearch {
    nodes: Vec<SearchNode>,
    /// Nodes by least total length: lengths are not negative, so their bits sort like the numbers.
    open: BinaryHeap<Reverse<u64>>,
    number: u32,
    /// Number of nodes that the last search expanded.
    pub expanded_nodes: usize,
}

impl ThetaStarSearch {
    /// Finds the links from the goal back to the start.
    pub fn run(&mut self, query: &ThetaStarQuery, links: &mut Vec<PathLink>) -> SearchOutcome {
        self.begin(query);
        self.resume(query, links)
    }

    /// Continues a search that reached its limit, with a larger limit.
    pub fn resume(&mut self, query: &ThetaStarQuery, links: &mut Vec<PathLink>) -> SearchOutcome {
        links.clear();
        while self.expanded_nodes < query.max_nodes {
            let Some(Reverse(top)) = self.open.pop() else { return SearchOutcome::NotConnected };
            let node = top as Node;
            if self.nodes[node as usize].closed {
                continue;
            }
            self.set_vertex(query, node);
            if node == query.goal.node {
                self.trace(query, links);
                return SearchOutcome::Found;
            }
            self.expand(query, node);
        }
        SearchOutcome::LimitReached
    }

    fn begin(&mut self, query: &ThetaStarQuery) {
        self.nodes.resize(query.graph.node_bound(), SearchNode::default());
        self.open.clear();
        self.expanded_nodes = 0;
        if self.number == u32::MAX {
            self.nodes.fill(SearchNode::default());
            self.number = 0;
        }
        self.number += 1;
        let start = query.start.node;
        self.nodes[start as usize] =
            SearchNode { length: 0.0, parent: start, search: self.number, closed: false, by_cells: false };
        self.push(query, start, 0.0);
    }

    fn push(&mut self, query: &ThetaStarQuery, node: Node, length: f32) {
        let total = length + query.distance(node, query.goal.node);
        self.open.push(Reverse(u64::from(total.to_bits()) << 32 | u64::from(node)));
    }

    /// Checks line of sight to a node's parent (`SetVertex` of lazy Theta*).
    fn set_vertex(&mut self, query: &ThetaStarQuery, node: Node) {
        self.expanded_nodes += 1;
        let state = self.nodes[node as usize];
        self.nodes[node as usize].closed = true;
        let parent = state.parent;
        if parent == node || line_of_sight(query.occupancy, query.point(parent), query.point(node)) {
            return;
        }
        let mut best = (f32::INFINITY, node);
        query.graph.all_neighbours(node, |other| {
            let neighbour = self.nodes[other as usize];
            if neighbour.search != self.number || !neighbour.closed || other == node {
                return;
            }
            let is_straight = query.graph.is_all_free(node) && query.graph.is_all_free(other);
            let factor = if is_straight { 1.0 } else { CELL_PATH_FACTOR };
            let length = neighbour.length + query.distance(other, node) * factor;
            if length < best.0 {
                best = (length, other);
            }
        });
        let state = &mut self.nodes[node as usize];
        (state.length, state.parent) = best;
        state.by_cells = true;
    }

    fn expand(&mut self, query: &ThetaStarQuery, node: Node) {
        let parent = self.nodes[node as usize].parent;
        let (from, so_far) = (query.point(parent), self.nodes[parent as usize].length);
        query.graph.all_neighbours(node, |other| {
            let state = self.nodes[other as usize];
            let is_known = state.search == self.number;
            if is_known && state.closed {
                return;
            }
            let length = so_far + query.scale.distance(from, query.point(other)) as f32;
            if !is_known || length < state.length {
                let (search, closed, by_cells) = (self.number, false, false);
                self.nodes[other as usize] = SearchNode { length, parent, search, closed, by_cells };
                self.push(query, other, length);
            }
        });
    }

    fn trace(&self, query: &ThetaStarQuery, links: &mut Vec<PathLink>) {
        let mut node = query.goal.node;
        loop {
            let state = self.nodes[node as usize];
            links.push(PathLink { node, by_cells: state.by_cells });
            if node == query.start.node {
                return;
            }
            node = state.parent;
        }
    }

    /// Memory on the heap, bytes.
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<SearchNode>() + self.open.capacity() * size_of::<u64>()
    }
}
