//! The coarse graph: a node is a group of free cells (a connected component of a block of 4 × 4 × 4 cells), an edge
//! joins two groups that share a face.

use elbowroom_cspace::{CellChanges, CellIndex, OccupancyBitmap};

use crate::cell_blocks::{
    ALL_FREE, EDGE, FACES, Face, bit_of, cell_of, central_bit, components, facing_cells, free_cells,
};

/// Index of a node.
pub(crate) type Node = u32;

/// The nodes of a block.
#[derive(Debug, Clone, Copy, Default)]
struct BlockNodes {
    first: Node,
    count: u8,
    /// Number of node indices reserved from `first` on.
    capacity: u8,
}

/// The graph of groups of free cells.
#[derive(Debug)]
pub(crate) struct CellGroupGraph {
    /// Number of blocks along each axis.
    shape: [usize; 3],
    blocks: Vec<BlockNodes>,
    /// Per node: its cells, and (in `representative`) the cell that represents it.
    cells: Vec<u64>,
    representative: Vec<CellIndex>,
    /// Number of node indices that are not used any more.
    unused: usize,
    changed_blocks: Vec<u32>,
}

impl CellGroupGraph {
    pub fn new(occupancy: &OccupancyBitmap) -> Self {
        let shape = occupancy.shape().map(|n| n.div_ceil(EDGE));
        let blocks = shape.iter().product();
        let (cells, representative) = (Vec::with_capacity(blocks), Vec::with_capacity(blocks));
        let mut graph = Self {
            shape,
            blocks: vec![BlockNodes::default(); blocks],
            cells,
            representative,
            unused: 0,
            changed_blocks: Vec::new(),
        };
        graph.rebuild(occupancy);
        graph
    }

    fn rebuild(&mut self, occupancy: &OccupancyBitmap) {
        self.cells.clear();
        self.representative.clear();
        self.blocks.fill(BlockNodes::default());
        self.unused = 0;
        for block in 0..self.blocks.len() {
            self.update_block(occupancy, block);
        }
    }

    /// Updates all blocks that contain changed cells.
    pub fn update(&mut self, occupancy: &OccupancyBitmap, changes: &CellChanges) {
        let mut changed_blocks = std::mem::take(&mut self.changed_blocks);
        changed_blocks.clear();
        for (cell, _) in changes.iter() {
            let block = self.block_of(cell) as u32;
            if changed_blocks.last() != Some(&block) {
                changed_blocks.push(block);
            }
        }
        changed_blocks.sort_unstable();
        changed_blocks.dedup();
        for &block in &changed_blocks {
            self.update_block(occupancy, block as usize);
        }
        self.changed_blocks = changed_blocks;
        if self.unused > 2 * self.blocks.len() {
            self.rebuild(occupancy);
        }
    }

    fn update_block(&mut self, occupancy: &OccupancyBitmap, block: usize) {
        let coordinates = self.coordinates(block);
        let (found, count) = components(free_cells(occupancy, coordinates));
        let nodes = &mut self.blocks[block];
        if count > usize::from(nodes.capacity) {
            self.unused += usize::from(nodes.capacity);
            // Blocks at the boundary of an obstacle are divided repeatedly: reserve more than necessary.
            let capacity = if nodes.capacity == 0 { count } else { count.next_power_of_two() };
            *nodes = BlockNodes { first: self.cells.len() as Node, count: 0, capacity: capacity as u8 };
            self.cells.resize(self.cells.len() + capacity, 0);
            self.representative.resize(self.cells.len(), [0; 3]);
        }
        nodes.count = count as u8;
        let first = nodes.first as usize;
        for (n, &component) in found[..count].iter().enumerate() {
            self.cells[first + n] = component;
            self.representative[first + n] = cell_of(coordinates, central_bit(component));
        }
    }

    fn coordinates(&self, block: usize) -> [usize; 3] {
        let [_, b, c] = self.shape;
        [block / (b * c), block / c % b, block % c]
    }

    fn block_of(&self, cell: CellIndex) -> usize {
        let [i, j, k] = cell.map(|c| usize::from(c) / EDGE);
        (i * self.shape[1] + j) * self.shape[2] + k
    }

    /// Upper bound of the node indices, exclusive.
    pub fn node_bound(&self) -> usize {
        self.cells.len()
    }

    /// Returns the cell that represents a node.
    pub fn representative(&self, node: Node) -> CellIndex {
        self.representative[node as usize]
    }

    /// Whether all cells of the node's block are free.
    pub fn is_all_free(&self, node: Node) -> bool {
        self.cells[node as usize] == ALL_FREE
    }

    /// Whether the cell belongs to the node.
    pub fn has(&self, node: Node, cell: CellIndex) -> bool {
        let there = cell.map(|c| usize::from(c) / EDGE) == self.representative(node).map(|c| usize::from(c) / EDGE);
        there && self.cells[node as usize] >> bit_of(cell) & 1 == 1
    }

    /// Returns the node of a free cell; `None` if the cell is blocked.
    pub fn node(&self, cell: CellIndex) -> Option<Node> {
        let nodes = self.blocks.get(self.block_of(cell))?;
        let bit = bit_of(cell);
        (nodes.first..nodes.first + Node::from(nodes.count)).find(|&n| self.cells[n as usize] >> bit & 1 == 1)
    }

    /// Iterates over all nodes.
    pub fn nodes(&self) -> impl Iterator<Item = Node> + '_ {
        self.blocks.iter().flat_map(|nodes| nodes.first..nodes.first + Node::from(nodes.count))
    }

    /// Iterates over the neighbours of a node across the given faces.
    #[inline]
    pub fn neighbours(&self, node: Node, faces: &[Face], mut found: impl FnMut(Node)) {
        let cells = self.cells[node as usize];
        let coordinates = self.representative[node as usize].map(|c| usize::from(c) / EDGE);
        let block = (coordinates[0] * self.shape[1] + coordinates[1]) * self.shape[2] + coordinates[2];
        let strides = [self.shape[1] * self.shape[2], self.shape[2], 1];
        for &face in faces {
            let Face { axis, is_upper } = face;
            let edge = if is_upper { self.shape[axis] - 1 } else { 0 };
            let facing = facing_cells(cells, face);
            if facing == 0 || coordinates[axis] == edge {
                continue;
            }
            let nodes = self.blocks[if is_upper { block + strides[axis] } else { block - strides[axis] }];
            for n in nodes.first..nodes.first + Node::from(nodes.count) {
                if self.cells[n as usize] & facing != 0 {
                    found(n);
                }
            }
        }
    }

    /// Iterates over the neighbours of a node across all faces.
    #[inline]
    pub fn all_neighbours(&self, node: Node, found: impl FnMut(Node)) {
        self.neighbours(node, &FACES, found);
    }

    /// Memory on the heap, bytes.
    pub fn bytes(&self) -> usize {
        self.blocks.capacity() * size_of::<BlockNodes>()
            + self.cells.capacity() * size_of::<u64>()
            + self.representative.capacity() * size_of::<CellIndex>()
            + self.changed_blocks.capacity() * size_of::<u32>()
    }
}
