//! The coarse graph: its nodes are the separate parts of blocks, joined where cells of theirs share a face.

use elbowroom_cspace::{Cell, Changes, Table};

use crate::blocks::{EDGE, FACES, FULL, across, bit_of, cell_of, free_cells, middle_bit, parts};

/// Number of a node.
pub(crate) type Node = u32;

/// Which nodes a block has.
#[derive(Debug, Clone, Copy, Default)]
struct Slot {
    first: Node,
    count: u8,
    /// Nodes there is room for from `first`.
    room: u8,
}

/// Parts of blocks and how they are joined.
#[derive(Debug)]
pub(crate) struct Graph {
    /// Numbers of blocks along the axes.
    shape: [usize; 3],
    slots: Vec<Slot>,
    /// Per node: its cells, and the one that stands for it.
    cells: Vec<u64>,
    at: Vec<Cell>,
    /// Nodes that no block has any more.
    lost: usize,
    touched: Vec<u32>,
}

impl Graph {
    pub fn new(table: &Table) -> Self {
        let shape = table.shape().map(|n| n.div_ceil(EDGE));
        let blocks = shape.iter().product();
        let (cells, at) = (Vec::with_capacity(blocks), Vec::with_capacity(blocks));
        let mut graph = Self { shape, slots: vec![Slot::default(); blocks], cells, at, lost: 0, touched: Vec::new() };
        graph.rebuild(table);
        graph
    }

    fn rebuild(&mut self, table: &Table) {
        self.cells.clear();
        self.at.clear();
        self.slots.fill(Slot::default());
        self.lost = 0;
        for block in 0..self.slots.len() {
            self.refill(table, block);
        }
    }

    /// Looks again at the blocks in which cells changed.
    pub fn update(&mut self, table: &Table, changes: &Changes) {
        let mut touched = std::mem::take(&mut self.touched);
        touched.clear();
        for (cell, _) in changes.iter() {
            let block = self.block_of(cell) as u32;
            if touched.last() != Some(&block) {
                touched.push(block);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        for &block in &touched {
            self.refill(table, block as usize);
        }
        self.touched = touched;
        if self.lost > 2 * self.slots.len() {
            self.rebuild(table);
        }
    }

    fn refill(&mut self, table: &Table, block: usize) {
        let place = self.place(block);
        let (found, count) = parts(free_cells(table, place));
        let slot = &mut self.slots[block];
        if count > usize::from(slot.room) {
            self.lost += usize::from(slot.room);
            // Blocks at the border of an obstacle come apart again and again: some room beyond need.
            let room = if slot.room == 0 { count } else { count.next_power_of_two() };
            *slot = Slot { first: self.cells.len() as Node, count: 0, room: room as u8 };
            self.cells.resize(self.cells.len() + room, 0);
            self.at.resize(self.cells.len(), [0; 3]);
        }
        slot.count = count as u8;
        let first = slot.first as usize;
        for (n, &part) in found[..count].iter().enumerate() {
            self.cells[first + n] = part;
            self.at[first + n] = cell_of(place, middle_bit(part));
        }
    }

    fn place(&self, block: usize) -> [usize; 3] {
        let [_, b, c] = self.shape;
        [block / (b * c), block / c % b, block % c]
    }

    fn block_of(&self, cell: Cell) -> usize {
        let [i, j, k] = cell.map(|c| usize::from(c) / EDGE);
        (i * self.shape[1] + j) * self.shape[2] + k
    }

    /// Numbers below which all nodes are.
    pub fn bound(&self) -> usize {
        self.cells.len()
    }

    /// The cell that stands for a node.
    pub fn at(&self, node: Node) -> Cell {
        self.at[node as usize]
    }

    /// True where all of the node's block is free.
    pub fn is_full(&self, node: Node) -> bool {
        self.cells[node as usize] == FULL
    }

    /// True where the cell is one of the node's.
    pub fn has(&self, node: Node, cell: Cell) -> bool {
        let there = cell.map(|c| usize::from(c) / EDGE) == self.at(node).map(|c| usize::from(c) / EDGE);
        there && self.cells[node as usize] >> bit_of(cell) & 1 == 1
    }

    /// The node of a free cell; `None` for a blocked one.
    pub fn node(&self, cell: Cell) -> Option<Node> {
        let slot = self.slots.get(self.block_of(cell))?;
        let bit = bit_of(cell);
        (slot.first..slot.first + Node::from(slot.count)).find(|&n| self.cells[n as usize] >> bit & 1 == 1)
    }

    /// All nodes.
    pub fn nodes(&self) -> impl Iterator<Item = Node> + '_ {
        self.slots.iter().flat_map(|slot| slot.first..slot.first + Node::from(slot.count))
    }

    /// The nodes that a node is joined to over some faces.
    #[inline]
    pub fn neighbours(&self, node: Node, faces: &[(usize, bool)], mut found: impl FnMut(Node)) {
        let cells = self.cells[node as usize];
        let place = self.at[node as usize].map(|c| usize::from(c) / EDGE);
        let block = (place[0] * self.shape[1] + place[1]) * self.shape[2] + place[2];
        let strides = [self.shape[1] * self.shape[2], self.shape[2], 1];
        for &(axis, up) in faces {
            let edge = if up { self.shape[axis] - 1 } else { 0 };
            let against = across(cells, (axis, up));
            if against == 0 || place[axis] == edge {
                continue;
            }
            let slot = self.slots[if up { block + strides[axis] } else { block - strides[axis] }];
            for n in slot.first..slot.first + Node::from(slot.count) {
                if self.cells[n as usize] & against != 0 {
                    found(n);
                }
            }
        }
    }

    /// The nodes that a node is joined to.
    #[inline]
    pub fn all_neighbours(&self, node: Node, found: impl FnMut(Node)) {
        self.neighbours(node, &FACES, found);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.slots.capacity() * size_of::<Slot>()
            + self.cells.capacity() * size_of::<u64>()
            + self.at.capacity() * size_of::<Cell>()
            + self.touched.capacity() * size_of::<u32>()
    }
}
